#include "robomill/serve/files/lobes_fields.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::serve {
namespace {

using stability::SweptParameter;

struct Slider {
  const char* key;
  double min, max, step;
  bool widens = true;          ///< to hold the file's own value
  double default_value = 0.0;  ///< what readers take where the file does not say
};

/// Where it stands.
double value_of(io::TomlFile& file, const Slider& slider) {
  double value = slider.default_value;
  file.number(slider.key, "", 1.0, value);
  return value;
}

/// Those that have a part in the cut.
std::vector<Slider> sliders_of(const io::TomlFile& document, const jobs::LobesFile& file) {
  std::vector<Slider> out;
  const auto add = [&](const char* key, double min, double max, double step, bool applies) {
    if (applies && (document.is_number(key) || !document.has(key))) out.push_back({key, min, max, step});
  };
  const bool spatial = file.problem.spatial.has_value();
  const bool milling = !file.drilling;
  const SweptParameter sweep = file.sweep;
  const char* const radial = document.has("cut.stepover_mm") ? "cut.stepover_mm" : "cut.radial_depth_mm";
  const double diameter_mm = file.problem.milling.tool.diameter_m / units::mm;
  add("tool.teeth", 1, 20, 1, !document.has("tool.pitch_deg") && file.problem.milling.tool.has_equal_helix());
  add("tool.diameter_mm", 1, 50, 0.1, true);
  add("tool.helix_deg", 0, 60, 1, milling);
  if (document.is_number(radial) && sweep != SweptParameter::radial_depth) {
    out.push_back({radial, 0.01, diameter_mm, 0.01, false});
  }
  add("cut.axial_depth_mm", 0.01, 10, 0.01, spatial && sweep != SweptParameter::axial_depth);
  add("cut.feed_direction_deg", -180, 180, 1, true);
  add("cut.lead_deg", -45, 45, 1, spatial && sweep != SweptParameter::lead);
  add("cut.tilt_deg", -45, 45, 1, spatial && sweep != SweptParameter::tilt);
  for (const char* key : {"coefficients.tangential_n_per_mm2", "coefficients.radial_n_per_mm2"}) {
    add(key, 10, 5000, 10, document.has(key));
  }
  if (document.has("coefficients.material") || document.has("coefficients.file")) {
    out.push_back({"coefficients.scale", 0.1, 3, 0.01, true, 1.0});
  }
  return out;
}

}  // namespace

io::Json lobes_fields(const io::TomlSource& source, const jobs::LobesFile& file) {
  io::TomlFile document(source);
  io::TomlFile own({source.path, source.text});
  io::Json fields = io::Json::object();
  for (const Slider& slider : sliders_of(document, file)) {
    const bool widens = slider.widens && own.is_number(slider.key);
    const double written = widens ? value_of(own, slider) : slider.min;
    fields[slider.key] = {{"value", io::number(value_of(document, slider))},
                          {"min", io::number(std::min(slider.min, written))},
                          {"max", io::number(written > slider.max ? 2.0 * written : slider.max)},
                          {"step", slider.step}};
  }
  return fields;
}

}  // namespace robomill::serve
