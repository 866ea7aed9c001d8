#include "robomill/jobs/init/questions.hpp"

#include <algorithm>
#include <array>

namespace robomill::jobs {
namespace {

constexpr double fastest_rpm = 200'000.0, longest_mm = 10'000.0;

/// Every question, in the order of asking.
const std::vector<Question>& all_questions() {
  using enum Template;
  static const std::vector<Question> questions = {
      {.id = "unit", .text = "Lengths without a unit are in mm or inch", .kind = Answer::length_unit},
      {.id = "voltage",
       .text = "What the records of hits hold: V, mV, or SI (N and m/s2)",
       .kind = Answer::voltage,
       .targets = {{hits, "acquisition.voltage_unit"}},
       .otherwise = "SI"},
      {.id = "hammer",
       .text = "Sensitivity of the hammer",
       .quantity = Quantity::force_sensitivity,
       .low = 1e-6,
       .high = 1e6,
       .targets = {{hits, "acquisition.force_mv_per_n"}},
       .otherwise = "2.25"},
      {.id = "accelerometer",
       .text = "Sensitivity of the accelerometer",
       .quantity = Quantity::acceleration_sensitivity,
       .low = 1e-6,
       .high = 1e6,
       .targets = {{hits, "acquisition.response_mv_per_g"}},
       .otherwise = "100"},
      {.id = "accelerometer mass",
       .text = "Mass of the accelerometer",
       .quantity = Quantity::mass,
       .high = 1.0,
       .targets = {{hits, "acquisition.accelerometer_mass_kg"}}},
      {.id = "robot", .text = "Robot", .kind = Answer::robot, .targets = {{cell, "robot.model"}}},
      {.id = "tool length",
       .text = "From the flange to the cutter's tip, along the spindle's axis",
       .quantity = Quantity::length,
       .high = 2000.0,
       .targets = {{cell, "tool.length_mm"}}},
      {.id = "zero x",
       .text = "The program's zero in the robot's base frame: x",
       .quantity = Quantity::length,
       .low = -longest_mm,
       .high = longest_mm,
       .targets = {{cell, "workpiece.origin_mm[0]"}}},
      {.id = "zero y",
       .text = "The same: y",
       .quantity = Quantity::length,
       .low = -longest_mm,
       .high = longest_mm,
       .targets = {{cell, "workpiece.origin_mm[1]"}}},
      {.id = "zero z",
       .text = "The same: z",
       .quantity = Quantity::length,
       .low = -longest_mm,
       .high = longest_mm,
       .targets = {{cell, "workpiece.origin_mm[2]"}}},
      {.id = "lowest speed",
       .text = "Lowest spindle speed",
       .quantity = Quantity::spindle_speed,
       .low = 1.0,
       .high = fastest_rpm,
       .targets = {{job, "spindle.min_speed_rpm"}, {lobes, "lobes.spindle_speed_rpm[0]"}}},
      {.id = "highest speed",
       .text = "Highest spindle speed",
       .quantity = Quantity::spindle_speed,
       .low = 1.0,
       .high = fastest_rpm,
       .targets = {{job, "spindle.max_speed_rpm"}, {lobes, "lobes.spindle_speed_rpm[1]"}}},
      {.id = "torque",
       .text = "Highest torque of the spindle",
       .quantity = Quantity::torque,
       .low = 1e-3,
       .high = 1e5,
       .targets = {{job, nullptr}}},
      {.id = "power",
       .text = "Power of the spindle",
       .quantity = Quantity::power,
       .low = 1e-3,
       .high = 1e4,
       .targets = {{job, nullptr}}},
      {.id = "speed",
       .text = "Spindle speed",
       .quantity = Quantity::spindle_speed,
       .low = 1.0,
       .high = fastest_rpm,
       .targets = {{forces, "cut.spindle_speed_rpm"}, {monitor, "process.spindle_speed_rpm"}}},
      {.id = "diameter",
       .text = "Diameter of the cutter",
       .quantity = Quantity::length,
       .low = 0.05,
       .high = 1000.0,
       .targets = {{lobes, "tool.diameter_mm"}, {forces, "tool.diameter_mm"}}},
      {.id = "shank",
       .text = "Diameter of cutter and shank",
       .quantity = Quantity::length,
       .low = 1.0,
       .high = 25.0,
       .targets = {{assembly, "tool[0].diameter_mm"},
                   {assembly, "tool[1].diameter_mm"},
                   {assembly, "holder.segments[0].inner_diameter_mm"}}},
      {.id = "edges",
       .text = "Length of the cutting edges",
       .quantity = Quantity::length,
       .low = 0.05,
       .high = 1000.0,
       .targets = {{job, "tool.max_axial_depth_mm"}, {assembly, "tool[0].length_mm"}}},
      {.id = "overhang",
       .text = "Plain shank between the edges and the holder",
       .quantity = Quantity::length,
       .low = 0.05,
       .high = 1000.0,
       .targets = {{assembly, "tool[1].length_mm"}}},
      {.id = "teeth",
       .text = "Teeth of the cutter",
       .kind = Answer::count,
       .low = 1.0,
       .high = 100.0,
       .targets =
           {{lobes, "tool.teeth"}, {forces, "tool.teeth"}, {monitor, "process.teeth"}, {assembly, "tool[0].flutes"}}},
      {.id = "helix",
       .text = "Helix angle",
       .quantity = Quantity::angle,
       .high = 80.0,
       .targets = {{forces, "tool.helix_deg"}}},
      {.id = "material",
       .text = "Material of the part",
       .kind = Answer::material,
       .targets = {{lobes, "coefficients.material"}, {forces, "coefficients.material"}}},
      {.id = "direction",
       .text = "Climb (down), conventional (up) or slot",
       .kind = Answer::direction,
       .targets = {{lobes, "cut.direction"}, {forces, "cut.direction"}}},
      {.id = "radial depth",
       .text = "Radial depth (ae)",
       .quantity = Quantity::length,
       .low = 1e-3,
       .high = 1000.0,
       .targets = {{lobes, "cut.radial_depth_mm"}, {forces, "cut.radial_depth_mm"}}},
      {.id = "axial depth",
       .text = "Axial depth (ap)",
       .quantity = Quantity::length,
       .low = 1e-3,
       .high = 1000.0,
       .targets = {{forces, "cut.axial_depth_mm"}}},
      {.id = "deepest",
       .text = "Deepest cut to look at (ap)",
       .quantity = Quantity::length,
       .low = 1e-3,
       .high = 1000.0,
       .targets = {{lobes, "lobes.axial_depth_mm[1]"}}},
      {.id = "feed",
       .text = "Feed per tooth (fz)",
       .quantity = Quantity::length,
       .low = 1e-4,
       .high = 10.0,
       .targets = {{lobes, "cut.feed_per_tooth_mm"}, {forces, "cut.feed_per_tooth_mm"}}},
  };
  return questions;
}

}  // namespace

std::vector<Question> questions_of(Template kind) {
  using enum Template;
  const auto wanted = [kind](const Target& target) {
    return target.document == kind || (kind == job && (target.document == hits || target.document == lobes));
  };
  std::vector<Question> out;
  for (const Question& question : all_questions()) {
    if (std::ranges::any_of(question.targets, wanted)) out.push_back(question);
  }
  const auto is_length = [](const Question& question) { return question.quantity == Quantity::length; };
  if (std::ranges::any_of(out, is_length)) out.insert(out.begin(), all_questions().front());
  return out;
}

}  // namespace robomill::jobs
