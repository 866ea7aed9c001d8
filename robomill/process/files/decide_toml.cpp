#include "robomill/process/files/decide_toml.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::process {
namespace {

void read_range(io::TomlFile& file, const std::string& key, const std::string& member, double factor,
                std::array<double, 2>& out) {
  std::vector<double> range;
  if (!file.numbers(key, member, factor, range)) return;
  if (range.size() != 2) throw file.reject(key, "must be [least, most]");
  out = {range[0], range[1]};
}

void read_free(io::TomlFile& file, DecideOptions& out) {
  std::vector<std::string> free;
  if (!file.texts("decide.free", free)) return;
  out.free.clear();
  for (const std::string& word : free) {
    const std::optional<Free> what = value_in(free_names, word);
    if (!what) throw file.reject("decide.free", "of \"" + word + "\": each " + one_of(free_names));
    if (!out.is_free(*what)) out.free.push_back(*what);
  }
}

/// A plan without a program recommends speed and depth by removal rate: what says something else would have no effect.
void check_without_program(io::TomlFile& file, const DecideOptions& options) {
  constexpr const char* needed = "A decision needs job.program with job.forces and job.cell";
  if (file.has("decide.goal") && options.goal != Goal::removal_rate) {
    throw file.reject("decide.goal", "must be \"removal_rate\" in a job without a program", needed);
  }
  const bool speed_and_depth =
      options.free.size() == 2 && options.is_free(Free::spindle_speed) && options.is_free(Free::axial_depth);
  if (file.has("decide.free") && !speed_and_depth) {
    throw file.reject("decide.free", "must be [\"spindle_speed\", \"axial_depth\"] in a job without a program", needed);
  }
  for (const char* key :
       {"speed_changes", "spindle_ramp_rpm_per_s", "max_force_n", "max_deflection_um", "avoid_reversals",
        "max_feed_mm_per_min", "chip_thickness_mm", "cutting_speed_m_per_min", "gamma_range_deg", "gamma_step_deg",
        "cone_deg", "cone_step_deg", "compensate", "max_offset_um", "controller_compensates"}) {
    const std::string path = std::string("decide.") + key;
    if (file.has(path)) throw file.reject(path, "has no effect in a job without a program", needed);
  }
}

}  // namespace

DecideOptions read_decide(io::TomlFile& file, bool along_program) {
  DecideOptions out;
  read_free(file, out);
  file.choice("decide.goal", goal_names, out.goal);
  if (!along_program) {
    check_without_program(file, out);
    return out;
  }
  out.speed_changes_given = file.has("decide.speed_changes");
  file.choice("decide.speed_changes", speed_change_names, out.speed_changes);
  file.number("decide.spindle_ramp_rpm_per_s", "spindle_ramp_rad_per_s2", units::rpm, out.spindle_ramp_rad_per_s2);
  file.number("decide.max_force_n", "max_force_n", 1.0, out.max_force_n);
  file.number("decide.max_deflection_um", "max_deflection_m", units::um, out.max_deflection_m);
  file.boolean("decide.avoid_reversals", out.avoid_reversals);
  file.number("decide.max_feed_mm_per_min", "max_feed_m_per_s", units::mm / units::minute, out.max_feed_m_per_s);
  read_range(file, "decide.chip_thickness_mm", "chip_thickness_m", units::mm, out.chip_thickness_m);
  read_range(file, "decide.cutting_speed_m_per_min", "cutting_speed_m_per_s", 1.0 / units::minute,
             out.cutting_speed_m_per_s);
  read_range(file, "decide.gamma_range_deg", "gamma_range_rad", units::deg, out.gamma_range_rad);
  file.number("decide.gamma_step_deg", "gamma_step_rad", units::deg, out.gamma_step_rad);
  file.number("decide.cone_deg", "cone_rad", units::deg, out.cone_rad);
  file.number("decide.cone_step_deg", "cone_step_rad", units::deg, out.cone_step_rad);
  file.boolean("decide.compensate", out.compensate);
  file.number("decide.max_offset_um", "max_offset_m", units::um, out.offsets.max_offset_m);
  file.boolean("decide.controller_compensates", out.offsets.controller_compensates);
  try {
    file.locate([&] { out.validate(); });
  } catch (const InvalidInput& error) {
    if (error.parts().field != "free") throw;
    throw file.reject("decide.free", error.parts().rule, error.parts().hint);
  }
  return out;
}

}  // namespace robomill::process
