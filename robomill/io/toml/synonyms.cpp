#include "robomill/io/toml/synonyms.hpp"

#include <fmt/format.h>

#include "robomill/io/key_unit.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

/// Names without their units.
struct Synonym {
  std::string_view written;
  std::string_view last;       ///< of the key that it means
  std::string_view more = {};  ///< how to say it with that key
};

constexpr std::string_view rpm_of_cutting_speed =
    " = 1000 vc / (pi diameter_mm), with the cutting speed vc in m/min and the diameter in mm";
constexpr std::string_view curve = " = [{ speed_rpm = …, torque_n_m = …, power_kw = … }, …], in order of speed";

/// Of several rows of one word the first counts whose key the file has.
constexpr Synonym synonyms[] = {
    {"flutes", "teeth"},
    {"number_of_flutes", "teeth"},
    {"number_of_teeth", "teeth"},
    {"z", "teeth"},
    {"ae", "radial_depth"},
    {"width_of_cut", "radial_depth"},
    {"radial_depth_of_cut", "radial_depth"},
    {"ap", "axial_depth"},
    {"depth_of_cut", "axial_depth"},
    {"axial_depth_of_cut", "axial_depth"},
    {"fz", "feed_per_tooth"},
    {"chip_load", "feed_per_tooth"},
    {"vc", "cutting_speed"},
    {"vc", "spindle_speed", rpm_of_cutting_speed},
    {"cutting_speed", "spindle_speed", rpm_of_cutting_speed},
    {"rpm", "spindle_speed"},
    {"max_power", "curve", curve},
    {"power", "curve", curve},
    {"max_torque", "curve", curve},
    {"torque", "curve", curve},
    {"climb", "direction", " = \"down\""},
    {"conventional", "direction", " = \"up\""},
};

std::string_view last_of(std::string_view key) {
  return key.substr(key.find_last_of('.') + 1);
}

/// Without regard to case, and to a unit at its end.
bool spells(std::string_view name, std::string_view written) {
  const std::string word = lowered(name);
  if (word == written) return true;
  return word.starts_with(fmt::format("{}_", written)) && !unit_of_key(word).empty();
}

}  // namespace

bool is_written_for(std::string_view name, std::string_view last) {
  for (const Synonym& synonym : synonyms) {
    if (synonym.last == key_unit(last).name && spells(name, synonym.written)) return true;
  }
  return false;
}

std::string synonym_hint(std::string_view key, const std::set<std::string, std::less<>>& known) {
  const std::string_view table = key.substr(0, key.size() - last_of(key).size());
  for (const Synonym& synonym : synonyms) {
    if (!spells(last_of(key), synonym.written)) continue;
    std::string found;
    for (const std::string& candidate : known) {
      const std::string_view last = last_of(candidate);
      if (key_unit(last).name != synonym.last) continue;
      if (candidate.substr(0, candidate.size() - last.size()) == table) {
        found = last;
        break;
      }
      if (found.empty() && candidate.find('[') == std::string::npos) found = candidate;
    }
    if (!found.empty()) return fmt::format("Here it is {}{}", found, synonym.more);
  }
  return {};
}

}  // namespace robomill::io
