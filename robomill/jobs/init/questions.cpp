#include "robomill/jobs/init/questions.hpp"

#include <algorithm>

#include "robomill/cutting/files/cut_schema.hpp"

namespace robomill::jobs {
namespace {

constexpr double fastest_rpm = 200'000.0, longest_mm = 10'000.0;

/// What is asked in a unit. @param low, high  what is allowed, in the unit of the keys
constexpr Question quantity(std::string_view id, std::string_view text, Quantity of, double low, double high,
                            Targets targets) {
  return {.id = id, .text = text, .quantity = of, .low = low, .high = high, .targets = targets};
}

/// Every question, in the order of asking.
constexpr Question all_questions[] = {
    {.id = "unit", .text = "Lengths without a unit are in mm or inch", .kind = Answer::length_unit},
    {.id = "voltage",
     .text = "What the records of hits hold: V, mV, or SI (N and m/s2)",
     .kind = Answer::voltage,
     .targets = {{Template::hits, "acquisition.voltage_unit"}},
     .otherwise = "SI"},
    quantity("hammer", "Sensitivity of the hammer", Quantity::force_sensitivity, 1e-6, 1e6,
             {{Template::hits, "acquisition.force_mv_per_n"}}),
    quantity("accelerometer", "Sensitivity of the accelerometer", Quantity::acceleration_sensitivity, 1e-6, 1e6,
             {{Template::hits, "acquisition.response_mv_per_g"}}),
    quantity("accelerometer mass", "Mass of the accelerometer", Quantity::mass, 0.0, 1.0,
             {{Template::hits, "acquisition.accelerometer_mass_kg"}}),
    {.id = "unmeasured",
     .text = "The direction that was not hit: is it like the other one, or rigid",
     .kind = Answer::unmeasured,
     .targets = {{Template::job, nullptr}}},
    {.id = "robot", .text = "Robot", .kind = Answer::robot, .targets = {{Template::cell, "robot.model"}}},
    quantity("tool length", "From the flange to the cutter's tip, along the spindle's axis", Quantity::length, 0.0,
             2000.0, {{Template::cell, "tool.length_mm"}}),
    quantity("zero x", "The program's zero in the robot's base frame: x", Quantity::length, -longest_mm, longest_mm,
             {{Template::cell, "workpiece.origin_mm[0]"}}),
    quantity("zero y", "The same: y", Quantity::length, -longest_mm, longest_mm,
             {{Template::cell, "workpiece.origin_mm[1]"}}),
    quantity("zero z", "The same: z", Quantity::length, -longest_mm, longest_mm,
             {{Template::cell, "workpiece.origin_mm[2]"}}),
    quantity("lowest speed", "Lowest spindle speed", Quantity::spindle_speed, 1.0, fastest_rpm,
             {{Template::job, "spindle.min_speed_rpm"}, {Template::lobes, "lobes.spindle_speed_rpm[0]"}}),
    quantity("highest speed", "Highest spindle speed", Quantity::spindle_speed, 1.0, fastest_rpm,
             {{Template::job, "spindle.max_speed_rpm"}, {Template::lobes, "lobes.spindle_speed_rpm[1]"}}),
    quantity("torque", "Highest torque of the spindle", Quantity::torque, 1e-3, 1e5, {{Template::job, nullptr}}),
    quantity("power", "Power of the spindle", Quantity::power, 1e-3, 1e4, {{Template::job, nullptr}}),
    quantity("speed", "Spindle speed", Quantity::spindle_speed, 1.0, fastest_rpm,
             {{Template::forces, "cut.spindle_speed_rpm"}, {Template::monitor, "process.spindle_speed_rpm"}}),
    quantity("diameter", "Diameter of the cutter", Quantity::length, 0.05, 1000.0,
             {{Template::lobes, "tool.diameter_mm"}, {Template::forces, "tool.diameter_mm"}}),
    quantity("shank", "Diameter of cutter and shank", Quantity::length, 1.0, 25.0,
             {{Template::assembly, "tool[0].diameter_mm"},
              {Template::assembly, "tool[1].diameter_mm"},
              {Template::assembly, "holder.segments[0].inner_diameter_mm"}}),
    quantity("edges", "Length of the cutting edges", Quantity::length, 0.05, 1000.0,
             {{Template::job, "tool.max_axial_depth_mm"}, {Template::assembly, "tool[0].length_mm"}}),
    quantity("overhang", "Plain shank between the edges and the holder", Quantity::length, 0.05, 1000.0,
             {{Template::assembly, "tool[1].length_mm"}}),
    {.id = "teeth",
     .text = "Teeth of the cutter",
     .kind = Answer::count,
     .low = 1.0,
     .high = 100.0,
     .targets = {{Template::lobes, "tool.teeth"},
                 {Template::forces, "tool.teeth"},
                 {Template::monitor, "process.teeth"},
                 {Template::assembly, "tool[0].flutes"}}},
    quantity("helix", "Helix angle", Quantity::angle, 0.0, 80.0, {{Template::forces, "tool.helix_deg"}}),
    {.id = "material",
     .text = "Material of the part",
     .kind = Answer::material,
     .targets = {{Template::lobes, "coefficients.material"}, {Template::forces, "coefficients.material"}}},
    {.id = "direction",
     .text = "Climb (down), conventional (up) or slot",
     .kind = Answer::direction,
     .targets = {{Template::lobes, "cut.direction"}, {Template::forces, "cut.direction"}}},
    quantity("radial depth", "Radial depth (ae)", Quantity::length, 1e-3, 1000.0,
             {{Template::lobes, cutting::radial_depth_of_cut}, {Template::forces, cutting::radial_depth_of_cut}}),
    quantity("axial depth", "Axial depth (ap)", Quantity::length, 1e-3, 1000.0,
             {{Template::forces, "cut.axial_depth_mm"}}),
    quantity("deepest", "Deepest cut to look at (ap)", Quantity::length, 1e-3, 1000.0,
             {{Template::lobes, "lobes.axial_depth_mm[1]"}}),
    quantity("feed", "Feed per tooth (fz)", Quantity::length, 1e-4, 10.0,
             {{Template::lobes, "cut.feed_per_tooth_mm"}, {Template::forces, "cut.feed_per_tooth_mm"}}),
};

}  // namespace

std::vector<Question> questions_of(Template kind) {
  using enum Template;
  const auto wanted = [kind](const Target& target) {
    return target.document == kind || (kind == job && (target.document == hits || target.document == lobes));
  };
  std::vector<Question> out;
  for (const Question& question : all_questions) {
    if (std::ranges::any_of(question.targets, wanted)) out.push_back(question);
  }
  const auto is_length = [](const Question& question) { return question.quantity == Quantity::length; };
  if (std::ranges::any_of(out, is_length)) out.insert(out.begin(), all_questions[0]);
  return out;
}

}  // namespace robomill::jobs
