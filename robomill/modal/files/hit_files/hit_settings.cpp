#include "robomill/modal/files/hit_files/hit_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/modal/files/hits_toml.hpp"

namespace robomill::modal {
namespace {

using Role = ColumnGuess::Role;

/// Of a hammer [mV/N] and an accelerometer [mV/g] of which nothing is known, and a rate: to show, not to compute with.
constexpr std::string_view usual_force_mv_per_n = "2.25", usual_response_mv_per_g = "100", usual_rate_hz = "51200";

/// A column as hits.toml names it: a number where it has no name.
std::string column_text(const std::string& name) {
  const bool number = std::ranges::all_of(name, [](unsigned char letter) { return std::isdigit(letter) != 0; });
  return number ? name : io::toml_quoted(name);
}

std::string guessed_from(std::string_view from) {
  return fmt::format("guessed from {}: check", from);
}

/// What sensitivities are per: the key's ending and its size in SI.
struct PerUnit {
  const char* key;
  double si;
};
PerUnit per_unit_of(ResponseKind kind) {
  if (kind == ResponseKind::velocity) return {.key = "response_mv_per_m_per_s", .si = 1.0};
  if (kind == ResponseKind::displacement) return {.key = "response_mv_per_m", .si = 1.0};
  return {.key = "response_mv_per_g", .si = units::standard_gravity};
}

class AcquisitionSettings {
 public:
  explicit AcquisitionSettings(const FoundHit& hit) : hit_(hit) {}

  std::vector<HitSetting> all() {
    const ColumnGuess& force = *hit_.first(Role::force);
    const ColumnGuess& response = *hit_.first(Role::response);
    if (response.kind != ResponseKind::acceleration) {
      const char* const kind = response.kind == ResponseKind::velocity ? "\"velocity\"" : "\"displacement\"";
      set("response", kind, guessed_from(response.from));
    }
    sound_ = hit_.format == io::Format::wav;
    if (sound_) {
      set("scale", "1", "V per full scale: the recorder's manual says it", "what full scale of the WAV means");
    }
    const double volts = force.volts > 0.0 ? force.volts : response.volts;
    const double response_volts = response.volts > 0.0 ? response.volts : volts;
    voltage_ = volts > 0.0 || sound_;
    if (voltage_) {
      set("voltage_unit", voltage_text(volts), guessed_from(sound_ ? "a WAV" : "the unit of columns"));
    }
    if (response_volts != volts) {
      set("response_voltage_unit", voltage_text(response_volts), guessed_from("the unit of columns"));
    }
    sensitivity({.key = "force_mv_per_n", .si = 1.0}, force, record_mv(volts), usual_force_mv_per_n, "the hammer's");
    sensitivity(per_unit_of(response.kind), response, record_mv(response_volts), usual_response_mv_per_g,
                "the sensor's");
    rate();
    return std::move(settings_);
  }

 private:
  static double record_mv(double volts) { return volts == 1e-3 ? 1.0 : 1e3; }
  static const char* voltage_text(double volts) { return record_mv(volts) == 1.0 ? "\"mV\"" : "\"V\""; }
  void set(const std::string& key, const std::string& value, const std::string& remark,
           const std::string& missing = {}) {
    settings_.push_back({.key = key, .value = value, .remark = remark, .missing = missing});
  }
  void sensitivity(const PerUnit& per, const ColumnGuess& column, double record_mv, std::string_view usual,
                   std::string_view whose) {
    if (column.volts > 0.0 || sound_) {
      set(per.key, std::string(usual), "of the sensor's calibration sheet", fmt::format("{} sensitivity", whose));
    } else if (column.si_per_unit != 1.0 || voltage_) {
      // What a 1 of the record is, as if it were a voltage; beside one in volts that of a column in SI counts too.
      set(per.key, fmt::format("{:.6g}", record_mv * per.si / column.si_per_unit),
          fmt::format("guessed from the unit {}, no voltage: check", column.unit));
    }
  }
  void rate() {
    const ColumnGuess* const time = hit_.first(Role::time);
    if (hit_.sample_rate_hz > 0.0 && time != nullptr && hit_.time.empty() &&
        (time->si_per_unit != 1.0 || hit_.guess.rounded_time)) {
      set("sample_rate_hz", fmt::format("{:.9g}", hit_.sample_rate_hz),
          fmt::format("guessed from the column {}, which is {}: check", time->name,
                      hit_.guess.rounded_time ? "rounded" : "not in s"));
    } else if (hit_.sample_rate_hz <= 0.0) {
      set("sample_rate_hz", std::string(usual_rate_hz), "Hz: the records do not say it", "the sample rate");
    }
  }

  const FoundHit& hit_;
  bool sound_ = false, voltage_ = false;
  std::vector<HitSetting> settings_;
};

}  // namespace

std::vector<HitSetting> acquisition_settings(const FoundHit& hit) {
  return AcquisitionSettings(hit).all();
}

std::vector<Assumption> assumed_units(const UnstatedUnits& unstated, ResponseKind kind, const std::string& file) {
  std::vector<Assumption> out;
  if (unstated.force) {
    out.push_back(
        {.what = "Forces in records without a unit", .taken = "N", .key = "acquisition.force_mv_per_n", .file = file});
  }
  if (unstated.response) {
    out.push_back({.what = "Responses in records without a unit",
                   .taken = kind == ResponseKind::acceleration ? "m/s²"
                            : kind == ResponseKind::velocity   ? "m/s"
                                                               : "m",
                   .key = fmt::format("acquisition.response_mv_per_{}", response_unit(kind)),
                   .file = file});
  }
  return out;
}

std::vector<Assumption> assumed_units(const FoundHits& found, const std::string& file) {
  if (found.hits.empty()) return {};
  const std::vector<HitSetting> settings = acquisition_settings(found.hits.front());
  const auto gives = [&](std::string_view key) {
    return std::ranges::any_of(settings, [&](const HitSetting& one) { return one.key.starts_with(key); });
  };
  const auto is_unstated = [&](Role role) {
    return std::ranges::any_of(found.hits,
                               [&](const FoundHit& hit) { return hit.si_assumed || !states_unit(*hit.first(role)); });
  };
  return assumed_units({.force = !gives("force_mv_per_") && is_unstated(Role::force),
                        .response = !gives("response_mv_per_") && is_unstated(Role::response)},
                       found.hits.front().first(Role::response)->kind, file);
}

std::vector<HitSetting> row_settings(const FoundHit& hit) {
  std::vector<HitSetting> out;
  std::string files;
  for (const std::string& file : hit.files) files += (files.empty() ? "" : ", ") + io::toml_quoted(file);
  if (hit.files.size() > 1) files = fmt::format("[{}]", files);
  out.push_back({.key = "file",
                 .value = files,
                 .remark = hit.guess.hits > 1 ? fmt::format("{} hits, which are cut apart", hit.guess.hits) : ""});
  if (!hit.time.empty()) {
    out.push_back({.key = "time", .value = column_text(hit.time), .remark = guessed_from(hit.first(Role::time)->from)});
  }
  const ColumnGuess& force = *hit.first(Role::force);
  out.push_back({.key = "force", .value = column_text(force.name), .remark = guessed_from(force.from)});
  const bool said = !hit.guess.direction_from.empty();
  out.push_back({.key = "force_direction",
                 .value = io::toml_quoted(hit.guess.force_direction),
                 .remark = said ? guessed_from(hit.guess.direction_from) : "taken as x, nothing says it: check"});
  std::string responses;
  for (const std::size_t i : hit.guess.with(Role::response)) {
    const ColumnGuess& column = hit.guess.columns[i];
    responses += fmt::format("{}{} = {}", responses.empty() ? "" : ", ", column.axis, column_text(column.name));
  }
  out.push_back({.key = "responses",
                 .value = fmt::format("{{ {} }}", responses),
                 .remark = guessed_from(hit.first(Role::response)->from)});
  return out;
}

}  // namespace robomill::modal
