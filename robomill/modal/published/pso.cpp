#include "robomill/modal/published/pso.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <set>
#include <span>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/modal/peaks.hpp"
#include "robomill/modal/published/pso_misfit.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;
using Positions = pagmo::vector_double;

constexpr double damping_margin = 1e-6;  // poles stay conjugate pairs that decay
constexpr double residue_margin =
    4.0;  // of the largest residue over that which a lone mode with the peak's height would have
constexpr double min_frequency_half_width = 0.01;
constexpr std::size_t max_picked_peaks = 20;
constexpr double poor_misfit = 0.2;   // a swarm that ends above it missed a mode
constexpr double good_misfit = 0.01;  // no mode more is looked for below it, …
constexpr double worthwhile = 0.8;    // … or where it does not bring the misfit below this share
constexpr int lines_of_a_peak = 15;
constexpr double half_widths_of_a_peak = 3.0;
constexpr std::size_t particles_per_block = 4;
constexpr double first_velocity_fraction = 0.1;  // of a range, where the velocity has no bound

/// One excitation's search: what is fitted, and what a particle's numbers mean. A mode has frequency [Hz], damping
/// ratio, and real and imaginary parts of left and of right's components in units of vector_scale.
struct Search {
  FrfSet frfs;  // at the lines that the swarm sees
  std::unique_ptr<detail::Misfit> misfit;
  std::vector<Peak> peaks;  // one a mode
  Positions lower, upper;
  std::vector<double> vector_scale;  // by mode [sqrt(s/kg)]

  [[nodiscard]] std::size_t unknowns_per_mode() const { return 4 + 2 * frfs.frfs.size(); }
  /// Whether the data has as many numbers as unknowns, with so many modes more.
  [[nodiscard]] bool determined(std::size_t more = 0) const {
    return (peaks.size() + more) * unknowns_per_mode() <= 2 * misfit->terms();
  }
  [[nodiscard]] static Complex component(const double* mode, std::size_t index) {
    return {mode[2 + 2 * index], mode[3 + 2 * index]};
  }
  [[nodiscard]] double evaluate(const double* position) const;
};

double Search::evaluate(const double* position) const {
  const std::size_t count = frfs.frfs.size();
  std::vector<Complex> residues(peaks.size() * count);
  std::vector<detail::MisfitMode> modes(peaks.size());
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const double* mode = position + k * unknowns_per_mode();
    const Complex left = vector_scale[k] * vector_scale[k] * component(mode, 0);
    for (std::size_t i = 0; i < count; ++i) residues[k * count + i] = left * component(mode, i + 1);
    modes[k] = {.frequency_hz = mode[0],
                .damping_ratio = mode[1],
                .residues = std::span<const Complex>(residues).subspan(k * count, count)};
  }
  return (*misfit)(modes);
}

/// pagmo's view of a search.
class ModalProblem {
 public:
  ModalProblem() = default;
  explicit ModalProblem(const Search& search) : search_(&search) {}
  [[nodiscard]] pagmo::vector_double fitness(const pagmo::vector_double& position) const {
    return {search_->evaluate(position.data())};
  }
  [[nodiscard]] pagmo::vector_double batch_fitness(const pagmo::vector_double& positions) const {
    const std::size_t size = search_->lower.size();
    pagmo::vector_double misfits(positions.size() / size);
    parallel_for(misfits.size(), particles_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) misfits[i] = search_->evaluate(positions.data() + i * size);
    });
    return misfits;
  }
  [[nodiscard]] std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    return {search_->lower, search_->upper};
  }

 private:
  const Search* search_ = nullptr;
};

/// The swarm with falling inertia, as a pagmo algorithm: evolve takes the first positions and gives back each
/// particle's best.
class FallingInertiaSwarm {
 public:
  FallingInertiaSwarm() = default;
  FallingInertiaSwarm(const PsoOptions& options, std::vector<Random>& streams, PsoRun& run, Progress& progress)
      : options_(&options), streams_(&streams), run_(&run), progress_(&progress) {}
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;

 private:
  struct Swarm {
    std::size_t size = 0;  // of one particle
    Positions position, velocity, own_best, own_misfit, max_velocity;
    std::size_t leader = 0;
  };
  void move(Swarm& swarm, double inertia, const Positions& lower, const Positions& upper) const;
  [[nodiscard]] bool stalled() const;

  const PsoOptions* options_ = nullptr;
  std::vector<Random>* streams_ = nullptr;  // one a particle
  PsoRun* run_ = nullptr;
  Progress* progress_ = nullptr;
};

void FallingInertiaSwarm::move(Swarm& swarm, double inertia, const Positions& lower, const Positions& upper) const {
  parallel_for(swarm.own_misfit.size(), particles_per_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t particle = begin; particle < end; ++particle) {
      Random& random = (*streams_)[particle];
      for (std::size_t d = 0; d < swarm.size; ++d) {
        const std::size_t i = particle * swarm.size + d;
        double& x = swarm.position[i];
        double& v = swarm.velocity[i];
        const double own_pull = options_->cognitive * random.uniform() * (swarm.own_best[i] - x);
        const double pull = options_->social * random.uniform() * (swarm.own_best[swarm.leader * swarm.size + d] - x);
        v = std::clamp(inertia * v + own_pull + pull, -swarm.max_velocity[d], swarm.max_velocity[d]);
        x += v;
        if (x < lower[d] || x > upper[d]) {
          x = std::clamp(x, lower[d], upper[d]);
          v = 0.0;
        }
      }
    }
  });
}

bool FallingInertiaSwarm::stalled() const {
  const std::size_t window = static_cast<std::size_t>(options_->stall_iterations);
  const std::vector<double>& best = run_->best;
  if (best.size() <= window) return false;
  const double before = best[best.size() - 1 - window];
  return before - best.back() <= options_->stall_tolerance * before;
}

pagmo::population FallingInertiaSwarm::evolve(pagmo::population population) const {
  const pagmo::problem& problem = population.get_problem();
  const auto [lower_bound, upper_bound] = problem.get_bounds();
  const Positions& lower = lower_bound;
  const Positions& upper = upper_bound;
  Swarm swarm;
  swarm.size = lower.size();
  const bool free = options_->velocity_fraction == 0.0;
  Positions first_velocity;
  for (std::size_t d = 0; d < swarm.size; ++d) {
    first_velocity.push_back((free ? first_velocity_fraction : options_->velocity_fraction) * (upper[d] - lower[d]));
    swarm.max_velocity.push_back(free ? std::numeric_limits<double>::infinity() : first_velocity[d]);
  }
  for (std::size_t particle = 0; particle < population.size(); ++particle) {
    const Positions& x = population.get_x()[particle];
    swarm.position.insert(swarm.position.end(), x.begin(), x.end());
    swarm.own_misfit.push_back(population.get_f()[particle][0]);
    for (const double limit : first_velocity) {
      swarm.velocity.push_back((*streams_)[particle].uniform(-limit, limit));
    }
  }
  swarm.own_best = swarm.position;
  const auto lead = [&] {
    const auto leader = std::ranges::min_element(swarm.own_misfit);
    swarm.leader = static_cast<std::size_t>(leader - swarm.own_misfit.begin());
    run_->best.push_back(*leader);
  };
  lead();
  for (int iteration = 1; iteration <= options_->max_iterations; ++iteration) {
    move(swarm, inertia(*options_, iteration), lower, upper);
    const Positions misfit = problem.batch_fitness(swarm.position);
    for (std::size_t particle = 0; particle < misfit.size(); ++particle) {
      if (!(misfit[particle] < swarm.own_misfit[particle])) continue;
      swarm.own_misfit[particle] = misfit[particle];
      const auto begin = static_cast<std::ptrdiff_t>(particle * swarm.size);
      std::copy_n(swarm.position.begin() + begin, swarm.size, swarm.own_best.begin() + begin);
    }
    lead();
    run_->iterations = iteration;
    progress_->advance();
    if (iteration >= options_->inertia_iterations && stalled()) {
      run_->stop = PsoRun::Stop::converged;
      break;
    }
  }
  for (std::size_t particle = 0; particle < swarm.own_misfit.size(); ++particle) {
    const auto begin = swarm.own_best.begin() + static_cast<std::ptrdiff_t>(particle * swarm.size);
    population.set_xf(particle, Positions(begin, begin + static_cast<std::ptrdiff_t>(swarm.size)),
                      {swarm.own_misfit[particle]});
  }
  return population;
}

/// `count` peaks to search at: the most prominent; or all, and what is over goes to the broadest, which are the
/// likeliest to hide more than one mode.
std::vector<Peak> share_peaks(std::vector<Peak> peaks, std::size_t count) {
  if (count < peaks.size()) {
    std::ranges::stable_sort(peaks, std::greater<>(), &Peak::prominence);
    peaks.resize(count);
  } else {
    std::vector<Peak> broadest = peaks;
    std::ranges::stable_sort(broadest, std::greater<>(), &Peak::damping_ratio);
    for (std::size_t i = 0; peaks.size() < count; ++i) peaks.push_back(broadest[i % broadest.size()]);
  }
  std::ranges::stable_sort(peaks, {}, &Peak::frequency_hz);
  return peaks;
}

/// As a share of the frequency: a picked peak's is its half-power half width, within bounds. A frequency that somebody
/// names need not be at a peak, so that its flanks show nothing.
double frequency_half_width(const Peak& peak, const PsoOptions& options) {
  if (!options.peaks_hz.empty()) return options.frequency_half_width;
  return std::clamp(peak.damping_ratio, std::min(min_frequency_half_width, options.frequency_half_width),
                    options.frequency_half_width);
}

/// The lines that the swarm sees, by rising frequency.
std::vector<Eigen::Index> choose_lines(const Eigen::VectorXd& frequency_hz, const std::vector<Peak>& peaks, int count) {
  std::vector<Eigen::Index> lines;
  if (count == 0 || frequency_hz.size() <= count) {
    for (Eigen::Index i = 0; i < frequency_hz.size(); ++i) lines.push_back(i);
    return lines;
  }
  const auto add = [&](double wanted_hz) {
    const auto at = std::lower_bound(frequency_hz.begin(), frequency_hz.end(), wanted_hz);
    if (at != frequency_hz.end()) lines.push_back(at - frequency_hz.begin());
  };
  const auto lowest = std::ranges::find_if(frequency_hz, [](double f) { return f > 0.0; });
  const double ratio = frequency_hz(frequency_hz.size() - 1) / *lowest;
  for (int i = 0; i < count; ++i) add(*lowest * std::pow(ratio, static_cast<double>(i) / count));
  for (const Peak& peak : peaks) {
    const double reach = half_widths_of_a_peak * peak.damping_ratio * peak.frequency_hz;
    for (int i = 0; i < lines_of_a_peak; ++i) {
      add(peak.frequency_hz + reach * (2.0 * i / (lines_of_a_peak - 1) - 1.0));
    }
  }
  std::ranges::sort(lines);
  // std::ranges::unique does not compile with clang 14 and libstdc++ 12.
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return lines;
}

std::vector<Peak> find_peaks(const FrfSet& frfs, const std::vector<const Frf*>& measured, const Dof& excitation,
                             const PsoOptions& options) {
  std::vector<Peak> peaks;
  for (const double frequency_hz : options.peaks_hz)
    peaks.push_back(peak_at(frequency_hz, frfs.frequency_hz, measured));
  if (options.peaks_hz.empty()) {
    peaks = pick_peaks(frfs.frequency_hz, measured);
    if (peaks.size() > max_picked_peaks) peaks = share_peaks(std::move(peaks), max_picked_peaks);
  }
  if (peaks.empty()) {
    throw InvalidInput("frfs",
                       "show no peak for a force in " + to_string(excitation, true) + " that stands out of the noise",
                       "Widen the band, or name the frequencies to look at");
  }
  return peaks;
}

void set_bounds(Search& search, const PsoOptions& options) {
  for (const Peak& peak : search.peaks) {
    const double omega = 2.0 * std::numbers::pi * peak.frequency_hz;
    // |H| = |residue| / (ζ ω) at the resonance of a lone mode.
    search.vector_scale.push_back(std::sqrt(residue_margin * peak.receptance * peak.damping_ratio * omega));
    const double half_width = frequency_half_width(peak, options);
    search.lower.insert(search.lower.end(), {peak.frequency_hz * (1.0 - half_width), damping_margin});
    search.upper.insert(search.upper.end(),
                        {peak.frequency_hz * (1.0 + half_width), options.max_damping_ratio - damping_margin});
    search.lower.insert(search.lower.end(), search.unknowns_per_mode() - 2, -1.0);
    search.upper.insert(search.upper.end(), search.unknowns_per_mode() - 2, 1.0);
  }
}

/// @param modes  0: one a peak
Search plan_search(const FrfSet& frfs, const Dof& excitation, std::size_t modes, const PsoOptions& options) {
  std::vector<const Frf*> measured;
  for (const Frf& frf : frfs.frfs) {
    if (frf.name.excitation == excitation) measured.push_back(&frf);
  }
  std::vector<Peak> peaks = find_peaks(frfs, measured, excitation, options);
  Search search;
  const std::vector<Eigen::Index> lines = choose_lines(frfs.frequency_hz, peaks, options.lines);
  search.frfs.frequency_hz = frfs.frequency_hz(lines);
  for (const Frf* frf : measured) search.frfs.frfs.push_back({.name = frf->name, .receptance = frf->receptance(lines)});
  std::vector<const Frf*> seen;
  for (const Frf& frf : search.frfs.frfs) seen.push_back(&frf);
  search.misfit = std::make_unique<detail::Misfit>(search.frfs.frequency_hz, seen);
  const std::size_t wanted = modes == 0 ? peaks.size() : modes;
  search.peaks = share_peaks(std::move(peaks), wanted);
  if (!search.determined()) {
    throw InvalidInput("modes", static_cast<double>(search.peaks.size()), "modes",
                       "have more unknowns (" + std::to_string(search.peaks.size() * search.unknowns_per_mode()) +
                           ") than the FRFs of one excitation have numbers (" +
                           std::to_string(2 * search.misfit->terms()) + ")");
  }
  set_bounds(search, options);
  return search;
}

/// What one excitation's swarm found.
struct Found {
  Search search;
  PsoRun run;
  Positions best;
};

Found search_modes(Search planned, const PsoOptions& options, std::uint64_t first_stream, Progress& progress) {
  Found found{.search = std::move(planned), .run = {}, .best = {}};
  const Search& search = found.search;
  for (const Peak& peak : search.peaks) found.run.peaks_hz.push_back(peak.frequency_hz);
  found.run.terms = search.misfit->terms();
  std::vector<Random> streams;
  Positions positions;
  for (std::uint64_t particle = 0; particle < static_cast<std::uint64_t>(options.particles); ++particle) {
    streams.emplace_back(options.seed, first_stream + particle);
    for (std::size_t d = 0; d < search.lower.size(); ++d) {
      positions.push_back(streams.back().uniform(search.lower[d], search.upper[d]));
    }
  }
  const pagmo::problem problem{ModalProblem(search)};
  const Positions misfits = problem.batch_fitness(positions);
  pagmo::population population{problem, 0U, 0U};
  for (std::size_t particle = 0; particle < misfits.size(); ++particle) {
    const auto begin = positions.begin() + static_cast<std::ptrdiff_t>(particle * search.lower.size());
    population.push_back(Positions(begin, begin + static_cast<std::ptrdiff_t>(search.lower.size())),
                         {misfits[particle]});
  }
  const pagmo::algorithm swarm{FallingInertiaSwarm(options, streams, found.run, progress)};
  found.best = swarm.evolve(population).champion_x();
  return found;
}

/// With the number of modes left to the data: one more as long as that pays.
Found search_excitation(const FrfSet& frfs, const Dof& excitation, std::size_t modes, const PsoOptions& options,
                        std::uint64_t first_stream, Progress& progress) {
  const auto swarm = [&](std::size_t count) {
    Found found = search_modes(plan_search(frfs, excitation, count, options), options, first_stream, progress);
    found.run.excitation = excitation;
    return found;
  };
  Found found = swarm(modes);
  if (modes > 0 || !options.peaks_hz.empty()) return found;
  while (found.run.best.back() > good_misfit && found.search.determined(1)) {
    Found larger = swarm(found.search.peaks.size() + 1);
    if (larger.run.best.back() > worthwhile * found.run.best.back()) break;
    found = std::move(larger);
  }
  return found;
}

void add_modes(const Found& found, std::size_t excitation, ModalModel& model) {
  const Search& search = found.search;
  for (std::size_t k = 0; k < search.peaks.size(); ++k) {
    const double* values = found.best.data() + k * search.unknowns_per_mode();
    Mode mode;
    mode.frequency_hz = values[0];
    mode.damping_ratio = values[1];
    mode.left = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(model.excitations.size()));
    mode.right = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(model.responses.size()));
    mode.left(static_cast<Eigen::Index>(excitation)) = search.vector_scale[k] * Search::component(values, 0);
    for (std::size_t i = 0; i < search.frfs.frfs.size(); ++i) {
      const auto response = std::ranges::find(model.responses, search.frfs.frfs[i].name.response);
      mode.right(response - model.responses.begin()) = search.vector_scale[k] * Search::component(values, i + 1);
    }
    normalise(mode);
    model.modes.push_back(std::move(mode));
  }
}

void join_curves(PsoResult& result) {
  double all = 0.0;
  result.converged = true;
  for (const PsoRun& run : result.runs) {
    all += static_cast<double>(run.terms);
    result.iterations = std::max(result.iterations, run.iterations);
    result.converged = result.converged && run.stop == PsoRun::Stop::converged;
  }
  result.best.assign(static_cast<std::size_t>(result.iterations) + 1, 0.0);
  for (const PsoRun& run : result.runs) {
    for (std::size_t t = 0; t < result.best.size(); ++t) {
      result.best[t] += static_cast<double>(run.terms) / all * run.best[std::min(t, run.best.size() - 1)];
    }
  }
}

void add_notes(const FrfSet& frfs, PsoResult& result) {
  if (result.runs.size() > 1) {
    result.notes.push_back(
        "Each excitation was fitted on its own: a mode that several excite stands in the list once for each of them.");
  }
  for (const PsoRun& run : result.runs) {
    if (run.best.back() <= poor_misfit) continue;
    result.notes.push_back(fmt::format(
        "The swarm for forces in {} ended {:.0f} % off on average, which is no fit: try another seed, or the "
        "hybrid method.",
        to_string(run.excitation, true), 100.0 * run.best.back()));
  }
  Eigen::Index zeros = 0;
  for (const Frf& frf : frfs.frfs) zeros += (frf.receptance.array() == 0.0).count();
  if (zeros > 0) {
    result.notes.push_back(
        std::to_string(zeros) +
        " lines where the receptance is zero were left out: the relative misfit has no value there.");
  }
}

void require_between(const char* field, double number, double low, double high) {
  if (!(number >= low && number <= high)) {
    throw InvalidInput(field, number, "", "must lie in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
  }
}

void require_at_least(const char* field, int number, int low) {
  if (number < low) throw InvalidInput(field, number, "", "must be >= " + std::to_string(low));
}

}  // namespace

double inertia(const PsoOptions& options, int iteration) {
  const int over = std::min(options.inertia_iterations, options.max_iterations);
  const double fraction = over == 1 ? 1.0 : std::min(1.0, static_cast<double>(iteration - 1) / (over - 1));
  return options.inertia_start + (options.inertia_end - options.inertia_start) * fraction;
}

void PsoOptions::validate() const {
  require_at_least("modes", modes, 0);
  for (const double peak_hz : peaks_hz) require_positive("peaks_hz", peak_hz, "Hz");
  if (!(frequency_half_width > 0.0 && frequency_half_width < 1.0)) {
    throw InvalidInput("frequency_half_width", frequency_half_width, "", "must lie between 0 and 1",
                       "It is a share of the peak's frequency");
  }
  if (!(max_damping_ratio > 0.0 && max_damping_ratio <= 1.0)) {
    throw InvalidInput("max_damping_ratio", max_damping_ratio, "", "must be above 0 and at most 1",
                       "It is a ratio, not a percentage");
  }
  if (lines != 0) require_at_least("lines", lines, 20);
  require_at_least("particles", particles, 2);
  require_at_least("max_iterations", max_iterations, 1);
  require_between("inertia_start", inertia_start, 0.0, 1.0);
  require_at_least("inertia_iterations", inertia_iterations, 1);
  require_between("inertia_end", inertia_end, 0.0, inertia_start);
  require_between("cognitive", cognitive, 0.0, 100.0);
  require_between("social", social, 0.0, 100.0);
  require_between("velocity_fraction", velocity_fraction, 0.0, 1.0);
  require_at_least("stall_iterations", stall_iterations, 1);
  require_non_negative("stall_tolerance", stall_tolerance, "");
}

PsoResult fit_pso(const FrfSet& frfs, const PsoOptions& options, Progress& progress) {
  options.validate();
  frfs.validate();
  PsoResult result;
  std::set<Dof> excitations;
  std::set<Dof> responses;
  for (const Frf& frf : frfs.frfs) {
    excitations.insert(frf.name.excitation);
    responses.insert(frf.name.response);
  }
  result.model.excitations.assign(excitations.begin(), excitations.end());
  result.model.responses.assign(responses.begin(), responses.end());
  const std::size_t runs = excitations.size();
  const std::size_t modes = static_cast<std::size_t>(options.modes);
  if (modes != 0 && modes < runs) {
    throw InvalidInput("modes", options.modes, "",
                       "must be at least one for each of the " + std::to_string(runs) + " excitations",
                       "Particle swarms fit every excitation with modes of its own");
  }
  for (const double peak_hz : options.peaks_hz) {
    if (peak_hz < frfs.frequency_hz(0) || peak_hz > frfs.frequency_hz(frfs.frequency_hz.size() - 1)) {
      throw InvalidInput("peaks_hz", peak_hz, "Hz", "must lie in the band of the FRFs");
    }
  }
  progress.start("particle swarm", runs * static_cast<std::size_t>(options.max_iterations));
  for (std::size_t i = 0; i < runs; ++i) {
    const std::uint64_t first_stream = static_cast<std::uint64_t>(i) * static_cast<std::uint64_t>(options.particles);
    const Found found = search_excitation(frfs, result.model.excitations[i], modes / runs + (i < modes % runs ? 1 : 0),
                                          options, first_stream, progress);
    result.runs.push_back(found.run);
    add_modes(found, i, result.model);
  }
  std::ranges::stable_sort(result.model.modes, {}, &Mode::frequency_hz);
  join_curves(result);
  add_notes(frfs, result);
  return result;
}

}  // namespace robomill::modal
