#include "robomill/modal/files/hits_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/modal/files/hit_files/hit_record.hpp"
#include "robomill/modal/files/hit_guess.hpp"
#include "robomill/modal/files/hits_schema.hpp"
#include "robomill/modal/impact/hit_split.hpp"

namespace robomill::modal {
namespace {

/// How a record's numbers become N and the SI unit of the response.
struct Sensors {
  double force_factor = 1.0;
  double response_factor = 1.0;
  double scale = 1.0;  ///< full scale of a WAV
  bool has_scale = false;
  double sample_rate_hz = 0.0;
  double hit_spacing_s = 0.0;
  bool force_in_volts = false, response_in_volts = false;  ///< the sensitivities are given
};

constexpr const char* force_key = "acquisition.force_mv_per_n";
constexpr const char* response_in_g_key = "acquisition.response_mv_per_g";

std::string response_key(ResponseKind kind) {
  return fmt::format("acquisition.response_mv_per_{}", response_unit(kind));
}

/// Keys of sensors of other kinds.
void reject_other_kinds(const io::TomlFile& file, ResponseKind kind) {
  constexpr Name<ResponseKind> units_of[] = {{"m_per_s2", ResponseKind::acceleration},
                                             {"g", ResponseKind::acceleration},
                                             {"m_per_s", ResponseKind::velocity},
                                             {"m", ResponseKind::displacement}};
  for (const auto& [unit, of] : units_of) {
    for (const char* name : {"response_mv_per_", "response_overload_"}) {
      const std::string key = fmt::format("acquisition.{}{}", name, unit);
      if (of == kind || !file.has(key)) continue;
      throw file.reject(key, fmt::format("is of another sensor than {}", response_key(kind)),
                        "acquisition.response says what the sensor measures: acceleration, velocity or displacement");
    }
  }
}

/// Of a sensor in mV per unit; one that is mounted the other way round may be negative.
/// @param record_mv  what a 1 of the record is
bool take_sensitivity(const io::TomlFile& file, const std::string& key, std::optional<double> mv_per_unit,
                      double record_mv, double unit, double& factor) {
  if (!mv_per_unit) return false;
  if (*mv_per_unit == 0.0) throw file.reject(key, "must not be 0", "It stands on the sensor's calibration sheet");
  factor = record_mv / *mv_per_unit * unit;
  return true;
}

/// Without sensitivities the records are in N and the SI unit of the response.
void take_sensitivities(const io::TomlFile& file, const Acquisition& given, Sensors& sensors) {
  const char* const voltage = "acquisition.voltage_unit";
  const char* const response_voltage = "acquisition.response_voltage_unit";
  const ResponseKind kind = given.options.response;
  const double response_mv = given.response_record_mv > 0.0 ? given.response_record_mv : given.record_mv;
  const std::string in_si = response_key(kind);
  const std::optional<double> mv_per_si = kind == ResponseKind::acceleration ? given.response_mv_per_m_per_s2
                                          : kind == ResponseKind::velocity   ? given.response_mv_per_m_per_s
                                                                             : given.response_mv_per_m;
  if (given.response_mv_per_g && mv_per_si) {
    throw file.reject(response_in_g_key, fmt::format("must not stand beside {}", in_si),
                      "They say the same in two units");
  }
  const bool force =
      take_sensitivity(file, force_key, given.force_mv_per_n, given.record_mv, 1.0, sensors.force_factor);
  const bool response = take_sensitivity(file, in_si, mv_per_si, response_mv, 1.0, sensors.response_factor) ||
                        take_sensitivity(file, response_in_g_key, given.response_mv_per_g, response_mv,
                                         units::standard_gravity, sensors.response_factor);
  sensors.force_in_volts = force;
  sensors.response_in_volts = response;
  // Records in volts are neither N nor m/s^2.
  if (file.has(voltage)) {
    if (!force) file.require(force_key, "voltage_unit says that the records are in volts: it is on the hammer's sheet");
    if (!response) {
      file.require(kind == ResponseKind::acceleration ? std::string(response_in_g_key) : in_si,
                   "voltage_unit says that the records are in volts: it is on the sensor's calibration sheet");
    }
  }
  if (file.has(response_voltage) && !response) {
    throw file.reject(response_voltage, "goes with the response's sensitivity: response_mv_per_g");
  }
}

HitOptions read_acquisition(io::TomlFile& file, Sensors& sensors) {
  Acquisition given;
  acquisition_table().read(file, "acquisition", given);
  reject_other_kinds(file, given.options.response);
  take_sensitivities(file, given, sensors);
  sensors.has_scale = given.scale.has_value();
  sensors.scale = given.scale.value_or(sensors.scale);
  sensors.sample_rate_hz = given.sample_rate_hz;
  sensors.hit_spacing_s = given.hit_spacing_s;
  file.locate([&] { given.options.validate(); });
  return given.options;
}

/// What hits.toml takes a column for.
struct ReadAs {
  io::Quantity quantity = io::Quantity::force;
  std::string unit = "N";
  bool in_volts = false;      ///< a sensitivity is given …
  double given_factor = 1.0;  ///< … and makes so much of a 1
  std::string sensitivity = force_key;
};

ReadAs response_read_as(ResponseKind kind, const Sensors& sensors) {
  const bool in_volts = sensors.response_in_volts;
  const double given = sensors.response_factor;
  switch (kind) {
    case ResponseKind::acceleration:
      return {io::Quantity::acceleration, "m/s²", in_volts, given, response_in_g_key};
    case ResponseKind::velocity:
      return {io::Quantity::velocity, "m/s", in_volts, given, response_key(kind)};
    case ResponseKind::displacement:
      break;
  }
  return {io::Quantity::displacement, "m", in_volts, given, response_key(kind)};
}

/// SI per number of a column whose name, or row of units, states its unit: ax_g, Force [kN]. 1 where none is stated.
/// @throws InvalidInput with the key, if it is of another quantity than the file takes the column for
double factor_of_unit(const io::TomlFile& file, const std::string& key, const io::Record& record, std::size_t place,
                      const ReadAs& as, std::vector<std::string>& notes) {
  const ColumnGuess said = guess_by_name(record, place);
  const bool by_row = place < record.units.size() && !record.units[place].empty();
  const std::string by = by_row ? "by " + record.units_by : "by its name";
  if (said.volts > 0.0) {
    if (as.in_volts) return 1.0;
    throw file.reject(key, fmt::format("is a voltage {}, and {} is missing", by, as.sensitivity),
                      "It stands on the sensor's calibration sheet; rename the column if it holds " + as.unit);
  }
  const io::SiFactor si = io::parse_unit(said.unit);
  if (said.unit.empty() || said.unit == "-") return 1.0;
  // Of a name it may be a remark: "acc (front)".
  if (!by_row && (si.is_ratio || si.quantity == io::Quantity::unknown)) {
    if (!as.in_volts)
      notes.push_back(fmt::format("Columns {}: \"{}\" is no unit known here, and they are read in {}.", said.name,
                                  said.unit, as.unit));
    return 1.0;
  }
  if (si.is_ratio || si.quantity != as.quantity) {
    throw file.reject(
        key, fmt::format("is in {} {}, and is read in {}", said.unit, by, as.unit),
        as.quantity == io::Quantity::force || si.quantity == io::Quantity::force
            ? "Are the columns of force and response exchanged?"
            : "acquisition.response says what the sensor measures: acceleration, velocity or displacement");
  }
  if (as.in_volts) {
    if (std::abs(as.given_factor / si.factor - 1.0) < 1e-3) return 1.0;
    throw file.reject(key,
                      fmt::format("is in {} {}, where {} makes {:.4g} {} of a 1", said.unit, by, as.sensitivity,
                                  as.given_factor, as.unit),
                      "Leave the sensitivity out if the recorder used it already, or rename the column");
  }
  if (si.factor != 1.0) {
    notes.push_back(fmt::format("Columns {} are in {} {}: converted with {:.6g} to {}.", said.name, said.unit,
                                by_row ? by : "by their name", si.factor, as.unit));
  }
  return si.factor;
}

HitRecord open_record(const io::TomlFile& file, const std::string& key, const HitTable& given, const Sensors& sensors) {
  for (const std::filesystem::path& path : given.files) {
    if (io::format_of(path) == io::Format::wav && !sensors.has_scale) {
      throw file.reject(key, "is a WAV, and acquisition.scale is missing",
                        "scale says what full scale means: volts where the sensors' mV per unit are given");
    }
  }
  return file.locate([&] {
    return read_hit_record(given.files, {.time = given.time,
                                         .scale = sensors.scale,
                                         .given_rate_hz = sensors.sample_rate_hz,
                                         .rate_key = "acquisition.sample_rate_hz"});
  });
}

/// The columns that a row names, in SI.
Hit hit_of(const io::TomlFile& file, const std::string& row, const HitRow& columns, const HitRecord& record,
           ResponseKind kind, const Sensors& sensors, std::vector<std::string>& notes) {
  Hit hit;
  for (const io::Record& part : record.parts) hit.file += (hit.file.empty() ? "" : " + ") + part.file.string();
  hit.excitation = columns.excitation;
  hit.against_axis = columns.against_axis;
  hit.sample_rate_hz = record.sample_rate_hz;
  std::vector<std::string> converted;
  const auto factor = [&](const std::string& key, const HitRecord::Column& column, const ReadAs& as) {
    return has_own_units(*column.part) ? factor_of_unit(file, row + key, *column.part, column.place, as, converted)
                                       : 1.0;
  };
  const HitRecord::Column force = file.locate([&] { return record.column(columns.force, true); });
  const double force_unit =
      factor("force", force, {.in_volts = sensors.force_in_volts, .given_factor = sensors.force_factor});
  hit.force_n = force.samples() * sensors.force_factor * force_unit;
  for (const HitRow::Response& response : columns.responses) {
    const HitRecord::Column column = file.locate([&] { return record.column(response.column, false); });
    const double unit = factor("responses", column, response_read_as(kind, sensors));
    hit.responses.push_back({.dof = response.dof,
                             .samples = column.samples() * sensors.response_factor * unit,
                             .against_axis = response.against_axis});
  }
  for (const std::string& note : converted) {
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
  }
  return hit;
}

/// Without those that the row names. @throws InvalidInput where there is no such hit
void leave_out(const io::TomlFile& file, const std::string& key, const std::vector<int>& numbers,
               std::vector<Hit>& hits) {
  if (numbers.empty()) return;
  const auto count = static_cast<int>(hits.size());
  std::vector<Hit> kept;
  for (const int number : numbers) {
    if (number < 1 || number > count) {
      throw file.reject(key, fmt::format("names hit {}, and the record has {}", number, count),
                        "Hits of a record count from 1");
    }
  }
  for (int i = 0; i < count; ++i) {
    if (std::ranges::find(numbers, i + 1) == numbers.end())
      kept.push_back(std::move(hits[static_cast<std::size_t>(i)]));
  }
  if (kept.empty()) throw file.reject(key, "leaves no hit of the record", "Leave the whole [[hits]] out");
  hits = std::move(kept);
}

/// The hits of one row: one, or those that its record holds.
std::vector<Hit> read_row(io::TomlFile& file, std::size_t index, ResponseKind kind, const Sensors& sensors,
                          std::vector<std::string>& notes) {
  const std::string row = fmt::format("hits[{}].", index);
  file.require(row + "file");
  HitTable given;
  hit_table().read(file, fmt::format("hits[{}]", index), given);
  const HitRecord record = open_record(file, row + "file", given, sensors);
  std::ranges::copy(record.notes, std::back_inserter(notes));
  if (!(record.sample_rate_hz > 0.0)) {
    throw file.reject(row + "file", "has no time column, and acquisition.sample_rate_hz is missing");
  }
  Hit whole = hit_of(file, row, given.row, record, kind, sensors, notes);
  const std::string name = whole.file;
  std::vector<Hit> hits;
  if (given.split) {
    hits = split_hits(std::move(whole), sensors.hit_spacing_s, record.begin_s);
  } else {
    hits.push_back(std::move(whole));
  }
  if (hits.size() > 1)
    notes.push_back(fmt::format("{}: {} hits, cut apart by the pulses of the force", name, hits.size()));
  leave_out(file, row + "leave_out", given.leave_out, hits);
  return hits;
}

/// What is taken where the file does not say it.
std::vector<Assumption> assumed_of(const io::TomlFile& file, ResponseKind kind, const std::filesystem::path& path) {
  const std::string response = response_key(kind), name = path.filename().string();
  std::vector<Assumption> out;
  if (!file.has("acquisition.response")) {
    out.push_back({.what = "Responses", .taken = "accelerations", .key = "acquisition.response", .file = name});
  }
  if (!file.has(force_key)) {
    out.push_back({.what = "Forces in records without a unit", .taken = "N", .key = force_key, .file = name});
  }
  if (!file.has(response) && !file.has(response_in_g_key)) {
    out.push_back({.what = "Responses in records without a unit",
                   .taken = kind == ResponseKind::acceleration ? "m/s²"
                            : kind == ResponseKind::velocity   ? "m/s"
                                                               : "m",
                   .key = response,
                   .file = name});
  }
  if (kind == ResponseKind::acceleration && !file.has("acquisition.accelerometer_mass_kg")) {
    out.push_back({.what = "Accelerometer's mass",
                   .taken = "0 kg, nothing is taken out of the FRFs",
                   .key = "acquisition.accelerometer_mass_kg",
                   .file = name});
  }
  return out;
}

}  // namespace

const char* response_unit(ResponseKind kind) {
  switch (kind) {
    case ResponseKind::acceleration:
      return "m_per_s2";
    case ResponseKind::velocity:
      return "m_per_s";
    case ResponseKind::displacement:
      break;
  }
  return "m";
}

HitsFile read_hits(const io::TomlSource& source) {
  io::TomlFile file(source);
  HitsFile out;
  Sensors sensors;
  out.options = read_acquisition(file, sensors);
  if (file.tables("hits") == 0) file.require("hits", "Write [[hits]] above each record");
  for (std::size_t i = 0; i < file.tables("hits"); ++i)
    std::ranges::move(read_row(file, i, out.options.response, sensors, out.notes), std::back_inserter(out.hits));
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  out.assumed = assumed_of(file, out.options.response, source.path);
  add_assumed(out.assumed, io::sample_values(file));
  return out;
}

HitRows read_hit_rows(const io::TomlSource& source) {
  io::TomlFile file(source);
  HitRows out;
  Sensors sensors;
  out.options = read_acquisition(file, sensors);
  out.force_factor = sensors.force_factor;
  out.response_factor = sensors.response_factor;
  out.sample_rate_hz = sensors.sample_rate_hz;
  if (file.tables("hits") == 0) file.require("hits", "Write [[hits]] with the columns and the direction");
  for (std::size_t i = 0; i < file.tables("hits"); ++i) {
    HitTable given;
    hit_table().read(file, fmt::format("hits[{}]", i), given);
    out.rows.push_back(std::move(given.row));
  }
  out.notes = file.done();
  return out;
}

}  // namespace robomill::modal
