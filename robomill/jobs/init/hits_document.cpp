#include "robomill/jobs/init/hits_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/jobs/init/template_lines.hpp"

namespace robomill::jobs {
namespace {

using modal::ColumnGuess;
using modal::FoundHit;
using modal::FoundHits;
using modal::MeasuredAxes;
using modal::ResponseKind;
using Role = ColumnGuess::Role;

constexpr double usual_rate_hz = 51'200.0;

/// A column as hits.toml names it: a number where it has no name.
std::string column_text(const std::string& name) {
  const bool number = std::ranges::all_of(name, [](unsigned char letter) { return std::isdigit(letter) != 0; });
  return number ? name : io::toml_quoted(name);
}

std::string guessed_from(std::string_view from) {
  return fmt::format("guessed from {}: check", from);
}

/// What sensitivities are per: the key's ending and its size in SI.
struct ResponseUnit {
  const char* key;
  double si;
};
ResponseUnit unit_of(ResponseKind kind) {
  if (kind == ResponseKind::velocity) return {.key = "response_mv_per_m_per_s", .si = 1.0};
  if (kind == ResponseKind::displacement) return {.key = "response_mv_per_m", .si = 1.0};
  return {.key = "response_mv_per_g", .si = units::standard_gravity};
}

/// Keys of [acquisition], of which all records have one.
class Acquisition {
 public:
  Acquisition(const FoundHit& hit, std::string document) : hit_(hit), text_(std::move(document)) {}

  std::string filled() {
    const ColumnGuess& force = *hit_.first(Role::force);
    const ColumnGuess& response = *hit_.first(Role::response);
    if (response.kind != ResponseKind::acceleration) {
      const char* const kind = response.kind == ResponseKind::velocity ? "\"velocity\"" : "\"displacement\"";
      set("response", kind, guessed_from(response.from));
    }
    const bool sound = hit_.format == io::Format::wav;
    if (sound) set("scale", "1", "V per full scale: the recorder's manual says it", to_give);
    const double volts = force.volts > 0.0 ? force.volts : response.volts;
    const double response_volts = response.volts > 0.0 ? response.volts : volts;
    if (volts > 0.0 || sound) {
      set("voltage_unit", voltage_text(volts), guessed_from(sound ? "a WAV" : "the unit of columns"));
    }
    if (response_volts != volts) {
      set("response_voltage_unit", voltage_text(response_volts), guessed_from("the unit of columns"));
    }
    sensitivity("force_mv_per_n", 1.0, force, record_mv(volts), sound, usual_force_mv_per_n);
    const ResponseUnit unit = unit_of(response.kind);
    sensitivity(unit.key, unit.si, response, record_mv(response_volts), sound, usual_response_mv_per_g);
    rate();
    return text_;
  }

 private:
  static double record_mv(double volts) { return volts == 1e-3 ? 1.0 : 1e3; }
  static const char* voltage_text(double volts) { return record_mv(volts) == 1.0 ? "\"mV\"" : "\"V\""; }
  static constexpr std::string_view to_give = "#!";
  void set(const std::string& key, const std::string& value, const std::string& remark, std::string_view mark = "#") {
    text_ = with_remark(text_, "acquisition." + key, value, remark, mark);
  }
  void sensitivity(const std::string& key, double unit, const ColumnGuess& column, double record_mv, bool sound,
                   std::string_view usual) {
    if (column.volts > 0.0 || sound) {
      set(key, std::string(usual), "of the sensor's calibration sheet", to_give);
    } else if (column.si_per_unit != 1.0 || io::setting_of(text_, "acquisition.voltage_unit")) {
      // What a 1 of the record is, as if it were a voltage; beside one in volts that of a column in SI counts too.
      set(key, fmt::format("{:.6g}", record_mv * unit / column.si_per_unit),
          fmt::format("guessed from the unit {}, no voltage: check", column.unit));
    }
  }
  void rate() {
    const ColumnGuess* const time = hit_.first(Role::time);
    if (time != nullptr && (time->si_per_unit != 1.0 || hit_.rounded_time)) {
      set("sample_rate_hz", fmt::format("{:.9g}", hit_.sample_rate_hz),
          fmt::format("guessed from the column {}, which is {}: check", time->name,
                      hit_.rounded_time ? "rounded" : "not in s"));
    } else if (time == nullptr && hit_.sample_rate_hz <= 0.0) {
      set("sample_rate_hz", fmt::format("{:.6g}", usual_rate_hz), "Hz: the records do not say it", to_give);
    }
  }

  const FoundHit& hit_;
  std::string text_;
};

std::string hit_table(const FoundHit& hit) {
  std::string text = "[[hits]]\n" + template_line("file", io::toml_quoted(hit.file), "");
  const ColumnGuess* const time = hit.first(Role::time);
  if (time != nullptr && time->si_per_unit == 1.0 && !hit.rounded_time) {
    text += template_line("time", column_text(time->name), guessed_from(time->from));
  }
  const ColumnGuess& force = *hit.first(Role::force);
  text += template_line("force", column_text(force.name), guessed_from(force.from));
  text += template_line(
      "force_direction", io::toml_quoted(hit.guess.force_direction),
      hit.guess.direction_from.empty() ? "taken as x, nothing says it: check" : guessed_from(hit.guess.direction_from));
  std::string responses;
  for (const std::size_t i : hit.guess.with(Role::response)) {
    const ColumnGuess& column = hit.guess.columns[i];
    responses += fmt::format("{}{} = {}", responses.empty() ? "" : ", ", column.axis, column_text(column.name));
  }
  return text +
         template_line("responses", fmt::format("{{ {} }}", responses), guessed_from(hit.first(Role::response)->from));
}

/// A list with one value a joint that the template shows behind a #.
struct ShownList {
  const char* key;
  double unit;  ///< in SI
  double robot::Joint::*value;
};
constexpr ShownList shown_lists[] = {
    {"robot.joint_max_velocity_deg_per_s", units::deg, &robot::Joint::max_velocity},
    {"robot.joint_max_acceleration_deg_per_s2", units::deg, &robot::Joint::max_acceleration},
    {"robot.joint_max_jerk_deg_per_s3", units::deg, &robot::Joint::max_jerk},
    {"robot.joint_stiffness_n_m_per_rad", 1.0, &robot::Joint::stiffness},
};

/// "[123, 115]": rounded down to hundredths, so that no limit grows.
std::string values_of(const robot::Arm& arm, const ShownList& list) {
  std::vector<std::string> values;
  for (const robot::Joint& joint : arm.joints) {
    constexpr double rounding = 1e-9;
    values.push_back(fmt::format("{}", std::floor((joint.*list.value) / list.unit * 100.0 * (1.0 + rounding)) / 100.0));
  }
  return fmt::format("[{}]", fmt::join(values, ", "));
}

}  // namespace

std::string hits_document(const FoundHits& found, bool example) {
  std::string text(raw_template(Template::hits));
  if (found.hits.empty()) return rendered(text, example);
  text.resize(text.find("\n[[hits]]\n") + 1);
  text = Acquisition(found.hits.front(), std::move(text)).filled();
  for (std::size_t i = 0; i < found.hits.size(); ++i) text += (i == 0 ? "" : "\n") + hit_table(found.hits[i]);
  return rendered(text, example);
}

namespace {

bool is_known(const MeasuredAxes& measured, char axis) {
  return measured.excitations.contains(axis) && measured.responses.contains(axis);
}

}  // namespace

char unmeasured_axis(const MeasuredAxes& measured) {
  if (is_known(measured, 'x') == is_known(measured, 'y')) return 0;
  return is_known(measured, 'x') ? 'y' : 'x';
}

std::string job_document(const MeasuredAxes& measured, bool cut_beside, bool example) {
  const std::string_view raw = raw_template(Template::job);
  const std::string text =
      cut_beside ? with_remark(without_tables(raw), "job.lobes", "\"lobes.toml\"", "the cut, which was there before")
                 : with_tables(raw, raw_template(Template::lobes));
  const char other = unmeasured_axis(measured);
  if (other == 0) return rendered(commented_out(text, "job.equal_directions"), example);
  const char axis = other == 'y' ? 'x' : 'y';
  if (measured.excitations == measured.responses && measured.excitations == std::set<char>{axis}) {
    return rendered(
        with_remark(text, "job.equal_directions", "true",
                    fmt::format("only {} was hit: is {} like it? Else take rigid_directions", axis, other), "#!"),
        example);
  }
  return rendered(with_remark(commented_out(text, "job.equal_directions"), "job.rigid_directions",
                              fmt::format("[\"{}\"]", other), fmt::format("{} was not hit: is it rigid?", other), "#!"),
                  example);
}

std::string cell_document(const std::string& robot, bool example) {
  std::string text(raw_template(Template::cell));
  if (robot.empty()) return rendered(text, example);
  const std::string_view cell = cell::known_arm_cell(robot);
  if (cell.empty()) {
    std::string names;
    for (const cell::KnownArm& arm : cell::known_arms()) names += (names.empty() ? "" : ", ") + arm.name;
    throw InvalidInput(fmt::format("\"{}\"", robot), "is no robot that is known here", "There are " + names);
  }
  text = with_remark(text, "robot.model", io::toml_quoted(robot),
                     "an arm of data/cells with its kinematics and limits; keys below stand before its own");
  const auto take = [&](const std::string& key) {
    const std::optional<std::string> value = io::setting_of(cell, key);
    if (value) text = io::with_setting(text, {.key = key, .value = *value});
  };
  for (const char* key : {"workpiece.origin_mm", "tool.length_mm"}) take(key);
  // What the arm has anyway stands there to be changed.
  const robot::Arm arm = cell::read_cell(io::TomlSource(robot + ".toml", std::string(cell))).robot.arm;
  for (const ShownList& list : shown_lists) {
    text = io::with_setting(text, {.key = list.key, .value = values_of(arm, list)});
    text = commented_out(std::move(text), list.key);
  }
  return rendered(text, example);
}

}  // namespace robomill::jobs
