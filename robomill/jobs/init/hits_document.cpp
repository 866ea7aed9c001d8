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

const ColumnGuess* first_of(const FoundHit& hit, Role role) {
  const std::vector<std::size_t> places = hit.guess.with(role);
  return places.empty() ? nullptr : &hit.guess.columns[places.front()];
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
    const ColumnGuess& force = *first_of(hit_, Role::force);
    const ColumnGuess& response = *first_of(hit_, Role::response);
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
    const ColumnGuess* const time = first_of(hit_, Role::time);
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
  const ColumnGuess* const time = first_of(hit, Role::time);
  if (time != nullptr && time->si_per_unit == 1.0 && !hit.rounded_time) {
    text += template_line("time", column_text(time->name), guessed_from(time->from));
  }
  const ColumnGuess& force = *first_of(hit, Role::force);
  text += template_line("force", column_text(force.name), guessed_from(force.from));
  text += template_line(
      "force_direction", io::toml_quoted(hit.guess.force_direction),
      hit.guess.direction_from.empty() ? "taken as x, nothing says it: check" : guessed_from(hit.guess.direction_from));
  std::string responses;
  for (const std::size_t i : hit.guess.with(Role::response)) {
    const ColumnGuess& column = hit.guess.columns[i];
    responses += fmt::format("{}{} = {}", responses.empty() ? "" : ", ", column.axis, column_text(column.name));
  }
  return text + template_line("responses", fmt::format("{{ {} }}", responses),
                              guessed_from(first_of(hit, Role::response)->from));
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

bool same_unit(const FoundHit& a, const FoundHit& b, Role role) {
  const ColumnGuess &left = *first_of(a, role), &right = *first_of(b, role);
  return (a.format == io::Format::wav) == (b.format == io::Format::wav) && left.volts == right.volts &&
         left.si_per_unit == right.si_per_unit && left.kind == right.kind;
}

/// What a column seems to be in, in words.
std::string unit_text(const FoundHit& hit, Role role) {
  const ColumnGuess& column = *first_of(hit, role);
  if (hit.format == io::Format::wav) return "the scale of a WAV";
  if (!column.unit.empty()) return column.unit;
  if (role == Role::force) return "N";
  return column.kind == ResponseKind::acceleration ? "m/s^2" : column.kind == ResponseKind::velocity ? "m/s" : "m";
}

/// Why two records cannot stand in one hits.toml; empty: they can.
std::string difference(const FoundHit& hit, const FoundHit& other) {
  constexpr double same_rate = 1e-3;
  const double rate_hz = hit.sample_rate_hz, other_hz = other.sample_rate_hz;
  if (rate_hz > 0.0 && other_hz > 0.0 && std::abs(rate_hz - other_hz) > same_rate * other_hz) {
    return fmt::format("its sample rate is {:.6g} Hz, that of {} {:.6g} Hz, and all hits must have one", rate_hz,
                       other.file, other_hz);
  }
  for (const auto& [role, what] : {std::pair{Role::force, "force"}, {Role::response, "response"}}) {
    if (same_unit(hit, other, role)) continue;
    return fmt::format("its {} is in {}, that of {} in {}, and hits.toml has one unit for all", what,
                       unit_text(hit, role), other.file, unit_text(other, role));
  }
  return {};
}

}  // namespace

void keep_what_goes_together(FoundHits& found) {
  const std::vector<FoundHit> hits = std::move(found.hits);
  found.hits.clear();
  std::ptrdiff_t most = 0;
  const FoundHit* common = nullptr;
  for (const FoundHit& hit : hits) {
    const auto like =
        std::ranges::count_if(hits, [&](const FoundHit& other) { return difference(other, hit).empty(); });
    if (like > most) {
      most = like;
      common = &hit;
    }
  }
  for (const FoundHit& hit : hits) {
    const std::string reason = difference(hit, *common);
    if (reason.empty()) {
      found.hits.push_back(hit);
    } else {
      found.left_out.push_back(fmt::format("{}: {}", hit.file, reason));
    }
  }
}

std::string hits_document(const FoundHits& found, bool example) {
  std::string text(raw_template(Template::hits));
  if (found.hits.empty()) return rendered(text, example);
  text.resize(text.find("\n[[hits]]\n") + 1);
  text = Acquisition(found.hits.front(), std::move(text)).filled();
  for (std::size_t i = 0; i < found.hits.size(); ++i) text += (i == 0 ? "" : "\n") + hit_table(found.hits[i]);
  return rendered(text, example);
}

MeasuredAxes measured_axes(const FoundHits& found) {
  MeasuredAxes axes;
  for (const FoundHit& hit : found.hits) {
    axes.excitations.insert(hit.guess.force_direction.back());
    for (const std::size_t i : hit.guess.with(Role::response)) axes.responses.insert(hit.guess.columns[i].axis);
  }
  return axes;
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
