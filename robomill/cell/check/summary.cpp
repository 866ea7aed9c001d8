#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/check.hpp"
#include "robomill/cell/check/shown.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/io/note_lines.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/robot/euler.hpp"

namespace robomill::cell {
namespace {

using io::append;

constexpr std::size_t most_misses_shown = 10;

/// A number with so many decimals, none of them where it is unlimited or not given.
std::string decimal(double value, double unit, int decimals, bool given, bool assumed = false) {
  if (!given) return "–";
  const double shown = value / unit;
  return fmt::format("{:.{}f}{}", std::abs(shown) < 0.5 * std::pow(10.0, -decimals) ? 0.0 : shown, decimals,
                     assumed ? "*" : "");
}

/// The numbers of a vector.
std::string vector_text(const Eigen::Ref<const Eigen::VectorXd>& values, double unit, int decimals) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "" : ", ") + decimal(value, unit, decimals, true);
  return out;
}

std::string euler_text(const Eigen::Matrix3d& turn) {
  const robot::Euler angles = robot::euler_of(turn);
  return vector_text(Eigen::Vector3d(angles.a_rad, angles.b_rad, angles.c_rad), units::deg, 3);
}

void add_limits(std::string& out, const CellCheck& check) {
  const auto assumed = [&](const char* key) {
    return std::ranges::any_of(check.cell.assumed, [key](const Assumption& one) { return one.key == key; });
  };
  const bool velocity = assumed("robot.joint_max_velocity"), acceleration = assumed("robot.joint_max_acceleration"),
             jerk = assumed("robot.joint_max_jerk"), low = assumed("robot.joint_min_position"),
             high = assumed("robot.joint_max_position");
  const char* const unit = check.cell.hybrid ? "mm" : "°";
  append(out, "{:<8}{:>11}{:>11}{:>12}{:>14}{:>12}\n", "joint", fmt::format("from {}", unit),
         fmt::format("to {}", unit), fmt::format("{}/s", unit), fmt::format("{}/s²", unit), fmt::format("{}/s³", unit));
  for (int i = 0; i < check.joints; ++i) {
    const double size = joint_unit(check.prismatic, i).size;
    const robot::JointLimits& limits = check.limits;
    append(out, "{:<8}{:>11}{:>11}{:>12}{:>14}{:>12}\n", i + 1,
           decimal(limits.min_position(i), size, 2, is_limit(limits.min_position(i)), low),
           decimal(limits.max_position(i), size, 2, is_limit(limits.max_position(i)), high),
           decimal(limits.max_velocity(i), size, 2, limits.max_velocity(i) > 0.0, velocity),
           decimal(limits.max_acceleration(i), size, 1, limits.max_acceleration(i) > 0.0, acceleration),
           decimal(limits.max_jerk(i), size, 0, limits.max_jerk(i) > 0.0, jerk));
  }
  if (velocity || acceleration || jerk || low || high) append(out, "* assumed, see below\n");
}

/// "0.00, -80.00, 108.00, …"
std::string joints_text(const CellCheck& check, const robot::Position6& position) {
  std::string out;
  for (int i = 0; i < check.joints; ++i) {
    out += (i > 0 ? ", " : "") + decimal(position(i), joint_unit(check.prismatic, i).size, 2, true);
  }
  return out;
}

/// "180.00° (half its range, at most 180°)": what a joint's way to its nearer limit is a share of, as path::limit_share
/// has it.
std::string half_range_text(const CellCheck& check, int joint) {
  const JointUnit unit = joint_unit(check.prismatic, joint);
  const robot::JointLimits& limits = check.limits;
  const double half = std::min(0.5 * limits.max_position(joint) - 0.5 * limits.min_position(joint), std::numbers::pi);
  return fmt::format("{:.2f}{} (half its range{})", half / unit.size, unit.text,
                     check.prismatic.at(static_cast<std::size_t>(joint)) ? "" : ", at most 180°");
}

/// How far a stand is from what it cannot do.
std::string distances_text(const CellCheck& check, const CellStand& stand) {
  std::string out;
  for (int i = 0; i < check.joints; ++i) {
    const JointUnit unit = joint_unit(check.prismatic, i);
    if (stand.to_limit(i) >= 0.0) continue;
    out += fmt::format("joint {} is {:.2f}{} beyond its limit; ", i + 1, -stand.to_limit(i) / unit.size, unit.text);
  }
  if (out.empty() && stand.nearest_joint >= 0) {
    const JointUnit unit = joint_unit(check.prismatic, stand.nearest_joint);
    out = fmt::format("joint {} is nearest to its limit, {:.2f}{} of {}; ", stand.nearest_joint + 1,
                      stand.to_limit(stand.nearest_joint) / unit.size, unit.text,
                      half_range_text(check, stand.nearest_joint));
  }
  return out + fmt::format("condition number {:.3g}", stand.condition_number);
}

void add_stand(std::string& out, const CellCheck& check, const CellStand& stand) {
  const Eigen::Matrix3d& turn = stand.flange.linear();
  const Eigen::Quaterniond q(turn);
  const Eigen::AngleAxisd about(turn);
  append(out, "\n{}: joints {}{}\n", stand.name, joints_text(check, stand.position), check.cell.hybrid ? " mm" : "°");
  append(out, "  tip in the robot's base    {} mm, axis {}\n", vector_text(stand.tip_m, units::mm, 3),
         vector_text(stand.axis, 1.0, 5));
  append(out, "  tip in the program's frame {} mm, axis {}, γ {}°\n", vector_text(stand.tool.tip_m, units::mm, 3),
         vector_text(stand.tool.axis, 1.0, 5), decimal(stand.tool.gamma_rad, units::deg, 2, true));
  append(out, "  flange in the robot's base {} mm, A B C {}°\n", vector_text(stand.flange.translation(), units::mm, 3),
         euler_text(turn));
  append(out, "    quaternion {}; rotation vector {} rad\n",
         vector_text(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()) * (q.w() < 0.0 ? -1.0 : 1.0), 1.0, 5),
         vector_text(Eigen::Vector3d(about.angle() * about.axis()), 1.0, 5));
  append(out, "  {}\n", distances_text(check, stand));
}

void add_at_limits(std::string& out, const CellCheck& check) {
  if (check.at_limits.empty()) return;
  append(out, "\n{:<30}{:>34}{:>32}\n", "from home", "tip in the base, mm", "flange A B C, °");
  for (const CellStand& stand : check.at_limits) {
    append(out, "{:<30}{:>34}{:>32}\n", stand.name, vector_text(stand.tip_m, units::mm, 1),
           euler_text(stand.flange.linear()));
  }
}

std::string place_of(const CellCheck& check, const Miss& miss) {
  if (check.program.empty()) return "the workpiece's origin";
  if (miss.block == 0) return "the program's start";
  return fmt::format("block {} (line {})", miss.block, miss.line);
}

/// By how much a pose is missed, for comparison: out of reach weighs more than limits, these more than a singularity.
double excess_of(const Miss& miss) {
  if (miss.status == robot::Reach::Status::out_of_reach) return 1e6 + miss.out_of_reach_m + miss.out_of_reach_rad;
  double most = 0.0;
  for (const BeyondLimit& beyond : miss.beyond) most = std::max(most, std::abs(beyond.position - beyond.limit));
  return most;
}

/// " with γ 30°", " with γ from 30° to 45°"; nothing of a machine that has none.
std::string gamma_text(const CellCheck& check, const path::PostureChoice& choice) {
  const std::vector<double>& gamma_rad = choice.posture.gamma_rad;
  if (check.cell.hybrid || gamma_rad.empty()) return {};
  const auto [low, high] = std::ranges::minmax(gamma_rad);
  if (low == high) return fmt::format(" with γ {}°", decimal(low, units::deg, 1, true));
  return fmt::format(" with γ from {}° to {}°", decimal(low, units::deg, 1, true), decimal(high, units::deg, 1, true));
}

/// "margin 0.278, of joint 6: 50.00° to its limit of 350°, of 180.00° (half its range, at most 180°)"
std::string margin_text(const CellCheck& check, const path::Margin& margin) {
  if (margin.joint < 0) {
    return fmt::format("margin {:.3g}, to a singularity: 1 / {:.3g}, the condition number of the Jacobian there",
                       margin.least, 1.0 / margin.least);
  }
  const JointUnit unit = joint_unit(check.prismatic, margin.joint);
  const double low = check.limits.min_position(margin.joint), high = check.limits.max_position(margin.joint);
  const double at = margin.position(margin.joint);
  const double limit = at - low < high - at ? low : high;
  return fmt::format("margin {:.3g}, of joint {}: {:.2f}{} to its limit of {:.6g}{}, of {}", margin.least,
                     margin.joint + 1, std::abs(limit - at) / unit.size, unit.text, limit / unit.size, unit.text,
                     half_range_text(check, margin.joint));
}

void add_placement(std::string& out, const CellCheck& check) {
  const Placement& placement = check.placement;
  std::string what = check.program.empty() ? "the workpiece's origin" : printable(check.program);
  if (!check.whole) what = "the begin of " + what;
  if (placement.works()) {
    append(out, "\nplacement  {} is reached{}; least {}\n", what, gamma_text(check, placement.choice),
           margin_text(check, placement.choice.margin));
    append(out, "posture    {}\n", posture_text(placement.choice, check.joints, check.prismatic));
    return;
  }
  append(out, "\nplacement  fails: ");
  if (!placement.no_way.empty()) {
    append(out, "every block of {} can be reached for itself, but {}\n", what, placement.no_way);
  } else {
    append(out, "{} of {}{} poses of {} cannot be taken{}\n", placement.misses.size(),
           placement.complete ? "" : "the first ", placement.poses, what,
           placement.complete ? "" : "; the rest was not looked at");
  }
  for (std::size_t i = 0; i < std::min(placement.misses.size(), most_misses_shown); ++i) {
    const Miss& miss = placement.misses[i];
    append(out, "  {}: {}\n", place_of(check, miss), what_misses(miss, check.prismatic));
  }
  if (placement.misses.size() > most_misses_shown) {
    const Miss& worst = *std::ranges::max_element(placement.misses, {}, excess_of);
    append(out, "  … and {} more, of all the worst {}: {}\n", placement.misses.size() - most_misses_shown,
           place_of(check, worst), what_misses(worst, check.prismatic));
  }
}

void add_proposals(std::string& out, const CellCheck& check) {
  if (check.placement.works()) return;
  if (check.proposals.empty()) append(out, "\nNo workpiece pose was found nearby that serves.\n");
  for (const Proposal& proposal : check.proposals) {
    const robot::Euler turn = robot::euler_of(proposal.placement.workpiece.linear());
    append(out, "\nproposal   shift {} mm, turn {}° about z:\n", vector_text(proposal.shift_m, units::mm, 0),
           decimal(proposal.turn_rad, units::deg, 0, true));
    append(out, "  origin_mm = [{}]\n  rotation_deg = [{}]\n",
           vector_text(proposal.placement.workpiece.translation(), units::mm, 3),
           vector_text(Eigen::Vector3d(turn.c_rad, turn.b_rad, turn.a_rad), units::deg, 4));
    append(out, "  reached{}; least {}\n", gamma_text(check, proposal.placement.choice),
           margin_text(check, proposal.placement.choice.margin));
  }
}

}  // namespace

std::string what_misses(const Miss& miss, const std::array<bool, 6>& prismatic) {
  if (miss.status == robot::Reach::Status::singular) {
    return fmt::format("singular (condition number {:.3g})", miss.condition_number);
  }
  if (miss.status == robot::Reach::Status::out_of_reach) {
    if (miss.out_of_reach_m > 0.0) return fmt::format("out of reach by {:.4g} mm", miss.out_of_reach_m / units::mm);
    if (miss.out_of_reach_rad > 0.0) {
      return fmt::format("out of reach: the wrist would have to bend by {:.4g}° more",
                         miss.out_of_reach_rad / units::deg);
    }
    return "out of reach";
  }
  std::string out;
  for (const BeyondLimit& beyond : miss.beyond) {
    const JointUnit unit = joint_unit(prismatic, beyond.joint);
    out += fmt::format("{}joint {} is {:.4g}{} {} limit of {:.6g}{}", out.empty() ? "" : "; ", beyond.joint + 1,
                       std::abs(beyond.position - beyond.limit) / unit.size, unit.text,
                       beyond.above() ? "above its upper" : "below its lower", beyond.limit / unit.size, unit.text);
  }
  return out;
}

std::string summary(const CellCheck& check) {
  std::string out = printable(check.cell.path.filename().string());
  if (!check.cell.description.empty()) append(out, ": {}", printable(check.cell.description));
  append(out, "\n\n");
  add_limits(out, check);
  for (const CellStand& stand : check.stands) add_stand(out, check, stand);
  append(out,
         "\nA B C turn about z, y' and x'' (KUKA; FANUC's R P W, Yaskawa's Rz Ry Rx); the flange is before any "
         "mount.\n");
  add_at_limits(out, check);
  add_placement(out, check);
  add_proposals(out, check);
  io::add_notes(out, check.notes, "note       ");
  out += assumed_text(check.cell.assumed);
  return out;
}

}  // namespace robomill::cell
