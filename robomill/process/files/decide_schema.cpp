#include "robomill/process/files/decide_schema.hpp"

#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill::process {
namespace {

using io::key;
using io::Row;
using Options = DecideOptions;

void read_free(io::TomlFile& file, const std::string& path, Options& out) {
  std::vector<std::string> free;
  if (!file.texts(path, free)) return;
  out.free.clear();
  for (const std::string& word : free) {
    const std::optional<Free> what = value_in(free_names, word);
    if (!what) throw file.reject(path, "of \"" + word + "\": each " + one_of(free_names));
    if (!out.is_free(*what)) out.free.push_back(*what);
  }
}

Row<Options> free_key() {
  Row<Options> row = io::declared<Options>(
      "free", io::Holds::word,
      "what may differ from the program; []: it is evaluated as it is. axial_depth: only of a job without a program",
      1);
  for (const auto& [word, what] : free_names) row.key.words.emplace_back(word);
  row.write = [](const Options& options, const Row<Options>&) {
    io::Json words = io::Json::array();
    for (const Free what : options.free) words.push_back(name_in(free_names, what));
    return words;
  };
  return row.or_one().read_by(read_free);
}

}  // namespace

const io::Schema<DecideOptions>& decide_table() {
  static const io::Schema<DecideOptions> table(
      "decide", "what a decision may change, and what it must keep",
      {free_key(),
       key("goal", &Options::goal, goal_names, "what is least; removal_rate: changes of speed take no time"),
       key("speed_changes", &Options::speed_changes, speed_change_names,
           "air: in rapid moves; none: one speed, the default where the cell gives spindle.output, which only switches "
           "it "
           "on"),
       key("spindle_ramp_rpm_per_s", &Options::spindle_ramp_rad_per_s2, "of the spindle").above(0.0),
       key("chip_thickness_mm", &Options::chip_thickness_m,
           "greatest in the cut, least and most; without it as the program has it")
           .entries(2, "[least, most]")
           .at_least(0.0),
       key("cutting_speed_m_per_min", &Options::cutting_speed_m_per_s,
           "of the outermost point that cuts, least and most")
           .entries(2, "[least, most]")
           .at_least(0.0),
       key("max_force_n", &Options::max_force_n, "peak on the tool; 0: no limit").at_least(0.0),
       key("max_deflection_um", &Options::max_deflection_m,
           "of the tip, under the mean force of a revolution; 0: no limit")
           .at_least(0.0),
       key("max_feed_mm_per_min", &Options::max_feed_m_per_s, "of the tip; 0: no limit").at_least(0.0),
       key("gamma_range_deg", &Options::gamma_range_rad,
           "of the flange about the tool, from where the program has it; it holds 0")
           .entries(2, "[least, most]")
           .at_least(-360.0)
           .at_most(360.0),
       key("gamma_step_deg", &Options::gamma_step_rad, "steps of it").at_least(1.0),
       key("cone_deg", &Options::cone_rad, "lead and tilt: so far from where the program has the axis")
           .above(0.0)
           .at_most(45.0),
       key("cone_step_deg", &Options::cone_step_rad, "steps of it").at_least(1.0),
       key("avoid_reversals", &Options::avoid_reversals, "no joint's load may reverse while it cuts"),
       key("compensate", &Options::compensate, "finishing passes are moved by the predicted deflection"),
       io::of(&Options::offsets, key("max_offset_um", &PathOffsets::max_offset_m, "by this at most").above(0.0)),
       io::of(&Options::offsets, key("controller_compensates", &PathOffsets::controller_compensates,
                                     "the robot's controller does so already: the path stays"))});
  return table;
}

}  // namespace robomill::process
