#include "robomill/cell/files/check_json.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/cell/check/shown.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/robot/euler.hpp"

namespace robomill::cell {
namespace {

using io::add_rows;
using io::if_positive;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::Use;

/// A part of a check, with what it is read with.
template <class Part>
struct Of {
  const CellCheck* check = nullptr;
  const Part* part = nullptr;
  /// What a joint's numbers are shown in.
  [[nodiscard]] double unit(int joint) const { return joint_unit(check->prismatic, joint).size; }
};

template <class Part>
std::vector<Of<Part>> each(const CellCheck& check, const std::vector<Part>& parts) {
  std::vector<Of<Part>> out;
  out.reserve(parts.size());
  for (const Part& part : parts) out.push_back({&check, &part});
  return out;
}

/// A key of the part itself.
template <class Part>
Row<Of<Part>> own(Row<Part> row) {
  return io::keys_of<Of<Part>>(std::vector{std::move(row)}, [](const Of<Part>& at) -> const Part& { return *at.part; })
      .front();
}

struct JointAt {
  const CellCheck* check = nullptr;
  int joint = 0;
  [[nodiscard]] double unit() const { return joint_unit(check->prismatic, joint).size; }
};

std::optional<double> limit(double value, double unit) {
  return is_limit(value) ? std::optional(value / unit) : std::nullopt;
}

/// The keys of a joint's row whose values are assumed.
std::vector<std::string> assumed_keys(const JointAt& at) {
  std::vector<std::string> out;
  for (const auto& [key, name] : {std::pair{"robot.joint_min_position", "min_position"},
                                  {"robot.joint_max_position", "max_position"},
                                  {"robot.joint_max_velocity", "max_velocity_per_s"},
                                  {"robot.joint_max_acceleration", "max_acceleration_per_s2"},
                                  {"robot.joint_max_jerk", "max_jerk_per_s3"}}) {
    if (std::ranges::find(at.check->cell.assumed, key, &Assumption::key) != at.check->cell.assumed.end())
      out.emplace_back(name);
  }
  return out;
}

/// A limit of a joint, in its unit. @param rate  which is > 0
Row<JointAt> limit_key(const std::string& name, robot::Position6 robot::JointLimits::*member, bool rate) {
  const auto value = [member, rate](const JointAt& at) {
    const double in_si = (at.check->limits.*member)(at.joint);
    return rate ? if_positive(in_si / at.unit()) : limit(in_si, at.unit());
  };
  return key(name, value, "none: no limit").in_unit().nullable();
}

const Schema<JointAt>& joint_table() {
  using robot::JointLimits;
  static const Schema<JointAt> table(
      "cell_joint", "limits of a joint, in its unit",
      {key(
           "joint", [](const JointAt& at) { return at.joint + 1; }, "from 1"),
       key(
           "unit", [](const JointAt& at) { return at.unit() == units::deg ? "deg" : "mm"; }, "of its position")
           .words({"deg", "mm"}),
       limit_key("min_position", &JointLimits::min_position, false),
       limit_key("max_position", &JointLimits::max_position, false),
       limit_key("max_velocity_per_s", &JointLimits::max_velocity, true),
       limit_key("max_acceleration_per_s2", &JointLimits::max_acceleration, true),
       limit_key("max_jerk_per_s3", &JointLimits::max_jerk, true),
       key(
           "assumed", [](const JointAt& at) { return assumed_keys(at); }, "keys above that are not given")},
      Use::written);
  return table;
}

const Schema<Eigen::Isometry3d>& flange_table() {
  using Pose = Eigen::Isometry3d;
  static const Schema<Pose> table(
      "flange_pose", "the flange before any mount, in the robot's base",
      {key(
           "origin_mm", [](const Pose& pose) -> Eigen::Vector3d { return pose.translation(); }, "its origin")
           .entries(3),
       key(
           "abc_deg",
           [](const Pose& pose) {
             const robot::Euler turn = robot::euler_of(pose.linear());
             return Eigen::Vector3d(turn.a_rad, turn.b_rad, turn.c_rad);
           },
           "turns about z, y', x'' (KUKA's A B C, FANUC's R P W, Yaskawa's Rz Ry Rx)")
           .entries(3),
       key(
           "quaternion",
           [](const Pose& pose) {
             const Eigen::Quaterniond turn(pose.linear());
             const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
             return Eigen::Vector4d(sign * turn.w(), sign * turn.x(), sign * turn.y(), sign * turn.z());
           },
           "w, x, y, z (ABB)")
           .entries(4),
       key(
           "rotation_vector_rad",
           [](const Pose& pose) {
             const Eigen::AngleAxisd about(pose.linear());
             return Eigen::Vector3d(about.angle() * about.axis());
           },
           "axis times angle (Universal Robots)")
           .entries(3)},
      Use::written);
  return table;
}

/// From 1, of one from 0; none where it is negative.
std::optional<int> number_of(int joint) {
  return joint < 0 ? std::nullopt : std::optional(joint + 1);
}

/// In the unit of each joint; null: it can be anywhere.
std::vector<std::optional<double>> by_joint(const Of<CellStand>& at, const robot::Position6& values) {
  std::vector<std::optional<double>> out;
  out.reserve(static_cast<std::size_t>(at.check->joints));
  for (int i = 0; i < at.check->joints; ++i) out.push_back(limit(values(i), at.unit(i)));
  return out;
}

const Schema<Of<CellStand>>& stand_table() {
  using At = Of<CellStand>;
  using Stand = CellStand;
  static const Schema<At> table(
      "cell_posture", "a position of the joints and the tool that it makes",
      {own(key("name", &Stand::name, "in words")),
       key(
           "joints", [](const At& at) { return by_joint(at, at.part->position); }, "in the unit of each")
           .nullable(),
       own(key("tip_mm", &Stand::tip_m, "in the robot's base").entries(3)),
       own(key("axis", &Stand::axis, "from tip to spindle, in the robot's base").entries(3)),
       own(of(&Stand::tool, key("program_tip_mm", &robot::ToolPose::tip_m, "in the program's frame").entries(3))),
       own(of(&Stand::tool, key("program_axis", &robot::ToolPose::axis, "in the program's frame").entries(3))),
       own(of(&Stand::tool, key("gamma_deg", &robot::ToolPose::gamma_rad, "turn about the tool's axis"))),
       own(key("flange", &Stand::flange, flange_table(), "in the robot's base")),
       key(
           "to_limit", [](const At& at) { return by_joint(at, at.part->to_limit); },
           "from each joint to its nearer limit; < 0: beyond; none: no limit")
           .nullable(),
       key(
           "nearest_joint", [](const At& at) { return number_of(at.part->nearest_joint); },
           "to its limit, by share of half its range; none: no limits")
           .nullable(),
       own(key("condition_number", &Stand::condition_number,
               "of the Jacobian at the tip, lengths in m; above 1000 singular")
               .nullable())},
      Use::written);
  return table;
}

constexpr Name<robot::Reach::Status> states[] = {{"out of reach", robot::Reach::Status::out_of_reach},
                                                 {"outside limits", robot::Reach::Status::outside_limits},
                                                 {"singular", robot::Reach::Status::singular}};

const Schema<Of<BeyondLimit>>& beyond_table() {
  using At = Of<BeyondLimit>;
  const auto shown = [](auto value) {
    return [value](const At& at) { return value(*at.part) / at.unit(at.part->joint); };
  };
  static const Schema<At> table(
      "beyond_limit", "a joint beyond its limit, in its unit",
      {key(
           "joint", [](const At& at) { return at.part->joint + 1; }, "from 1"),
       key("position", shown([](const BeyondLimit& one) { return one.position; }), "of the joint"),
       key("limit", shown([](const BeyondLimit& one) { return one.limit; }), "that it is beyond"),
       key("beyond", shown([](const BeyondLimit& one) { return one.position - one.limit; }), "position less limit")},
      Use::written);
  return table;
}

const Schema<Of<Miss>>& miss_table() {
  using At = Of<Miss>;
  /// None where it is 0.
  const auto known = [](const std::string& name, auto Miss::*member, const std::string& meaning) {
    const auto value = [member](const At& at) {
      return at.part->*member > 0 ? std::optional(at.part->*member) : std::nullopt;
    };
    return key(name, value, meaning).nullable();
  };
  static const Schema<At> table(
      "cell_miss", "a pose that the tool cannot take",
      {own(key("block", &Miss::block, "from 1, at its end; 0: the program's start, or the workpiece's origin")),
       known("line", &Miss::line, "of the program"),
       own(of(&Miss::pose, key("tip_mm", &robot::ToolPose::tip_m, "in the program's frame").entries(3))),
       own(of(&Miss::pose, key("axis", &robot::ToolPose::axis, "in the program's frame").entries(3))),
       key(
           "base_tip_mm",
           [](const At& at) { return Eigen::Vector3d(at.check->placement.workpiece * at.part->pose.tip_m); },
           "in the robot's base")
           .entries(3),
       own(key("state", &Miss::status, states, "why")),
       key(
           "joints", [](const At& at) { return each(*at.check, at.part->beyond); }, beyond_table(),
           "outside limits: those that are"),
       known("out_of_reach_mm", &Miss::out_of_reach_m, "where it is known"),
       known("out_of_reach_deg", &Miss::out_of_reach_rad, "where it is known"),
       known("condition_number", &Miss::condition_number, "of a singularity"),
       key(
           "text", [](const At& at) { return what_misses(*at.part, at.check->prismatic); }, "in words")},
      Use::written);
  return table;
}

/// origin_mm and rotation_deg as a cell has them, and what comes with them.
template <class At, class Pose>
std::vector<Row<At>> workpiece_keys(Pose pose) {
  return {key(
              "origin_mm", [pose](const At& at) -> Eigen::Vector3d { return pose(at).translation(); },
              "of the workpiece, in the robot's base")
              .entries(3),
          key(
              "rotation_deg",
              [pose](const At& at) {
                const robot::Euler turn = robot::euler_of(pose(at).linear());
                return Eigen::Vector3d(turn.c_rad, turn.b_rad, turn.a_rad);
              },
              "as in a cell")
              .entries(3)};
}

/// How a program, or the origin, is reached.
std::vector<Row<Of<path::PostureChoice>>> choice_keys() {
  using At = Of<path::PostureChoice>;
  return {key(
              "margin", [](const At& at) { return at.part->margin.least; },
              "least share of the way to a limit or a singularity")
              .nullable(),
          key(
              "posture",
              [](const At& at) {
                return path::PostureView{at.part, at.check->joints, &at.check->prismatic};
              },
              path::posture_table(), "of the start"),
          key(
              "margin_joint", [](const At& at) { return number_of(at.part->margin.joint); },
              "whose limit is nearest; none: the singularity is")
              .nullable(),
          key(
              "gamma_deg",
              [](const At& at) -> std::optional<std::array<double, 2>> {
                const std::vector<double>& gamma_rad = at.part->posture.gamma_rad;
                if (at.check->cell.hybrid || gamma_rad.empty()) return std::nullopt;
                const auto [low, high] = std::ranges::minmax(gamma_rad);
                return std::array{low, high};
              },
              "lowest and highest turn about the tool's axis; none: it has no such freedom")
              .entries(2)
              .null_list()};
}

const Schema<CellCheck>& placement_table() {
  static const Schema<CellCheck> table(
      "cell_placement", "whether tool and workpiece come together where the workpiece is",
      [] {
        std::vector<Row<CellCheck>> rows = workpiece_keys<CellCheck>(
            [](const CellCheck& check) -> const Eigen::Isometry3d& { return check.placement.workpiece; });
        add_rows(
            rows,
            {key(
                 "works", [](const CellCheck& check) { return check.placement.works(); }, "all poses can be taken"),
             key("program", &CellCheck::program, "its file; none: the origin alone").nullable(),
             key("whole", &CellCheck::whole, "the program was read to its end"),
             of(&CellCheck::placement, key("poses", &Placement::poses, "evaluated")),
             of(&CellCheck::placement, key("complete", &Placement::complete, "no pose was left out")),
             key(
                 "missed", [](const CellCheck& check) { return check.placement.misses.size(); },
                 "that cannot be taken"),
             key(
                 "misses", [](const CellCheck& check) { return each(check, check.placement.misses); }, miss_table(),
                 "each of them, at most a hundred"),
             of(&CellCheck::placement,
                key("no_way", &Placement::no_way, "why poses cannot be taken one after the other").nullable())});
        const auto choice = [](const CellCheck& check) {
          return Of<path::PostureChoice>{&check, &check.placement.choice};
        };
        for (Row<CellCheck>& row : io::keys_of<CellCheck>(choice_keys(), choice))
          rows.push_back(where([](const CellCheck& check) { return check.placement.works(); }, std::move(row)));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<Of<Proposal>>& proposal_table() {
  using At = Of<Proposal>;
  static const Schema<At> table(
      "cell_proposal", "a pose of the workpiece that serves",
      [] {
        std::vector<Row<At>> rows =
            workpiece_keys<At>([](const At& at) -> const Eigen::Isometry3d& { return at.part->placement.workpiece; });
        add_rows(rows, {own(key("shift_mm", &Proposal::shift_m, "of the program's middle").entries(3)),
                        own(key("turn_deg", &Proposal::turn_rad, "about the base's z"))});
        add_rows(rows, io::keys_of<At>(choice_keys(), [](const At& at) {
                   return Of<path::PostureChoice>{at.check, &at.part->placement.choice};
                 }));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<CellFigure>& figure_table() {
  static const Schema<CellFigure> table("cell_figure", "the machine as lines, in the robot's base",
                                        {key("name", &CellFigure::name, "of the posture"),
                                         key("links_mm", &CellFigure::links_m, "a broken line each").entries(3),
                                         key("joints_mm", &CellFigure::joints_m, "a point of each axis").entries(3),
                                         key("flange_mm", &CellFigure::flange_m, "its origin").entries(3),
                                         key("tip_mm", &CellFigure::tip_m, "of the tool").entries(3)},
                                        Use::written);
  return table;
}

const Schema<CellDrawing>& drawing_table() {
  static const Schema<CellDrawing> table(
      "cell_drawing", "what a picture of the cell shows",
      {key("figures", &CellDrawing::figures, figure_table(), "home, and at the workpiece where that is reached"),
       key("reach_side_mm", &CellDrawing::reach_side_m, "outlines of the wrist's reach, x and z").entries(2),
       key("reach_top_mm", &CellDrawing::reach_top_m, "the same, x and y").entries(2),
       key("program_mm", &CellDrawing::program_m, "some points of its path").entries(3)},
      Use::written);
  return table;
}

const Schema<Cell>& checked_robot_table() {
  static const Schema<Cell> table(
      "cell_robot", "the robot of a cell",
      {key(
           "kind", [](const Cell& cell) { return cell.hybrid ? "hybrid-2upr-rpu" : "serial"; }, "of its joints")
           .words({"serial", "hybrid-2upr-rpu"}),
       key("model", &Cell::model, "by its name").nullable(),
       key("description", &Cell::description, "in words").nullable(),
       key("source", &Cell::source, "of its numbers").nullable()},
      Use::written);
  return table;
}

}  // namespace

const Schema<CellCheck>& check_table() {
  static const Schema<CellCheck> table(
      "check", "a robot cell: where its joints put the tool, and whether that comes to the workpiece",
      {key(
           "cell", [](const CellCheck& check) { return check.cell.path.filename().string(); }, "its file"),
       key("robot", &CellCheck::cell, checked_robot_table(), "of the cell"),
       key(
           "joints",
           [](const CellCheck& check) {
             std::vector<JointAt> out;
             out.reserve(static_cast<std::size_t>(check.joints));
             for (int i = 0; i < check.joints; ++i) out.push_back({&check, i});
             return out;
           },
           joint_table(), "one a joint"),
       key(
           "postures", [](const CellCheck& check) { return each(check, check.stands); }, stand_table(),
           "the requested ones, home, and the one at the workpiece's origin or the program's start"),
       key(
           "at_limits", [](const CellCheck& check) { return each(check, check.at_limits); }, stand_table(),
           "from home with one joint at one of its limits"),
       key(
           "placement", [](const CellCheck& check) { return &check; }, placement_table(), "of the workpiece"),
       key(
           "proposals", [](const CellCheck& check) { return each(check, check.proposals); }, proposal_table(),
           "the smallest change first"),
       key("drawing", &CellCheck::drawing, drawing_table(), "as lines"),
       key(
           "assumed", [](const CellCheck& check) { return check.cell.assumed; }, io::assumption_table(),
           "what the cell does not give"),
       key("notes", &CellCheck::notes, "sentences for the user")},
      Use::written, 1);
  return table;
}

std::string cell_check_json(const CellCheck& check) {
  return io::dump(check_table().write(check));
}

}  // namespace robomill::cell
