#include "robomill/path/files/smooth_json.hpp"

#include <algorithm>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/program/files/skipped_schema.hpp"

namespace robomill::path {
namespace {

using io::add_rows;
using io::if_positive;
using io::Json;
using io::key;
using io::keys_of;
using io::Row;
using io::Schema;
using io::Use;
using robot::Clearance;

constexpr Name<Clearance::Status> clearance_names[] = {{"clear", Clearance::Status::clear},
                                                       {"too_near", Clearance::Status::too_near},
                                                       {"gouge", Clearance::Status::gouge},
                                                       {"collision", Clearance::Status::collision}};

const Schema<Usage>& place_table() {
  static const Schema<Usage> table("usage", "where a trajectory comes nearest to a limit",
                                   {key("violations", &Usage::violations, "samples beyond the limit"),
                                    key("at_s", &Usage::at_s, "when the largest is met").nullable(),
                                    key(
                                        "block", [](const Usage& usage) { return usage.block + 1; }, "in which block")},
                                   Use::written);
  return table;
}

/// "max_velocity_mm_per_s", "limit_velocity_mm_per_s" and "velocity".
/// @param suffix  of the unit
/// @param usage   (const T&) -> const Usage&
template <class T, class F>
void add_usage(std::vector<Row<T>>& rows, const std::string& name, const char* suffix, F usage) {
  rows.push_back(key(
                     "max_" + name + suffix, [usage](const T& at) { return usage(at).max; }, "largest")
                     .nullable());
  rows.push_back(
      key(
          "limit_" + name + suffix, [usage](const T& at) { return if_positive(usage(at).limit); }, "none: no limit")
          .nullable());
  rows.push_back(key(
      name, [usage](const T& at) { return &usage(at); }, place_table(), "where the largest is"));
}
template <class T>
void add_usage(std::vector<Row<T>>& rows, const std::string& name, const char* suffix, Usage T::*usage) {
  add_usage(rows, name, suffix, [usage](const T& at) -> const Usage& { return at.*usage; });
}

/// A joint of a trajectory.
struct JointView {
  const CheckResult::Joint* joint = nullptr;
  bool prismatic = false;
  const double* tracking_error = nullptr;  ///< null: not asked for
};

const Schema<JointView>& joint_table() {
  static const Schema<JointView> table(
      "smoothed_joint", "a joint along the trajectory, in its unit and s",
      [] {
        using Joint = CheckResult::Joint;
        std::vector<Row<JointView>> rows = {
            key(
                "unit", [](const JointView& at) { return at.prismatic ? "m" : "rad"; }, "of its position")
                .words({"rad", "m"})};
        std::vector<Row<Joint>> motion;
        add_usage(motion, "velocity", "", &Joint::velocity);
        add_usage(motion, "acceleration", "", &Joint::acceleration);
        add_usage(motion, "jerk", "", &Joint::jerk);
        add_rows(motion, {key(
                              "beyond_position", [](const Joint& joint) { return std::max(0.0, joint.position.max); },
                              "the most beyond its limits")
                              .nullable(),
                          key("position", &Joint::position, place_table(), "where that is"),
                          key(
                              "violations",
                              [](const Joint& joint) {
                                return joint.position.violations + joint.velocity.violations +
                                       joint.acceleration.violations + joint.jerk.violations;
                              },
                              "of all its limits")});
        add_rows(rows, keys_of<JointView>(motion, [](const JointView& at) -> const Joint& { return *at.joint; }));
        rows.push_back(where([](const JointView& at) { return at.tracking_error != nullptr; },
                             key(
                                 "max_tracking_error", [](const JointView& at) { return *at.tracking_error; },
                                 "of its drive, where that is modelled")
                                 .nullable()));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<CheckResult>& tip_table() {
  static const Schema<CheckResult> table(
      "smoothed_tip", "the tip along its path",
      [] {
        std::vector<Row<CheckResult>> rows;
        add_usage(rows, "velocity", "_mm_per_s", &CheckResult::tip_velocity);
        add_usage(rows, "acceleration", "_mm_per_s2", &CheckResult::tip_acceleration);
        add_usage(rows, "jerk", "_mm_per_s3", &CheckResult::tip_jerk);
        add_usage(rows, "error", "_mm", &CheckResult::tip_error_m);
        add_usage(rows, "share_of_feed", "", &CheckResult::feed);
        rows.push_back(key(
            "violations",
            [](const CheckResult& check) {
              return check.tip_velocity.violations + check.tip_acceleration.violations + check.tip_jerk.violations +
                     check.tip_error_m.violations + check.feed.violations;
            },
            "of all these"));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<CheckResult>& axis_table() {
  static const Schema<CheckResult> table(
      "smoothed_axis", "the tool's axis along its path",
      [] {
        std::vector<Row<CheckResult>> rows;
        add_usage(rows, "velocity", "_deg_per_s", &CheckResult::axis_velocity);
        add_usage(rows, "acceleration", "_deg_per_s2", &CheckResult::axis_acceleration);
        add_usage(rows, "jerk", "_deg_per_s3", &CheckResult::axis_jerk);
        add_usage(rows, "error", "_deg", &CheckResult::axis_error_rad);
        rows.push_back(key(
            "violations",
            [](const CheckResult& check) {
              return check.axis_velocity.violations + check.axis_acceleration.violations + check.axis_jerk.violations +
                     check.axis_error_rad.violations;
            },
            "of all these"));
        return rows;
      }(),
      Use::written);
  return table;
}

/// One method's trajectory.
struct MethodView {
  const SmoothedBy* smoothed = nullptr;
  const std::array<bool, 6>* prismatic = nullptr;
  [[nodiscard]] const Summary& summary() const { return smoothed->summary; }
  [[nodiscard]] const CheckResult& check() const { return smoothed->summary.check; }
};

std::vector<JointView> joints_of(const MethodView& at) {
  std::vector<JointView> out;
  for (std::size_t i = 0; i < at.check().joints.size(); ++i) {
    const bool tracked = i < at.smoothed->tracking_error.size();
    out.push_back({.joint = &at.check().joints[i],
                   .prismatic = at.prismatic->at(i),
                   .tracking_error = tracked ? &at.smoothed->tracking_error[i] : nullptr});
  }
  return out;
}

std::vector<Row<MethodView>> method_keys() {
  using View = MethodView;
  std::vector<Row<View>> rows = {
      key(
          "method", [](const View& at) { return at.smoothed->method; }, method_names, "by which it was smoothed"),
      key(
          "duration_s", [](const View& at) { return at.summary().duration_s; }, "of the trajectory"),
      key(
          "lower_bound_s", [](const View& at) { return if_positive(at.summary().lower_bound_s); },
          "no trajectory within the limits is shorter; none: not computed")
          .nullable(),
      key(
          "max_tip_error_mm", [](const View& at) { return at.check().tip_error_m.max; }, "from the program's path")
          .nullable(),
      key(
          "max_axis_error_deg", [](const View& at) { return at.check().axis_error_rad.max; }, "from the program's axis")
          .nullable(),
      key(
          "violations", [](const View& at) { return at.check().violations(); }, "of all limits, faulty samples too"),
      key(
          "tip", [](const View& at) { return &at.check(); }, tip_table(), "of the tool"),
      key(
          "axis", [](const View& at) { return &at.check(); }, axis_table(), "of the tool"),
      key(
          "joints", [](const View& at) { return joints_of(at); }, joint_table(), "one a joint")};
  add_usage(rows, "pose_error", "_mm", [](const View& at) -> const Usage& { return at.check().pose_error; });
  add_usage(rows, "dwell_error", "_s", [](const View& at) -> const Usage& { return at.check().dwell_s; });
  add_rows(rows, {key(
                      "faulty_samples", [](const View& at) { return at.check().faulty; },
                      "not finite, or off the grid of samples"),
                  key(
                      "blocks", [](const View& at) { return at.summary().blocks; }, "of the program"),
                  key(
                      "samples", [](const View& at) { return at.summary().samples; }, "of the trajectory"),
                  key(
                      "rounds", [](const View& at) { return at.summary().rounds; }, "of planning"),
                  key(
                      "plan_seconds", [](const View& at) { return at.summary().plan_s; }, "computing time of the plan"),
                  key(
                      "microseconds_per_sample",
                      [](const View& at) {
                        const double samples = static_cast<double>(std::max<std::size_t>(at.summary().samples, 1));
                        return at.summary().emit_s / samples / units::us;
                      },
                      "computing time"),
                  key(
                      "sum_t2_s", [](const View& at) { return if_positive(at.summary().sum_t2_s); },
                      "of the FIR methods: ΣT2")
                      .nullable(),
                  key(
                      "largest_overlap_s", [](const View& at) { return if_positive(at.summary().largest_overlap_s); },
                      "of the FIR methods: of neighbouring blocks")
                      .nullable()});
  return rows;
}

const Schema<MethodView>& method_table() {
  static const Schema<MethodView> table("smoothed_method", "one method's trajectory", method_keys(), Use::written);
  return table;
}

const Schema<PathClearance>& clearance_table() {
  using Path = PathClearance;
  const auto near = [](const Path& path) { return !path.clearance.first.empty(); };
  static const Schema<Path> table(
      "collisions", "the trajectory against what the cell's [geometry] describes",
      {key(
           "status", [](const Path& path) { return path.clearance.status; }, clearance_names,
           "of the nearest position"),
       key(
           "bodies",
           [near](const Path& path) {
             return near(path) ? std::vector<std::string>{path.clearance.first, path.clearance.second}
                               : std::vector<std::string>();
           },
           "the two that the status is about"),
       key(
           "least_distance_mm",
           [near](const Path& path) { return near(path) ? std::optional(path.clearance.distance_m) : std::nullopt; },
           "none: nothing within looked_within_mm")
           .nullable(),
       key(
           "depth_mm", [](const Path& path) { return path.clearance.depth_m; },
           "of a gouge or a collision of the edges"),
       key("clearance_mm", &Path::required_m, "that the cell asks for"),
       key("looked_within_mm", &Path::reach_m, "distances up to which were looked for"),
       key(
           "block", [](const Path& path) { return path.block + 1; }, "of that position"),
       key(
           "line", [](const Path& path) { return path.line > 0 ? std::optional(path.line) : std::nullopt; },
           "of that position; none: not known")
           .nullable(),
       key("at_s", &Path::time_s, "of that position"), key("positions", &Path::looks, "that were looked at"),
       key("most_between_mm", &Path::between_m, "way of a point of arm or tool between two of them"),
       key(
           "text", [](const Path& path) { return clearance_text(path); }, "in words")},
      Use::written);
  return table;
}

const Schema<ProgramRun>& run_table() {
  const auto distance = [](double RunDistances::*member) {
    return [member](const ProgramRun& run) { return run.distances.*member; };
  };
  static const Schema<ProgramRun> table(
      "robot_program", "a joint program, as its controller runs it",
      {key("points", &ProgramRun::points, "of the program"),
       key("shortest_step_ms", &ProgramRun::shortest_step_s, "from point to point"),
       key("longest_step_ms", &ProgramRun::longest_step_s, "from point to point"),
       key("max_joint_deviation_deg", distance(&RunDistances::joint_deviation_rad), "from the trajectory"),
       key("max_tip_deviation_mm", distance(&RunDistances::tip_deviation_m), "from the trajectory"),
       key("max_axis_deviation_deg", distance(&RunDistances::axis_deviation_rad), "from the trajectory"),
       key("max_tip_error_mm", distance(&RunDistances::tip_error_m), "from the program's path"),
       key("max_axis_error_deg", distance(&RunDistances::axis_error_rad), "from the program's axis"),
       key("limit_error_mm", &ProgramRun::tip_tolerance_m, "of the tip"),
       key("limit_error_deg", &ProgramRun::axis_tolerance_rad, "of the axis"),
       key("spindle_speeds_rpm", &ProgramRun::spindle_speeds_rad_per_s,
           "that the NC program asks for; the joint program carries out one at most"),
       key(
           "most_points",
           [](const ProgramRun& run) { return run.most_points > 0 ? std::optional(run.most_points) : std::nullopt; },
           "that such a controller loads; none: not known")
           .nullable(),
       key(
           "holds", [](const ProgramRun& run) { return run.holds(); }, "within the tolerances, and not too long")},
      Use::written);
  return table;
}

/// The position of a joint.
struct PositionView {
  double position = 0.0;
  bool prismatic = false;
};

const Schema<PositionView>& position_table() {
  static const Schema<PositionView> table(
      "joint_position", "position of a joint",
      {key(
           "unit", [](const PositionView& at) { return at.prismatic ? "mm" : "deg"; }, "of it")
           .words({"deg", "mm"}),
       key(
           "position", [](const PositionView& at) { return at.position / (at.prismatic ? units::mm : units::deg); },
           "in that unit")},
      Use::written);
  return table;
}

/// A key of the whole program.
std::vector<Row<SmoothedProgram>> program_keys() {
  using Program = SmoothedProgram;
  return {key("written", &Program::written, "there is a trajectory"),
          key("program", &Program::program, "name of its file"),
          key("cell", &Program::cell, "name of its file"),
          key(
              "gamma_deg", [](const Program& smoothed) { return smoothed.gamma_rad; },
              "lowest and highest turn of the flange about the tool's axis; none: the machine has no such freedom")
              .entries(2)
              .null_list(),
          key(
              "posture",
              [](const Program& smoothed) {
                const int joints = static_cast<int>(smoothed.methods.front().summary.check.joints.size());
                return smoothed.posture ? std::optional(PostureView{&*smoothed.posture, joints, &smoothed.prismatic})
                                        : std::nullopt;
              },
              posture_table(), "in which the arm begins; none: it was given")
              .nullable(),
          key("skipped", &Program::skipped, program::skipped_table(), "what the reader of the program left out"),
          key("notes", &Program::notes, "sentences for the user"),
          key("assumed", &Program::assumed, io::assumption_table(), "what the input did not give"),
          key(
              "collisions", [](const Program& smoothed) { return smoothed.clearance; }, clearance_table(),
              "none: not checked")
              .nullable(),
          key(
              "robot_program", [](const Program& smoothed) { return smoothed.robot_program; }, run_table(),
              "where it is written as one")
              .nullable(),
          where([](const Program& smoothed) { return smoothed.methods.size() > 1; },
                key(
                    "methods",
                    [](const Program& smoothed) {
                      std::vector<MethodView> out;
                      for (const SmoothedBy& method : smoothed.methods) out.push_back({&method, &smoothed.prismatic});
                      return out;
                    },
                    method_table(), "all of them, the one asked for first"))};
}

}  // namespace

const Schema<PostureView>& posture_table() {
  using View = PostureView;
  const auto as_at_home = [](bool Resemblance::*part) {
    return [part](const View& view) {
      const std::optional<Resemblance>& to_home = view.choice->resemblance;
      return to_home && to_home->known ? std::optional((*to_home).*part) : std::nullopt;
    };
  };
  static const Schema<View> table(
      "start_posture", "how a program's start was chosen",
      {key(
           "joints",
           [](const View& view) {
             std::vector<PositionView> out;
             out.reserve(static_cast<std::size_t>(view.joints));
             for (int i = 0; i < view.joints; ++i)
               out.push_back({view.choice->posture.start(i), view.prismatic->at(static_cast<std::size_t>(i))});
             return out;
           },
           position_table(), "of the start"),
       key("shoulder_as_at_home", as_at_home(&Resemblance::shoulder), "none: not known").nullable(),
       key("elbow_as_at_home", as_at_home(&Resemblance::elbow), "none: not known").nullable(),
       key("wrist_as_at_home", as_at_home(&Resemblance::wrist), "none: not known").nullable(),
       key(
           "whole_turns_from_home",
           [](const View& view) {
             return view.choice->resemblance ? std::optional(view.choice->resemblance->turns) : std::nullopt;
           },
           "of all joints that bring them nearer to home")
           .nullable(),
       key(
           "margin", [](const View& view) { return view.choice->margin.least; }, "to limits and singularities, 0 to 1"),
       key(
           "margin_block", [](const View& view) { return view.choice->margin.block + 1; }, "where it is least"),
       key(
           "margin_joint",
           [](const View& view) {
             const int joint = view.choice->margin.joint;
             return joint < 0 ? std::nullopt : std::optional(joint + 1);
           },
           "whose limit is nearest; none: a singularity is nearer")
           .nullable(),
       key(
           "near_singularity", [](const View& view) { return singularity_text(view.choice->at_margin); },
           "in words, where the margin is least")
           .nullable()},
      Use::written);
  return table;
}

const Schema<SmoothedProgram>& smooth_table() {
  static const Schema<SmoothedProgram> table(
      "smooth", "a smoothed program: of the first method, then of all where there are several",
      [] {
        std::vector<Row<SmoothedProgram>> rows =
            keys_of<SmoothedProgram>(method_keys(), [](const SmoothedProgram& smoothed) {
              return MethodView{&smoothed.methods.front(), &smoothed.prismatic};
            });
        add_rows(rows, program_keys());
        return rows;
      }(),
      Use::written, 1);
  return table;
}

Json smooth_object(const SmoothedProgram& smoothed) {
  if (smoothed.methods.empty()) throw InvalidInput("methods", "must hold at least one");
  return smooth_table().write(smoothed);
}

std::string smooth_json(const SmoothedProgram& smoothed) {
  return io::dump(smooth_object(smoothed));
}

}  // namespace robomill::path
