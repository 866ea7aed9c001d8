#include "robomill/modal/files/hits_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/modal/files/hit_guess.hpp"

namespace robomill::modal {
namespace {

/// How a record's numbers become N and the SI unit of the response.
struct Sensors {
  double force_factor = 1.0;
  double response_factor = 1.0;
  double scale = 1.0;  ///< full scale of a WAV
  bool has_scale = false;
  double sample_rate_hz = 0.0;
  bool force_in_volts = false, response_in_volts = false;  ///< the sensitivities are given
};

void read_options(io::TomlFile& file, HitOptions& o) {
  file.choice<ResponseKind>("acquisition.response",
                            {{"acceleration", ResponseKind::acceleration},
                             {"velocity", ResponseKind::velocity},
                             {"displacement", ResponseKind::displacement}},
                            o.response);
  file.choice<Estimator>("acquisition.estimator", {{"H1", Estimator::h1}, {"H2", Estimator::h2}, {"Hv", Estimator::hv}},
                         o.estimator);
  file.choice<ExponentialWindow>(
      "acquisition.exponential_window",
      {{"automatic", ExponentialWindow::automatic}, {"off", ExponentialWindow::off}, {"on", ExponentialWindow::on}},
      o.exponential_window);
  file.boolean("acquisition.force_window", o.force_window);
  file.boolean("acquisition.remove_added_damping", o.remove_added_damping);
  const auto number = [&file](const std::string& key, const char* member, double& out) {
    file.number("acquisition." + key, member, 1.0, out);
  };
  number("accelerometer_mass_kg", "accelerometer_mass_kg", o.accelerometer_mass_kg);
  number("min_frequency_hz", "min_frequency_hz", o.min_frequency_hz);
  number("max_frequency_hz", "max_frequency_hz", o.max_frequency_hz);
  number("frequency_resolution_hz", "frequency_resolution_hz", o.frequency_resolution_hz);
  number("force_overload_n", "force_overload_n", o.force_overload_n);
  number(fmt::format("response_overload_{}", response_unit(o.response)), "response_overload", o.response_overload);
  number("double_hit_limit", "double_hit_limit", o.double_hit_limit);
  number("force_window_s", "force_window_s", o.force_window_s);
  number("exponential_time_constant_s", "exponential_time_constant_s", o.exponential_time_constant_s);
}

/// Of a sensor in mV per unit; one that is mounted the other way round may be negative.
/// @param record_mv  what a 1 of the record is
bool sensitivity(io::TomlFile& file, const std::string& key, double record_mv, double unit, double& factor) {
  double mv_per_unit = 0.0;
  if (!file.number(key, key, 1.0, mv_per_unit)) return false;
  if (mv_per_unit == 0.0) throw file.reject(key, "must not be 0", "It stands on the sensor's calibration sheet");
  factor = record_mv / mv_per_unit * unit;
  return true;
}

constexpr const char* force_key = "acquisition.force_mv_per_n";
constexpr const char* response_in_g_key = "acquisition.response_mv_per_g";

std::string response_key(ResponseKind kind) {
  return fmt::format("acquisition.response_mv_per_{}", response_unit(kind));
}

/// Without sensitivities the records are in N and the SI unit of the response.
void read_sensitivities(io::TomlFile& file, ResponseKind kind, Sensors& sensors) {
  const char* const voltage = "acquisition.voltage_unit";
  const char* const response_voltage = "acquisition.response_voltage_unit";
  double force_mv = 1e3;
  file.choice<double>(voltage, {{"V", 1e3}, {"mV", 1.0}}, force_mv);
  double response_mv = force_mv;
  file.choice<double>(response_voltage, {{"V", 1e3}, {"mV", 1.0}}, response_mv);
  const std::string in_si = response_key(kind);
  const bool force = sensitivity(file, force_key, force_mv, 1.0, sensors.force_factor);
  bool response = sensitivity(file, in_si, response_mv, 1.0, sensors.response_factor);
  if (kind == ResponseKind::acceleration) {
    if (file.has(response_in_g_key) && response) {
      throw file.reject(response_in_g_key, fmt::format("must not stand beside {}", in_si),
                        "They say the same in two units");
    }
    response =
        sensitivity(file, response_in_g_key, response_mv, units::standard_gravity, sensors.response_factor) || response;
  }
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

Sensors read_sensors(io::TomlFile& file, ResponseKind kind) {
  Sensors sensors;
  read_sensitivities(file, kind, sensors);
  sensors.has_scale = file.number("acquisition.scale", "scale", 1.0, sensors.scale);
  if (file.number("acquisition.sample_rate_hz", "sample_rate_hz", 1.0, sensors.sample_rate_hz) &&
      !(sensors.sample_rate_hz > 0.0)) {
    throw file.reject("acquisition.sample_rate_hz", "must be > 0");
  }
  return sensors;
}

struct Direction {
  Dof dof;
  bool against_axis = false;
};

/// "x", or "-x" against the axis.
Direction direction(const io::TomlFile& file, const std::string& key, std::string_view text) {
  const bool against = !text.empty() && text.front() == '-';
  if (against) text.remove_prefix(1);
  try {
    return {.dof = parse_dof(text), .against_axis = against};
  } catch (const InvalidInput&) {
    throw file.reject(key, "must be a direction", "x, y or z; -x for a hit against the axis; 3x at point 3");
  }
}

/// A column's name, or its number from 1 (as a number or as text).
std::string column(io::TomlFile& file, const std::string& key) {
  std::string name;
  int number = 0;
  if (file.is_number(key)) {
    file.integer(key, key, number);
    if (number < 1) throw file.reject(key, "must be a column's name or its number from 1");
    return std::to_string(number);
  }
  file.text(key, name);
  return name;
}

double rate_of(const io::TomlFile& file, const std::string& key, const io::Record& record, double given_hz,
               std::vector<std::string>& notes) {
  double rate_hz = 0.0;
  try {
    rate_hz = io::rate_of(record, given_hz, "acquisition.sample_rate_hz", notes);
  } catch (const InvalidInput& error) {
    throw file.reject(key, error.parts().rule);
  }
  if (rate_hz > 0.0) return rate_hz;
  throw file.reject(key, "has no time column, and acquisition.sample_rate_hz is missing");
}

HitRow read_row(io::TomlFile& file, const std::string& row) {
  for (const char* key : {"force", "force_direction", "responses"}) file.require(row + key);
  HitRow out;
  std::string text;
  file.text(row + "force_direction", text);
  const Direction push = direction(file, row + "force_direction", text);
  out.excitation = push.dof;
  out.against_axis = push.against_axis;
  out.force = column(file, row + "force");
  const std::vector<std::string> responses = file.keys(row + "responses");
  if (responses.empty()) throw file.reject(row + "responses", "must name a column for one direction at least");
  for (const std::string& name : responses) {
    const std::string key = row + "responses." + name;
    const Direction sensed = direction(file, key, name);
    out.responses.push_back({.dof = sensed.dof, .against_axis = sensed.against_axis, .column = column(file, key)});
  }
  return out;
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

/// Whether the file has names and units that its reader did not convert.
bool has_own_units(const io::Record& record) {
  const io::Format format = io::format_of(record.file);
  return format == io::Format::csv || format == io::Format::text || format == io::Format::mat;
}

/// SI per number of a column whose name, or row of units, states its unit: ax_g, Force [kN]. 1 where none is stated.
/// @throws InvalidInput with the key, if it is of another quantity than the file takes the column for
double factor_of_unit(const io::TomlFile& file, const std::string& key, const io::Record& record, std::size_t place,
                      const ReadAs& as, std::vector<std::string>& notes) {
  const ColumnGuess said = guess_by_name(record, place);
  const bool by_row = place < record.units.size() && !record.units[place].empty();
  const std::string by = by_row ? "by the row of units" : "by its name";
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

Hit read_hit(io::TomlFile& file, std::size_t index, ResponseKind kind, const Sensors& sensors,
             std::vector<std::string>& notes) {
  const std::string row = fmt::format("hits[{}].", index);
  file.require(row + "file");
  const HitRow columns = read_row(file, row);
  if (file.has(row + "file[0]")) {
    throw file.reject(row + "file", "must be one file",
                      "Force and response in two files are not read yet: write them beside each other in one CSV");
  }
  std::filesystem::path path;
  file.path(row + "file", path);
  if (io::format_of(path) == io::Format::wav && !sensors.has_scale) {
    throw file.reject(row + "file", "is a WAV, and acquisition.scale is missing",
                      "scale says what full scale means: volts where the sensors' mV per unit are given");
  }
  io::RecordOptions reading{.scale = sensors.scale};
  if (file.has(row + "time")) reading.time = column(file, row + "time");
  io::Record record = file.locate([&] { return io::read_record(path, reading); });
  if (!reading.time.empty() && has_own_units(record)) {
    record.sample_rate_hz /= guess_by_name(record, record.place(reading.time)).si_per_unit;  // of times in ms
  }
  notes.insert(notes.end(), record.notes.begin(), record.notes.end());

  Hit hit;
  hit.file = path.string();
  hit.excitation = columns.excitation;
  hit.against_axis = columns.against_axis;
  hit.sample_rate_hz = rate_of(file, row + "file", record, sensors.sample_rate_hz, notes);
  std::vector<std::string> converted;
  const auto factor = [&](const std::string& key, const std::string& column, const ReadAs& as) {
    return has_own_units(record) ? factor_of_unit(file, row + key, record, record.place(column), as, converted) : 1.0;
  };
  const double force =
      factor("force", columns.force, {.in_volts = sensors.force_in_volts, .given_factor = sensors.force_factor});
  hit.force_n = record.column(columns.force) * sensors.force_factor * force;
  for (const HitRow::Response& response : columns.responses) {
    const double unit = factor("responses", response.column, response_read_as(kind, sensors));
    hit.responses.push_back({.dof = response.dof,
                             .samples = record.column(response.column) * sensors.response_factor * unit,
                             .against_axis = response.against_axis});
  }
  for (const std::string& note : converted) {
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
  }
  return hit;
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
  read_options(file, out.options);
  const Sensors sensors = read_sensors(file, out.options.response);
  file.locate([&] { out.options.validate(); });
  if (file.tables("hits") == 0) file.require("hits", "Write [[hits]] above each record");
  for (std::size_t i = 0; i < file.tables("hits"); ++i)
    out.hits.push_back(read_hit(file, i, out.options.response, sensors, out.notes));
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  out.assumed = assumed_of(file, out.options.response, source.path);
  add_assumed(out.assumed, io::sample_values(file));
  return out;
}

HitRows read_hit_rows(const io::TomlSource& source) {
  io::TomlFile file(source);
  HitRows out;
  read_options(file, out.options);
  const Sensors sensors = read_sensors(file, out.options.response);
  file.locate([&] { out.options.validate(); });
  out.force_factor = sensors.force_factor;
  out.response_factor = sensors.response_factor;
  out.sample_rate_hz = sensors.sample_rate_hz;
  if (file.tables("hits") == 0) file.require("hits", "Write [[hits]] with the columns and the direction");
  for (std::size_t i = 0; i < file.tables("hits"); ++i) {
    const std::string row = fmt::format("hits[{}].", i);
    for (const char* key : {"file", "time"}) file.skip(row + key);
    out.rows.push_back(read_row(file, row));
  }
  out.notes = file.done();
  return out;
}

}  // namespace robomill::modal
