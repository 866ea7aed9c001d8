#include "robomill/cell/posture_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::cell {
namespace {

robot::Position6 six_of(const std::vector<double>& joints) {
  robot::Position6 out = robot::Position6::Zero();
  std::copy_n(joints.begin(), std::min<std::size_t>(joints.size(), 6), out.begin());
  return out;
}

/// "elbow", "shoulder and wrist", "shoulder, elbow and wrist": those that are, or are not, as at home.
std::string parts_of(const path::Resemblance& like, bool as_at_home) {
  std::vector<std::string> names;
  if (like.shoulder == as_at_home) names.emplace_back("shoulder");
  if (like.elbow == as_at_home) names.emplace_back("elbow");
  if (like.wrist == as_at_home) names.emplace_back("wrist");
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return out;
}

}  // namespace

robot::Position6 home_of(const Cell& cell, const robot::Kinematics& machine) {
  if (!cell.home.empty()) return six_of(cell.home);
  robot::Position6 out = robot::Position6::Zero();
  for (int i = 0; i < machine.joints(); ++i) {
    const double low = machine.limits().min_position(i), high = machine.limits().max_position(i);
    if (low > 0.0 || high < 0.0) out(i) = high - low < 1e3 ? 0.5 * (low + high) : std::clamp(0.0, low, high);
  }
  return out;
}

path::PostureOptions posture_options(const Cell& cell, const robot::Kinematics& machine) {
  path::PostureOptions out;
  if (cell.gamma_given) out.gamma_rad = cell.redundant_gamma_rad;
  if (!cell.start_joints.empty()) out.start = six_of(cell.start_joints);
  if (machine.turns_about_axis()) out.home = home_of(cell, machine);
  if (cell.posture_asked) out.margin_for_home = 1.0;
  out.home_asked = cell.posture_asked;
  return out;
}

void ask_for_posture(Cell& cell, const std::vector<double>& joints_deg) {
  const std::vector<robot::Joint>& joints = cell.robot.arm.joints;
  if (cell.hybrid) throw InvalidInput("--posture", "goes with serial arms; this machine has one way to a pose");
  if (joints_deg.size() != joints.size()) {
    throw InvalidInput("--posture",
                       fmt::format("must hold one angle a joint, {}; it holds {}", joints.size(), joints_deg.size()));
  }
  cell.start_joints.clear();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const robot::Joint& joint = joints[i];
    const double angle = joints_deg[i] * units::deg;
    if (!(angle >= joint.min_position && angle <= joint.max_position)) {
      throw InvalidInput("--posture", joints_deg[i], "°",
                         fmt::format("must lie within the limits; joint {} has {:.6g}° to {:.6g}°", i + 1,
                                     joint.min_position / units::deg, joint.max_position / units::deg));
    }
    cell.start_joints.push_back(angle);
  }
  cell.home = cell.start_joints;
  cell.posture_asked = true;
}

std::string posture_text(const path::PostureChoice& choice, int joints, const std::array<bool, 6>& prismatic) {
  std::string out;
  for (int i = 0; i < joints; ++i) {
    const bool slides = prismatic.at(static_cast<std::size_t>(i));
    const double value = choice.posture.start(i) / (slides ? units::mm : units::deg);
    // No "-0".
    out += fmt::format("{}{:.1f}{}", i > 0 ? ", " : "", std::abs(value) < 0.05 ? 0.0 : value, slides ? " mm" : "°");
  }
  if (!choice.resemblance) return out;
  const path::Resemblance& like = *choice.resemblance;
  if (like.known) {
    const std::string alike = parts_of(like, true), other = parts_of(like, false);
    if (!alike.empty()) out += "; " + alike + (like.asked ? " as asked" : " as at home");
    if (!other.empty()) out += (alike.empty() ? "; " : ", ") + other + " the other way";
  }
  if (like.turns > 0) {
    out += fmt::format("; {} whole turn{} from {}", like.turns, like.turns > 1 ? "s" : "",
                       like.asked ? "what was asked" : "home");
  }
  return out;
}

std::vector<std::string> posture_notes(const path::PostureChoice& choice) {
  std::vector<std::string> out;
  if (choice.resemblance) {
    const path::Resemblance& like = *choice.resemblance;
    if (const std::string other = parts_of(like, false); !other.empty()) {
      const std::string stands = fmt::format("The {} stand{}", other, other.find(' ') == std::string::npos ? "s" : "");
      out.push_back(stands + (like.asked ? " the other way than asked: as asked the program does not go through."
                                         : " the other way than at home: as at home the program does not go through "
                                           "with room to the limits. Move the arm there with care, or ask for another "
                                           "posture by --posture."));
    }
    if (like.turns > 0) {
      out.push_back(fmt::format("Joints are wound by {} whole turn{} from {}: mind cables and hoses.", like.turns,
                                like.turns > 1 ? "s" : "", like.asked ? "what was asked" : "home"));
    }
  }
  for (const path::AxisTilt& tilt : choice.posture.tilts) {
    out.push_back(fmt::format(
        "Block {} leads through a singularity of the wrist. The tool's axis is tilted by {:.2g}° beside it, "
        "within axis_tolerance_deg: joint 4 makes half a turn there and slows the tool down.",
        static_cast<std::size_t>(0.5 * (tilt.full_from + tilt.full_to)) + 1, tilt.angle_rad / units::deg));
  }
  if (const std::string near = path::singularity_text(choice.at_margin); !near.empty() && choice.margin.joint < 0) {
    out.push_back(
        fmt::format("In block {} {}: joints turn far there and slow the tool down. Move or tilt the workpiece{}.",
                    choice.margin.block + 1, near, choice.in_line ? "" : ", or turn the flange"));
  }
  return out;
}

}  // namespace robomill::cell
