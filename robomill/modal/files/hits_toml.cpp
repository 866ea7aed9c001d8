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
#include "robomill/modal/files/hit_files/hit_settings.hpp"
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
  double record_mv = 1e3, response_record_mv = 1e3;        ///< what a 1 of a record in volts is
};

/// What some record does not state the unit of.
struct OpenUnits {
  bool force = false, response = false;
  bool volts = false;  ///< of one of them, beside a sensitivity and without voltage_unit
};

constexpr const char* force_key = "acquisition.force_mv_per_n";
constexpr const char* response_in_g_key = "acquisition.response_mv_per_g";
constexpr const char* voltage_key = "acquisition.voltage_unit";
constexpr const char* response_voltage_key = "acquisition.response_voltage_unit";

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
  sensors.record_mv = given.record_mv;
  sensors.response_record_mv = response_mv;
  // Records in volts are neither N nor m/s^2.
  if (file.has(voltage_key)) {
    if (!force) file.require(force_key, "voltage_unit says that the records are in volts: it is on the hammer's sheet");
    if (!response) {
      file.require(kind == ResponseKind::acceleration ? std::string(response_in_g_key) : in_si,
                   "voltage_unit says that the records are in volts: it is on the sensor's calibration sheet");
    }
  }
  if (file.has(response_voltage_key) && !response) {
    throw file.reject(response_voltage_key, "goes with the response's sensitivity: response_mv_per_g");
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
  double record_mv = 1e3;     ///< that a 1 is
  std::string sensitivity = force_key, voltage = voltage_key;
};

struct ReadColumns {
  ReadAs force, response;
};

ReadAs response_read_as(const io::TomlFile& file, ResponseKind kind, const Sensors& sensors) {
  ReadAs as{.quantity = io::Quantity::acceleration,
            .unit = "m/s²",
            .in_volts = sensors.response_in_volts,
            .given_factor = sensors.response_factor,
            .record_mv = sensors.response_record_mv,
            .sensitivity = kind == ResponseKind::acceleration ? response_in_g_key : response_key(kind),
            .voltage = file.has(response_voltage_key) ? response_voltage_key : voltage_key};
  if (kind == ResponseKind::velocity) {
    as.quantity = io::Quantity::velocity;
    as.unit = "m/s";
  } else if (kind == ResponseKind::displacement) {
    as.quantity = io::Quantity::displacement;
    as.unit = "m";
  }
  return as;
}

ReadColumns columns_read_as(const io::TomlFile& file, ResponseKind kind, const Sensors& sensors) {
  return {.force = {.in_volts = sensors.force_in_volts,
                    .given_factor = sensors.force_factor,
                    .record_mv = sensors.record_mv},
          .response = response_read_as(file, kind, sensors)};
}

/// How a column becomes what it is taken for.
struct ColumnUnit {
  double factor = 1.0;
  bool stated = true;  ///< by its record
};

/// A column that is in volts by its record. Its own unit counts where the file gives none.
/// @param by  says where the unit is stated
ColumnUnit unit_of_voltage(const io::TomlFile& file, const std::string& key, const ColumnGuess& said, const ReadAs& as,
                           const std::string& by, std::vector<std::string>& notes) {
  if (!as.in_volts) {
    throw file.reject(key, fmt::format("is a voltage {}, and {} is missing", by, as.sensitivity),
                      "It stands on the sensor's calibration sheet; rename the column if it holds " + as.unit);
  }
  const double factor = said.volts * 1e3 / as.record_mv;
  if (std::abs(factor - 1.0) < 1e-9) return {};
  if (file.has(as.voltage)) {
    throw file.reject(key, fmt::format("is in {} {}, and {} says another unit", said.unit, by, as.voltage),
                      "Correct the one that is wrong, or rename the column");
  }
  notes.push_back(fmt::format("Column {} is in {} {}.", said.name, said.unit, by));
  return {.factor = factor};
}

/// SI per number of a column whose name, or row of units, states its unit: ax_g, Force [kN]. 1 where none is stated.
/// @throws InvalidInput with the key, if it is of another quantity than the file takes the column for
ColumnUnit unit_of(const io::TomlFile& file, const std::string& key, const io::Record& record, std::size_t place,
                   const ReadAs& as, std::vector<std::string>& notes) {
  const ColumnGuess said = guess_by_name(record, place);
  const bool by_row = place < record.units.size() && !record.units[place].empty();
  const std::string by = by_row ? "by " + record.units_by : "by its name";
  if (said.volts > 0.0) return unit_of_voltage(file, key, said, as, by, notes);
  const io::SiFactor si = io::parse_unit(said.unit);
  if (!has_own_units(record)) return {.stated = si.quantity == as.quantity && !record.si_assumed};
  if (said.unit.empty() || said.unit == "-") return {.stated = false};
  // Of a name it may be a remark: "acc (front)".
  if (!by_row && (si.is_ratio || si.quantity == io::Quantity::unknown)) {
    if (!as.in_volts)
      notes.push_back(fmt::format("Columns {}: \"{}\" is no unit known here, and they are read in {}.", said.name,
                                  said.unit, as.unit));
    return {.stated = false};
  }
  if (si.is_ratio || si.quantity != as.quantity) {
    throw file.reject(
        key, fmt::format("is in {} {}, and is read in {}", said.unit, by, as.unit),
        as.quantity == io::Quantity::force || si.quantity == io::Quantity::force
            ? "Are the columns of force and response exchanged?"
            : "acquisition.response says what the sensor measures: acceleration, velocity or displacement");
  }
  if (as.in_volts) {
    if (std::abs(as.given_factor / si.factor - 1.0) < 1e-3) return {};
    throw file.reject(key,
                      fmt::format("is in {} {}, where {} makes {:.4g} {} of a 1", said.unit, by, as.sensitivity,
                                  as.given_factor, as.unit),
                      "Leave the sensitivity out if the recorder used it already, or rename the column");
  }
  if (si.factor != 1.0) {
    notes.push_back(fmt::format("Columns {} are in {} {}: converted with {:.6g} to {}.", said.name, said.unit,
                                by_row ? by : "by their name", si.factor, as.unit));
  }
  return {.factor = si.factor};
}

RecordOfHits open_record(const io::TomlFile& file, const std::string& key, const HitTable& given,
                         const Sensors& sensors) {
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

/// A column that a row names.
struct NamedColumn {
  io::Record* part = nullptr;
  std::size_t place = 0;
  double factor = 1.0;  ///< makes SI of it
};

/// The samples in SI. @param last  no column behind it is the same: they are moved out of the record
Eigen::VectorXd samples_of(const NamedColumn& column, bool last) {
  Eigen::VectorXd& recorded = column.part->columns[column.place];
  Eigen::VectorXd samples = last ? std::move(recorded) : recorded;
  samples *= column.factor;
  return samples;
}

/// The columns that a row names, in SI; the record is used up, so that no sample is held twice.
Hit hit_of(const io::TomlFile& file, const std::string& row, const HitRow& columns, RecordOfHits record,
           const ReadColumns& as, OpenUnits& open, std::vector<std::string>& notes) {
  Hit hit;
  for (const io::Record& part : record.parts) hit.file += (hit.file.empty() ? "" : " + ") + part.file.string();
  hit.excitation = columns.excitation;
  hit.against_axis = columns.against_axis;
  hit.sample_rate_hz = record.sample_rate_hz;
  std::vector<std::string> converted;
  const auto factor = [&](const char* key, const RecordOfHits::Column& column, const ReadAs& read_as, bool& is_open) {
    const ColumnUnit unit = unit_of(file, row + key, *column.part, column.place, read_as, converted);
    is_open = is_open || !unit.stated;
    open.volts = open.volts || (!unit.stated && read_as.in_volts && !file.has(read_as.voltage));
    return read_as.given_factor * unit.factor;
  };
  std::vector<NamedColumn> named;
  const auto name = [&](const std::string& text, bool is_force) {
    const RecordOfHits::Column column = file.locate([&] { return record.column(text, is_force); });
    const auto part = static_cast<std::size_t>(column.part - record.parts.data());
    const double si = is_force ? factor("force", column, as.force, open.force)
                               : factor("responses", column, as.response, open.response);
    named.push_back({.part = &record.parts[part], .place = column.place, .factor = si});
  };
  name(columns.force, true);
  for (const HitRow::Response& response : columns.responses) name(response.column, false);
  const auto samples = [&](std::size_t i) {
    const auto same = [&](const NamedColumn& one) { return one.part == named[i].part && one.place == named[i].place; };
    return samples_of(named[i], std::none_of(named.begin() + static_cast<std::ptrdiff_t>(i) + 1, named.end(), same));
  };
  hit.force_n = samples(0);
  for (std::size_t i = 0; i < columns.responses.size(); ++i) {
    const HitRow::Response& response = columns.responses[i];
    hit.responses.push_back({.dof = response.dof, .samples = samples(i + 1), .against_axis = response.against_axis});
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
std::vector<Hit> read_row(io::TomlFile& file, std::size_t index, const ReadColumns& as, const Sensors& sensors,
                          OpenUnits& open, std::vector<std::string>& notes) {
  const std::string row = fmt::format("hits[{}].", index);
  file.require(row + "file");
  HitTable given;
  hit_table().read(file, fmt::format("hits[{}]", index), given);
  RecordOfHits record = open_record(file, row + "file", given, sensors);
  std::ranges::copy(record.notes, std::back_inserter(notes));
  if (!(record.sample_rate_hz > 0.0)) {
    throw file.reject(row + "file", "has no time column, and acquisition.sample_rate_hz is missing");
  }
  const double begin_s = record.begin_s;
  Hit whole = hit_of(file, row, given.row, std::move(record), as, open, notes);
  const std::string name = whole.file;
  std::vector<Hit> hits;
  if (given.split) {
    hits = split_hits(std::move(whole), sensors.hit_spacing_s, begin_s);
  } else {
    hits.push_back(std::move(whole));
  }
  if (hits.size() > 1)
    notes.push_back(fmt::format("{}: {} hits, cut apart by the pulses of the force", name, hits.size()));
  leave_out(file, row + "leave_out", given.leave_out, hits);
  return hits;
}

/// What is taken where neither the file nor its records say it.
std::vector<Assumption> assumed_of(const io::TomlFile& file, const ReadColumns& as, ResponseKind kind,
                                   const OpenUnits& open, const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  std::vector<Assumption> out;
  // A unit that is stated says what the sensors measure.
  if (!file.has("acquisition.response") && open.response) {
    out.push_back({.what = "Responses", .taken = "accelerations", .key = "acquisition.response", .file = name});
  }
  for (Assumption& one : assumed_units(
           {.force = open.force && !as.force.in_volts, .response = open.response && !as.response.in_volts}, kind, name))
    out.push_back(std::move(one));
  if (open.volts) {
    out.push_back({.what = "Voltages in records without a unit", .taken = "V", .key = voltage_key, .file = name});
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
  const ReadColumns as = columns_read_as(file, out.options.response, sensors);
  OpenUnits open;
  for (std::size_t i = 0; i < file.tables("hits"); ++i)
    std::ranges::move(read_row(file, i, as, sensors, open, out.notes), std::back_inserter(out.hits));
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  out.assumed = assumed_of(file, as, out.options.response, open, source.path);
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
