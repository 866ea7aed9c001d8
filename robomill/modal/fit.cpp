#include "robomill/modal/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/modal/fitting/fit_hybrid.hpp"
#include "robomill/modal/fitting/fit_parts.hpp"
#include "robomill/modal/fitting/fit_report.hpp"
#include "robomill/modal/published/pso.hpp"
#include "robomill/modal/weak_modes.hpp"

namespace robomill::modal {
namespace {

using detail::Part;
using detail::PartFit;
using Eigen::Index;

void require_between(const char* field, double value, double low, double high, const char* rule) {
  if (!(value >= low && value <= high)) throw InvalidInput(field, value, "", rule);
}

bool known(const Eigen::VectorXd& values, double meaningless) {
  return values.size() > 0 && (values.array() != meaningless).any();
}

bool has_deviation(const FrfSet& set) {
  return std::all_of(set.frfs.begin(), set.frfs.end(), [](const Frf& frf) { return known(frf.deviation, 0.0); });
}

// A coherence of one throughout is that of a single hit: it says nothing.
bool has_coherence(const FrfSet& set) {
  return std::all_of(set.frfs.begin(), set.frfs.end(), [](const Frf& frf) { return known(frf.coherence, 1.0); });
}

Weighting resolved(Weighting asked, const FrfSet& set) {
  if (asked == Weighting::automatic) {
    if (has_deviation(set)) return Weighting::deviation;
    return has_coherence(set) ? Weighting::coherence : Weighting::estimated;
  }
  if (asked == Weighting::deviation && !has_deviation(set)) {
    throw InvalidInput("weighting", "is \"deviation\", which the FRFs do not all have",
                       "Use \"auto\" or \"estimated\"");
  }
  if (asked == Weighting::coherence && !has_coherence(set)) {
    throw InvalidInput("weighting",
                       "is \"coherence\", which the FRFs do not all have (or is 1 throughout: a single hit)",
                       "Use \"auto\" or \"estimated\"");
  }
  return asked;
}

// FRFs that are zero on every line say nothing about a mode; left out, they are zero in the model too where possible.
FrfSet without_zeros(const FrfSet& set, std::vector<std::string>& warnings) {
  FrfSet rest{.frequency_hz = set.frequency_hz, .frfs = {}};
  for (const Frf& frf : set.frfs) {
    if (frf.receptance.squaredNorm() > 0.0) {
      rest.frfs.push_back(frf);
    } else {
      warnings.push_back(
          fmt::format("H_{} is zero on every line of the band: taken as not measured.", to_string(frf.name)));
    }
  }
  if (rest.frfs.empty()) throw InvalidInput("frfs", "are zero on every line of the band", "Is the band the right one?");
  return rest;
}

void require_lines(const FrfSet& set, const FitOptions& options) {
  constexpr Index least = 16;
  const Index lines = set.frequency_hz.size();
  const Index needed = std::max(least, static_cast<Index>(2 * options.modes + 4));
  if (lines >= needed) return;
  const bool modes = needed > least;
  throw InvalidInput(modes ? "modes" : "lines in the band", static_cast<double>(modes ? options.modes : lines), "",
                     fmt::format("needs at least {} lines; the band holds {}", needed, lines),
                     "Widen the band, or measure longer records for a finer resolution");
}

// The fits of one part with the number of modes asked for so far.
class PartFits {
 public:
  PartFits(const Part& part, const FrfSet& set, const FitOptions& options, Weighting weighting, Progress& progress)
      : part_(part), set_(set), options_(options), weighting_(weighting), progress_(progress) {
    // Two modes need four lines, whatever the limit says.
    options_.max_modes = std::min(options.max_modes, static_cast<int>(part.data.omega.size() / 2 - 2));
  }
  struct Done {
    Part part;
    PartFit fit;
    double error2 = 0.0;  // ‖H_fit - H‖², in units of the receptance
  };
  // modes 0: as many as the data shows.
  const Done& at(int modes) {
    const auto known = done_.find(modes);
    if (known != done_.end()) return known->second;
    Done done{.part = part_, .fit = {}};
    done.part.data.residuals = options_.residuals;
    detail::set_first_weights(done.part, set_, weighting_);
    done.fit = options_.method == FitMethod::lscf
                   ? detail::fit_lscf(done.part, options_, modes, progress_)
                   : detail::fit_hybrid(done.part, set_, options_, modes, weighting_, progress_);
    for (std::size_t f = 0; f < done.part.data.entries.size(); ++f) {
      const double unit = done.part.unit(done.part.data.entries[f]);
      done.error2 += unit * unit * done.fit.at.residual.col(static_cast<Index>(f)).squaredNorm();
    }
    return done_.emplace(modes, std::move(done)).first->second;
  }

 private:
  const Part& part_;
  const FrfSet& set_;
  FitOptions options_;
  Weighting weighting_;
  Progress& progress_;
  std::map<int, Done> done_;
};

// How many modes each part gets of `total`: from what each shows by itself, one by one where the error falls most or
// rises least.
std::vector<int> deal(std::vector<PartFits>& parts, int total) {
  if (total < static_cast<int>(parts.size())) {
    throw InvalidInput("modes", total, "",
                       "must be at least 1 for each group of FRFs that share no response or excitation",
                       "Measure the cross FRFs too, or fit the files one by one");
  }
  std::vector<int> counts;
  counts.reserve(parts.size());
  for (PartFits& part : parts) counts.push_back(std::max(1, static_cast<int>(part.at(0).fit.poles.size())));
  for (int sum = std::accumulate(counts.begin(), counts.end(), 0); sum != total;) {
    const int step = sum < total ? 1 : -1;
    std::size_t best = parts.size();
    double least = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (counts[p] + step < 1) continue;
      const double change = parts[p].at(counts[p] + step).error2 - parts[p].at(counts[p]).error2;
      if (best < parts.size() && change >= least) continue;
      best = p;
      least = change;
    }
    counts[best] += step;
    sum += step;
  }
  return counts;
}

// Poles of the diagram in Hz.
void add_diagram(FitResult& result, const PartFits::Done& done) {
  const double hz = done.part.omega_unit / (2.0 * std::numbers::pi);
  for (const detail::LscfPole& pole : done.fit.diagram) {
    result.stabilisation.push_back({.order = pole.order,
                                    .frequency_hz = pole.omega * hz,
                                    .damping_ratio = pole.zeta,
                                    .frequency_stable = pole.frequency_stable,
                                    .damping_stable = pole.damping_stable,
                                    .vector_stable = pole.vector_stable});
  }
}

void fit_by_poles(FitResult& result, const FrfSet& set, const FitOptions& options, Progress& progress) {
  result.weighting = resolved(options.weighting, set);
  const std::vector<Part> parts = detail::split(set);
  std::vector<PartFits> fits;
  fits.reserve(parts.size());
  for (const Part& part : parts) fits.emplace_back(part, set, options, result.weighting, progress);
  std::vector<int> counts(parts.size(), options.modes);
  if (parts.size() > 1 && options.modes > 0) counts = deal(fits, options.modes);
  result.model = detail::empty_model(set);
  result.status = FitResult::Status::converged;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const PartFits::Done& done = fits[p].at(counts[p]);
    detail::add_to_model(result.model, done.part, done.fit, done.part.data.residuals);
    add_diagram(result, done);
    result.iterations += done.fit.iterations;
    result.best.insert(result.best.end(), done.fit.cost.begin(), done.fit.cost.end());
    for (const double omega : done.fit.dropped_omega) {
      result.dropped_hz.push_back(omega * done.part.omega_unit / (2.0 * std::numbers::pi));
    }
    if (!done.fit.converged) result.status = FitResult::Status::not_converged;
    if (done.fit.held_back) {
      result.warnings.push_back(
          fmt::format("Only their scatter shows how accurate the lines are, as with a single hit: {} modes come near "
                      "enough. Hit several times, or ask for a number of modes.",
                      done.fit.poles.size()));
    }
    progress.advance();
  }
}

void fit_by_swarm(FitResult& result, const FrfSet& set, const FitOptions& options, Progress& progress) {
  const PsoResult swarm = fit_pso(set,
                                  {.modes = options.modes,
                                   .frequency_half_width = options.pso_frequency_half_width,
                                   .max_damping_ratio = options.pso_max_damping_ratio,
                                   .particles = options.pso_particles,
                                   .max_iterations = options.pso_max_iterations,
                                   .inertia_start = options.pso_inertia_start,
                                   .inertia_end = options.pso_inertia_end,
                                   .inertia_iterations = options.pso_inertia_iterations,
                                   .cognitive = options.pso_cognitive,
                                   .social = options.pso_social,
                                   .velocity_fraction = options.pso_velocity_fraction,
                                   .seed = options.seed},
                                  progress);
  result.weighting = Weighting::relative;
  result.model = swarm.model;
  result.iterations = swarm.iterations;
  result.best = swarm.best;
  result.status = swarm.converged ? FitResult::Status::converged : FitResult::Status::not_converged;
  result.warnings.insert(result.warnings.end(), swarm.notes.begin(), swarm.notes.end());
}

// λ -> λ + decay.
void take_out_decay(FitResult& result, double decay_per_s) {
  if (decay_per_s == 0.0) return;
  for (Mode& mode : result.model.modes) {
    const std::complex<double> lambda = pole(mode);
    const double left_over = -lambda.real() - decay_per_s;
    const double smallest = 1e-6 * std::abs(lambda);
    if (left_over < smallest) {
      result.warnings.push_back(fmt::format(
          "The mode at {:.1f} Hz decays no faster than the window: its damping is not known.", mode.frequency_hz));
    }
    const double omega = std::hypot(std::max(left_over, smallest), lambda.imag());
    mode.damping_ratio_std *= std::abs(lambda) / omega;
    mode.damping_ratio = std::max(left_over, smallest) / omega;
    mode.frequency_hz = omega / (2.0 * std::numbers::pi);
  }
}

}  // namespace

const char* to_string(FitBound bound) {
  switch (bound) {
    case FitBound::band_low:
      return "band_low_hz";
    case FitBound::band_high:
      return "band_high_hz";
    case FitBound::swarm_damping:
      return "pso_max_damping_ratio";
    case FitBound::damping:
      break;
  }
  return "max_damping_ratio";
}

std::vector<FitBound> FitResult::bounds_of(int mode) const {
  std::vector<FitBound> bounds;
  for (const ModeAtBound& at : at_bounds) {
    if (at.mode == mode) bounds.push_back(at.bound);
  }
  return bounds;
}

void FitOptions::validate() const {
  require_non_negative("band_low_hz", band_low_hz, "Hz");
  if (!(band_high_hz > band_low_hz)) {
    throw InvalidInput("band_high_hz", band_high_hz, "Hz",
                       fmt::format("must be above band_low_hz = {} Hz", band_low_hz));
  }
  require_between("modes", modes, 0, 200, "must lie between 0 (as many as the data shows) and 200");
  require_between("max_modes", max_modes, 1, 60, "must lie between 1 and 60");
  if (!(max_damping_ratio > 0.0 && max_damping_ratio < 1.0)) {
    throw InvalidInput("max_damping_ratio", max_damping_ratio, "", "must lie between 0 and 1",
                       "It is a ratio, not a percentage");
  }
  require_non_negative("exponential_decay_per_s", exponential_decay_per_s, "1/s");
  require_between("lscf_max_order", lscf_max_order, 2, 200, "must lie between 2 and 200");
  require_positive("stable_frequency", stable_frequency, "", "It is a share, not a percentage");
  require_positive("stable_damping", stable_damping, "", "It is a share, not a percentage");
  require_between("stable_mac", stable_mac, 0.0, 1.0, "must lie between 0 and 1");
  require_between("pso_particles", pso_particles, 2, 1e7, "must be at least 2");
  require_between("pso_max_iterations", pso_max_iterations, 1, 1e9, "must be at least 1");
  if (!(pso_frequency_half_width > 0.0 && pso_frequency_half_width < 1.0)) {
    throw InvalidInput("pso_frequency_half_width", pso_frequency_half_width, "", "must lie between 0 and 1");
  }
  if (!(pso_max_damping_ratio > 0.0 && pso_max_damping_ratio <= 1.0)) {
    throw InvalidInput("pso_max_damping_ratio", pso_max_damping_ratio, "", "must be above 0 and at most 1",
                       "It is a ratio, not a percentage");
  }
  require_between("pso_inertia_start", pso_inertia_start, 0.0, 1.0, "must lie between 0 and 1");
  require_between("pso_inertia_end", pso_inertia_end, 0.0, pso_inertia_start,
                  "must lie between 0 and pso_inertia_start");
  require_between("pso_inertia_iterations", pso_inertia_iterations, 1, 1e9, "must be at least 1");
  require_between("pso_cognitive", pso_cognitive, 0.0, 100.0, "must lie between 0 and 100");
  require_between("pso_social", pso_social, 0.0, 100.0, "must lie between 0 and 100");
  require_between("pso_velocity_fraction", pso_velocity_fraction, 0.0, 1.0, "must lie between 0 (no bound) and 1");
}

namespace {

/// The swarm sees some hundred lines, for each particle in each round; the poles every line, for each order and in each
/// step of their refinement.
void require_affordable_fit(const FrfSet& used, const FitOptions& options) {
  const auto lines = static_cast<double>(used.frequency_hz.size());
  const auto frfs = static_cast<double>(used.frfs.size());
  const double modes = options.modes > 0 ? options.modes : 8.0;
  if (options.method == FitMethod::pso) {
    constexpr double operations_of_value = 0.5, most_lines = 640.0, usual_particles = 400.0, usual_iterations = 8000.0;
    const double particles = options.pso_particles, iterations = options.pso_max_iterations;
    require_affordable(
        {.operations = operations_of_value * modes * std::min(lines, most_lines) * frfs * particles * iterations,
         .bytes = 100.0 * modes * particles + 8.0 * iterations,
         .dominant = dominant_of(
             {{.field = "pso_particles", .value = particles, .times_usual = particles / usual_particles},
              {.field = "pso_max_iterations", .value = iterations, .times_usual = iterations / usual_iterations}})});
    return;
  }
  constexpr double operations_of_order = 5.0, operations_of_mode = 5e3, bytes_of_order = 16.0;
  const double orders = options.lscf_max_order, values = lines * frfs;
  require_affordable({.operations = values * (operations_of_order * orders * orders + operations_of_mode * modes),
                      .bytes = values * bytes_of_order * orders,
                      .dominant = {.field = "frequency_hz", .value = lines, .unit = "lines"}});
}

}  // namespace

FitResult fit_modes(const FrfSet& set, const FitOptions& options, Progress& progress) {
  options.validate();
  set.validate();
  const FrfSet band = detail::cut_band(set, options.band_low_hz, options.band_high_hz);
  require_lines(band, options);
  FitResult result;
  result.lines = band.frequency_hz.size();
  result.band_low_hz = band.frequency_hz(0);
  result.band_high_hz = band.frequency_hz(result.lines - 1);
  const FrfSet used = without_zeros(band, result.warnings);
  require_affordable_fit(used, options);
  if (options.method == FitMethod::pso) {
    fit_by_swarm(result, used, options, progress);
  } else {
    progress.start("modal fit", detail::split(used).size());
    fit_by_poles(result, used, options, progress);
  }
  std::stable_sort(result.model.modes.begin(), result.model.modes.end(),
                   [](const Mode& a, const Mode& b) { return a.frequency_hz < b.frequency_hz; });
  if (result.model.modes.empty()) {
    result.status = FitResult::Status::not_converged;
    result.warnings.emplace_back("No mode stands out of the noise in the band.");
  }
  detail::set_errors(result, band);
  mark_weak_modes(result.model, band);
  detail::find_bounds(result, options);
  detail::add_warnings(result, band);
  take_out_decay(result, options.exponential_decay_per_s);
  return result;
}

}  // namespace robomill::modal
