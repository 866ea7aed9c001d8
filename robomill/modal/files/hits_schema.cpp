#include "robomill/modal/files/hits_schema.hpp"

#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/joined_records.hpp"

namespace robomill::modal {
namespace {

using io::declared;
using io::Holds;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::TomlFile;

constexpr Name<ResponseKind> response_names[] = {{"acceleration", ResponseKind::acceleration},
                                                 {"velocity", ResponseKind::velocity},
                                                 {"displacement", ResponseKind::displacement}};
constexpr Name<Estimator> estimator_names[] = {{"H1", Estimator::h1}, {"H2", Estimator::h2}, {"Hv", Estimator::hv}};
constexpr Name<ExponentialWindow> window_names[] = {
    {"automatic", ExponentialWindow::automatic}, {"off", ExponentialWindow::off}, {"on", ExponentialWindow::on}};
constexpr Name<double> voltage_names[] = {{"V", 1e3}, {"mV", 1.0}};
constexpr Name<Weighting> weighting_names[] = {
    {"automatic", Weighting::automatic}, {"none", Weighting::none},           {"relative", Weighting::relative},
    {"coherence", Weighting::coherence}, {"deviation", Weighting::deviation}, {"estimated", Weighting::estimated}};

constexpr const char* not_percent = "It is a ratio, not a percentage";
constexpr const char* not_percent_share = "It is a share, not a percentage";

struct Direction {
  Dof dof;
  bool against_axis = false;
};

/// "x", or "-x" against the axis.
Direction direction(const TomlFile& file, const std::string& path, std::string_view text) {
  const bool against = !text.empty() && text.front() == '-';
  if (against) text.remove_prefix(1);
  try {
    return {.dof = parse_dof(text), .against_axis = against};
  } catch (const InvalidInput&) {
    throw file.reject(path, "must be a direction", "x, y or z; -x for a hit against the axis; 3x at point 3");
  }
}

/// A column's name, or its number from 1 (as a number or as text).
std::string read_column(TomlFile& file, const std::string& path) {
  std::string name;
  if (!file.is_number(path)) {
    file.text(path, name);
    return name;
  }
  int number = 0;
  file.integer(path, path, number);
  if (number < 1) throw file.reject(path, "must be a column's name or its number from 1");
  return std::to_string(number);
}

/// @param code  (TomlFile&, path, HitTable&)
template <class F>
Row<HitTable> column_key(const char* name, const char* meaning, F code) {
  return declared<HitTable>(name, Holds::text, meaning).or_also(Holds::integer).read_by(code);
}

void read_force_direction(TomlFile& file, const std::string& path, HitTable& out) {
  std::string text;
  file.text(path, text);
  const Direction push = direction(file, path, text);
  out.row.excitation = push.dof;
  out.row.against_axis = push.against_axis;
}

void read_responses(TomlFile& file, const std::string& path, HitTable& out) {
  for (const std::string& name : file.keys(path)) {
    const std::string column = path + "." + name;
    const Direction sensed = direction(file, column, name);
    out.row.responses.push_back(
        {.dof = sensed.dof, .against_axis = sensed.against_axis, .column = read_column(file, column)});
  }
  if (out.row.responses.empty()) throw file.reject(path, "must name a column for one direction at least");
}

Row<HitTable> responses_key() {
  Row<HitTable> row = column_key("responses",
                                 "column of each direction; -y: the sensor points against the axis; of two files a "
                                 "number counts in the second, \"FILE:COLUMN\" in the one named",
                                 read_responses);
  row.key.named = true;
  return row.required();
}

void read_band(TomlFile& file, const std::string& path, FitOptions& out) {
  std::vector<double> band;
  if (!file.numbers(path, "band_hz", 1.0, band)) return;
  if (band.size() != 2 || !(band[0] < band[1])) throw file.reject(path, "must be [low, high] with low < high");
  out.band_low_hz = band[0];
  out.band_high_hz = band[1];
}

Row<Acquisition> option(Row<HitOptions> row) {
  return of(&Acquisition::options, std::move(row));
}

Row<Acquisition> overload_key(const char* name, const char* meaning) {
  return option(key(name, &HitOptions::response_overload, meaning).as("response_overload").at_least(0.0));
}

}  // namespace

const Schema<Acquisition>& acquisition_table() {
  static const Schema<Acquisition> table(
      "acquisition", "what was measured, and how FRFs are estimated",
      {key("sample_rate_hz", &Acquisition::sample_rate_hz,
           "not needed where records have a time column or their header states the rate. Streams of a tap test need it")
           .above(0.0),
       option(key("response", &HitOptions::response, response_names, "what the sensors measure")),
       option(key("estimator", &HitOptions::estimator, estimator_names, "of the FRFs")),
       key("force_mv_per_n", &Acquisition::force_mv_per_n,
           "sensitivity of the hammer: the records hold volts, or voltage_unit; without it N"),
       key("response_mv_per_g", &Acquisition::response_mv_per_g,
           "sensitivity of an accelerometer; without a sensitivity the SI unit of the response"),
       key("response_mv_per_m_per_s2", &Acquisition::response_mv_per_m_per_s2, "the same in SI"),
       key("response_mv_per_m_per_s", &Acquisition::response_mv_per_m_per_s, "sensitivity of a velocity's sensor"),
       key("response_mv_per_m", &Acquisition::response_mv_per_m, "sensitivity of a displacement's sensor"),
       key("voltage_unit", &Acquisition::record_mv, voltage_names, "unit of the records; needs both sensitivities"),
       key("response_voltage_unit", &Acquisition::response_record_mv, voltage_names,
           "of the responses, if their unit differs from the force's"),
       key("scale", &Acquisition::scale, "unit per full scale of WAV records"),
       key("hit_spacing_s", &Acquisition::hit_spacing_s,
           "pulses of a record closer than this are one hit, a double one; later ones are further hits")
           .above(0.0),
       option(key("accelerometer_mass_kg", &HitOptions::accelerometer_mass_kg,
                  "its effect is removed from the FRFs; then not in [accelerometer] of assembly.toml")
                  .at_least(0.0)
                  .at_most(1.0, "An accelerometer weighs grams; is the value in kg?")),
       option(
           key("force_overload_n", &HitOptions::force_overload_n, "the hammer's range; 0: only flat tops are rejected")
               .at_least(0.0)),
       overload_key("response_overload_m_per_s2", "an accelerometer's range; 0: only flat tops are rejected"),
       overload_key("response_overload_m_per_s", "the same of a velocity's sensor"),
       overload_key("response_overload_m", "the same of a displacement's sensor"),
       option(key("double_hit_limit", &HitOptions::double_hit_limit,
                  "share of the first pulse above which a second one rejects the hit")
                  .above(0.0)
                  .at_most(1.0, "It is a part of the first pulse's peak, not a percentage")),
       option(key("min_frequency_hz", &HitOptions::min_frequency_hz, "lowest line to give; 0: the first above zero")
                  .at_least(0.0)),
       option(key("max_frequency_hz", &HitOptions::max_frequency_hz, "highest line to give; 0: sample rate / 2.56")
                  .at_least(0.0)),
       option(key("frequency_resolution_hz", &HitOptions::frequency_resolution_hz,
                  "step of the lines; 0: 1 / record length")
                  .at_least(0.0)),
       option(key("force_window", &HitOptions::force_window, "zero the force outside its pulse")),
       option(key("force_window_s", &HitOptions::force_window_s, "length of that window; 0: from the pulse")
                  .at_least(0.0)),
       option(key("exponential_window", &HitOptions::exponential_window, window_names,
                  "for responses that have not decayed")),
       option(key("exponential_time_constant_s", &HitOptions::exponential_time_constant_s,
                  "of that window; 0: from the responses")
                  .at_least(0.0)),
       option(key("remove_added_damping", &HitOptions::remove_added_damping,
                  "take what that window adds out of the FRFs again"))});
  return table;
}

const Schema<HitTable>& hit_table() {
  static const Schema<HitTable> table(
      "hit", "a hit and its record",
      {declared<HitTable>(
           "file", Holds::path,
           "a record in any format of measurement files; a list of the force's file and the responses' where they are "
           "apart; not needed for a tap test's stream",
           1)
           .or_one()
           .read_by([](TomlFile& file, const std::string& path, HitTable& out) {
             io::read_record_files(file, path, out.files);
           }),
       column_key("time", "column's name or number from 1, where it is not found; of several files in each that has it",
                  [](TomlFile& file, const std::string& path, HitTable& out) { out.time = read_column(file, path); }),
       column_key(
           "force", "column's name or number from 1; of several files a number counts in the first",
           [](TomlFile& file, const std::string& path, HitTable& out) { out.row.force = read_column(file, path); })
           .required(),
       declared<HitTable>("force_direction", Holds::text, "of the hit: x, y or z; -x against the axis; 3x at point 3")
           .required()
           .read_by(read_force_direction),
       responses_key(), key("split", &HitTable::split, "several hits in one record are cut apart"),
       key("leave_out", &HitTable::leave_out, "hits of such a record that do not count, from 1")});
  return table;
}

const Schema<FitOptions>& fit_options_table() {
  static const Schema<FitOptions> table(
      "fit", "how modes are fitted",
      {key("method", &FitOptions::method, fit_method_names, "robomill/modal/README.md describes them"),
       key("weighting", &FitOptions::weighting, weighting_names, "of the lines"),
       declared<FitOptions>("band_hz", Holds::number, "lines that are fitted, from, to; without it all", 1)
           .entries(2)
           .read_by(read_band),
       key("modes", &FitOptions::modes, "exactly so many; 0: as many as the data shows").at_least(0.0).at_most(200.0),
       key("max_modes", &FitOptions::max_modes, "at most so many, where modes is 0").at_least(1.0).at_most(60.0),
       key("residuals", &FitOptions::residuals, "allow mass and stiffness residuals for modes outside the band"),
       key("max_damping_ratio", &FitOptions::max_damping_ratio, "no mode of hybrid or lscf above it")
           .above(0.0)
           .below(1.0, not_percent),
       key("exponential_decay_per_s", &FitOptions::exponential_decay_per_s,
           "subtracted from every pole's decay: 1/τ where the hits had the window exp(-t/τ)")
           .at_least(0.0),
       key("lscf_max_order", &FitOptions::lscf_max_order, "highest polynomial order of the stabilisation diagram")
           .at_least(2.0)
           .at_most(200.0),
       key("stable_frequency", &FitOptions::stable_frequency,
           "a pole is stable if it moved less than this share of its frequency …")
           .above(0.0, not_percent_share),
       key("stable_damping", &FitOptions::stable_damping, "… its damping ratio less than this share …")
           .above(0.0, not_percent_share),
       key("stable_mac", &FitOptions::stable_mac, "… and MAC with the one before is above this")
           .at_least(0.0)
           .at_most(1.0),
       key("pso_particles", &FitOptions::pso_particles, "of the swarm").at_least(2.0).at_most(1e7),
       key("pso_max_iterations", &FitOptions::pso_max_iterations, "of the swarm").at_least(1.0).at_most(1e9),
       key("pso_frequency_half_width", &FitOptions::pso_frequency_half_width,
           "of the swarm: a mode stays within (1 ± this) of its peak")
           .above(0.0)
           .below(1.0),
       key("pso_max_damping_ratio", &FitOptions::pso_max_damping_ratio, "of the swarm: no mode above it")
           .above(0.0)
           .at_most(1.0, not_percent),
       key("pso_inertia_start", &FitOptions::pso_inertia_start, "of the swarm, at its first move")
           .at_least(0.0)
           .at_most(1.0),
       key("pso_inertia_end", &FitOptions::pso_inertia_end, "to which it falls, at most pso_inertia_start")
           .at_least(0.0)
           .at_most(1.0),
       key("pso_inertia_iterations", &FitOptions::pso_inertia_iterations,
           "over which it falls, linearly; only then the swarm may stop as converged")
           .at_least(1.0)
           .at_most(1e9),
       key("pso_cognitive", &FitOptions::pso_cognitive, "c1, pull of a particle's own best")
           .at_least(0.0)
           .at_most(100.0),
       key("pso_social", &FitOptions::pso_social, "c2, pull of the swarm's best").at_least(0.0).at_most(100.0),
       key("pso_velocity_fraction", &FitOptions::pso_velocity_fraction,
           "no velocity above this share of its unknown's range; 0: no bound")
           .at_least(0.0)
           .at_most(1.0)});
  return table;
}

}  // namespace robomill::modal
