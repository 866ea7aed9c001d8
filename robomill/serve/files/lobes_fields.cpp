#include "robomill/serve/files/lobes_fields.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/cutting/files/coefficients_schema.hpp"
#include "robomill/cutting/files/cut_schema.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::serve {
namespace {

using stability::SweptParameter;

/// The sliders of a file's tables.
class Fields {
 public:
  Fields(const io::TomlSource& source, const jobs::LobesFile& file)
      : document_(source), own_({source.path, source.text}), file_(file) {}

  template <class T>
  void add(const std::string& table, const io::Schema<T>& schema) {
    for (const io::Row<T>& row : schema.rows()) {
      const std::string path = table + "." + row.key.name;
      const bool known = document_.is_number(path) || (!document_.has(path) && row.key.default_value.is_number());
      if (row.key.slider && known && takes_part(row.member)) add(path, row.key, row.member == "radial_depth_m");
    }
  }
  io::Json take() { return std::move(fields_); }

 private:
  /// Whether the cut depends on a member, and the chart varies another one.
  [[nodiscard]] bool takes_part(const std::string& member) const {
    const bool spatial = file_.problem.spatial.has_value();
    const auto given = [&](SweptParameter parameter) { return file_.sweep != parameter; };
    if (member == "teeth") return !document_.has("tool.pitch_deg") && file_.problem.milling.tool.has_equal_helix();
    if (member == "tooth_helix_rad") return !file_.drilling;
    if (member == "radial_depth_m") return given(SweptParameter::radial_depth);
    if (member == "axial_depth_m") return spatial && given(SweptParameter::axial_depth);
    if (member == "lead_rad") return spatial && given(SweptParameter::lead);
    if (member == "tilt_rad") return spatial && given(SweptParameter::tilt);
    if (member == "scale") return document_.has("coefficients.material") || document_.has("coefficients.file");
    return true;
  }
  static double value_of(io::TomlFile& file, const std::string& path, const io::Key& key) {
    double value = key.default_value.is_number() ? key.default_value.get<double>() : 0.0;
    file.number(path, "", 1.0, value);
    return value;
  }
  /// @param to_diameter  its range ends at the diameter; another is wider where the file's own value is outside
  void add(const std::string& path, const io::Key& key, bool to_diameter) {
    const io::Slider& slider = *key.slider;
    const double highest = to_diameter ? file_.problem.milling.tool.diameter_m / units::mm : slider.highest;
    const bool widens = !to_diameter && own_.is_number(path);
    const double written = widens ? value_of(own_, path, key) : slider.lowest;
    fields_[path] = {{"value", io::number(value_of(document_, path, key))},
                     {"min", io::number(std::min(slider.lowest, written))},
                     {"max", io::number(written > highest ? 2.0 * written : highest)},
                     {"step", slider.step}};
  }

  io::TomlFile document_, own_;
  const jobs::LobesFile& file_;
  io::Json fields_ = io::Json::object();
};

}  // namespace

io::Json lobes_fields(const io::TomlSource& source, const jobs::LobesFile& file) {
  Fields fields(source, file);
  fields.add("tool", cutting::cutter_table());
  fields.add("cut", cutting::cut_table());
  fields.add("coefficients", cutting::coefficients_table());
  return fields.take();
}

}  // namespace robomill::serve
