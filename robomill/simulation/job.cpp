#include "robomill/simulation/job.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/simulation/engine.hpp"
#include "robomill/simulation/resample.hpp"
#include "robomill/simulation/verdict.hpp"
#include "robomill/simulation/wall.hpp"

namespace robomill::simulation::detail {
namespace {

using std::numbers::pi;

constexpr double diverged_m = 1.0;
constexpr Eigen::Index phases = 8;           // looked at in a period
constexpr std::int64_t check_every = 20000;  // steps between looks at Ctrl-C

/// Two dimensions: x and y of the feed's frame.
template <int D>
Eigen::Vector3d in_feed_frame(const Eigen::Matrix3d& feed_from_tool, const Vector<D>& v) {
  if constexpr (D == 2) return {v(0), v(1), 0.0};
  if constexpr (D == 3) return feed_from_tool * v;
}

/// ---------------------------------------------------------------- small vibration

/// The largest multiplier at one resolution.
struct Multiplier {
  std::complex<double> value = 0.0;
  bool converged = false;
};

template <int D>
Multiplier multiplier_at(const CutModel& model, const modal::TipModes& structure, int period_steps, std::uint64_t seed,
                         Progress& progress) {
  constexpr int most_blocks = 40;
  constexpr double tolerance = 1e-7;
  Engine<D> engine(model, structure, Physics::perturbation);
  Random random(seed);
  for (std::size_t k = 0; k < engine.modes(); ++k) engine.set_mode(k, {random.normal(), random.normal()});
  const Eigen::Index columns = std::min<Eigen::Index>(2 * structure.pole.size() + 10, 60);
  const Eigen::Index looks = std::max<Eigen::Index>(16, columns);
  Eigen::MatrixXd snapshots(looks * D, columns);
  Multiplier found;
  for (int block = 0; block < most_blocks; ++block) {
    for (Eigen::Index c = 0; c < columns; ++c) {
      Eigen::Index look = 0;
      for (int i = 1; i <= period_steps; ++i) {
        engine.step();
        while (look < looks && (look + 1) * period_steps <= i * looks) {
          snapshots.block<D, 1>(D * look++, c) = engine.displacement();
        }
      }
      progress.check();
    }
    const double size = snapshots.rightCols(1).norm();
    const std::complex<double> value = dominant_multiplier(snapshots);
    found.converged = std::abs(std::abs(value) - std::abs(found.value)) <= tolerance * std::max(1.0, std::abs(value));
    found.value = value;
    if (block > 0 && found.converged) break;
    if (!(size > 0.0) || !std::isfinite(size)) break;
    engine.scale(1.0 / size);
  }
  return found;
}

/// ---------------------------------------------------------------- resolution

/// Relative difference of the displacements over the first revolutions, of the finer one's error by order two.
template <int D>
double error_at(const CutModel& coarse_model, const CutModel& fine_model, const modal::TipModes& structure,
                Physics physics, double seconds) {
  constexpr double trial_revolutions = 8.0;
  Engine<D> coarse(coarse_model, structure, physics);
  Engine<D> fine(fine_model, structure, physics);
  const double turns = std::min(trial_revolutions, seconds * coarse_model.spindle.mean_rad_per_s / (2.0 * pi));
  const auto steps = static_cast<std::int64_t>(std::max(1.0, turns * coarse_model.steps_per_revolution));
  double difference = 0.0, size = 0.0;
  for (std::int64_t i = 0; i < steps; ++i) {
    coarse.step();
    fine.step();
    fine.step();
    difference += (coarse.displacement() - fine.displacement()).squaredNorm();
    size += fine.displacement().squaredNorm();
  }
  return size > 0.0 ? std::sqrt(difference / size) / 3.0 : 0.0;
}

struct Chosen {
  Resolution resolution;
  double error = 0.0;
};

template <int D, class MakeModel>
Chosen choose(const Resolution& first, const modal::TipModes& structure, const MakeModel& make_model, Physics physics,
              const SimulationOptions& options, Progress& progress) {
  constexpr int most_doublings = 5;
  Chosen chosen = {first, 0.0};
  if (structure.pole.size() == 0) return chosen;
  for (int i = 0;; ++i) {
    progress.check();
    const bool odd = chosen.resolution.steps_per_revolution % 2 != 0;
    const Resolution coarse = odd ? chosen.resolution : halved(chosen.resolution);
    const Resolution fine = odd ? doubled(chosen.resolution) : chosen.resolution;
    chosen.error = error_at<D>(make_model(coarse), make_model(fine), structure, physics, options.seconds);
    if (options.steps_per_revolution > 0 || chosen.error <= options.tolerance || i == most_doublings) return chosen;
    chosen.resolution = doubled(chosen.resolution);
  }
}

/// ---------------------------------------------------------------- the run

/// What the run keeps beside the output: once-a-period samples, and the motion of the last half for its spectrum.
struct Watch {
  Watch(std::int64_t steps, int period_steps, int dimensions) : period(period_steps) {
    constexpr std::int64_t longest = std::int64_t{1} << 20;
    const std::int64_t kept = std::min({steps - steps / 2, longest, steps});
    motion.resize(static_cast<Eigen::Index>(kept), dimensions);
    from = steps - kept;
    samples.resize(phases * dimensions, static_cast<Eigen::Index>(steps / period));
  }
  template <int D>
  void look(std::int64_t step, const Vector<D>& q) {  // step from 0
    const Eigen::Index column = static_cast<Eigen::Index>(step / period);
    const std::int64_t within = step % period;
    if (column < samples.cols()) {
      const std::int64_t before = within * phases / period;
      const std::int64_t now = (within + 1) * phases / period;
      for (std::int64_t p = before; p < now; ++p) samples.block<D, 1>(static_cast<Eigen::Index>(p) * D, column) = q;
    }
    if (step >= from && step - from < motion.rows()) {
      motion.row(static_cast<Eigen::Index>(step - from)) = q.transpose();
    }
  }
  std::int64_t period, from = 0;
  Eigen::MatrixXd samples, motion;
};

void add_wall(double angle, double feed_per_tooth_m, int rings, const std::vector<WallPass>& passes, Simulation& out) {
  Wall wall;
  wall.angle_rad = angle;
  std::vector<std::vector<WallPass>> of_ring(static_cast<std::size_t>(rings));
  for (const WallPass& pass : passes) of_ring[static_cast<std::size_t>(pass.ring)].push_back(pass);
  int heights = 0;
  for (const std::vector<WallPass>& ring : of_ring) {
    const WallLine line = wall_line(ring, feed_per_tooth_m);
    if (line.out_m.empty()) continue;
    const Roughness r = roughness(line);
    wall.least_location_error_m = heights == 0 ? -r.mean_m : std::min(wall.least_location_error_m, -r.mean_m);
    wall.greatest_location_error_m = heights == 0 ? -r.mean_m : std::max(wall.greatest_location_error_m, -r.mean_m);
    wall.location_error_m -= r.mean_m;
    wall.ra_m = std::max(wall.ra_m, r.ra_m);
    wall.rz_m = std::max(wall.rz_m, r.rz_m);
    ++heights;
  }
  if (heights == 0) return;
  wall.location_error_m /= heights;
  out.walls.push_back(wall);
}

/// Whether the last half of the time, at which verdicts look, repeats with the period of the full speed.
bool repeats_at_end(const Schedule& schedule, double seconds) {
  return schedule.constant_after(0.5 * seconds) && Profile(schedule.speed).at(seconds) == 1.0;
}

template <int D>
void run(const Job& job, const SimulationOptions& options, Progress& progress, Simulation& out) {
  const Physics physics = !options.regeneration     ? Physics::forced
                          : options.loss_of_contact ? Physics::full
                                                    : Physics::linear;
  const Chosen chosen = choose<D>(job.first, job.structure, job.model_at, physics, options, progress);
  out.steps_per_revolution = chosen.resolution.steps_per_revolution;
  out.error_estimate = chosen.error;
  out.resolved = chosen.error <= options.tolerance;
  CutModel model = job.model_at(chosen.resolution);
  model.depth = Profile(job.schedule.depth);
  model.spindle.schedule = Profile(job.schedule.speed);
  out.slices = model.slices;
  Engine<D> engine(model, job.structure, physics);
  const double h = engine.step_s();
  Resampler resampler(h, options.sample_rate_hz,
                      static_cast<Eigen::Index>(std::floor(options.seconds * options.sample_rate_hz + 1e-9)), D);
  const auto steps = static_cast<std::int64_t>(options.seconds / h);
  const std::int64_t all = steps + static_cast<std::int64_t>(resampler.reach()) + 4;
  const double half_turns = 0.5 * options.seconds * job.spindle_speed_rad_per_s / (2.0 * pi);
  for (const double angle : job.walls) {
    engine.watch_wall(angle, static_cast<std::size_t>(half_turns) * model.elements.size() + 1);
  }
  Watch watch(steps, job.period.steps(out.steps_per_revolution), D);
  progress.start("simulating", static_cast<std::size_t>(all));
  resampler.push(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  std::int64_t missed = 0;
  for (std::int64_t i = 0; i < all; ++i) {
    engine.step();
    const Eigen::Vector3d q = in_feed_frame<D>(job.feed_from_tool, engine.displacement());
    resampler.push(q, in_feed_frame<D>(job.feed_from_tool, engine.mean_force()));
    if (i < steps) {
      watch.look<D>(i, q.head<D>());
      missed = engine.steps_without_contact();
      out.vibrating_peak_force_n = std::max(out.vibrating_peak_force_n, engine.mean_force().norm());
    }
    if ((i + 1) % check_every == 0) progress.advance(check_every);
    if (!(q.squaredNorm() < diverged_m * diverged_m)) {
      out.diverged = true;
      break;
    }
  }
  const Eigen::Index rows = resampler.rows_done();
  out.displacement_m = resampler.displacement_m.topRows(rows);
  out.acceleration_m_per_s2 = resampler.acceleration_m_per_s2.topRows(rows);
  out.force_n = resampler.force_n.topRows(rows);
  out.missed_share = static_cast<double>(missed) / static_cast<double>(std::max<std::int64_t>(steps, 1));
  if (out.diverged) {
    out.verdict = Verdict::chatter;
    return;
  }
  if (!repeats_at_end(job.schedule, options.seconds)) return;
  // Small vibration is that of the full depth, which the cut need not have come to.
  const SmallVibration unknown = {.status = SmallVibration::Status::not_converged};
  const Judgement judgement = judge(watch.samples, job.schedule.active() ? unknown : out.small);
  out.verdict = judgement.verdict;
  out.growth_per_period = judgement.growth_per_period;
  if (out.verdict == Verdict::chatter) {
    const int repeat = job.period.repeats ? job.period.revolutions * out.steps_per_revolution : 0;
    const SpectralLine line = strongest_line(watch.motion, repeat, 1.0 / h);
    out.chatter_frequency_hz = line.frequency_hz;
    out.chatter_amplitude_m = line.amplitude_m;
  }
  for (std::size_t w = 0; w < job.walls.size(); ++w) {
    add_wall(job.walls[w], job.feed_per_tooth_m, static_cast<int>(model.rings.size()), engine.wall_passes(w), out);
  }
}

/// ---------------------------------------------------------------- what it takes

/// A step of time in operations, by README.md's "Cost".
double operations_of_step(const Job& job, std::size_t elements) {
  return 100.0 + 12.0 * static_cast<double>(job.structure.pole.size()) + 30.0 * static_cast<double>(elements);
}

/// The first multipliers, at two resolutions; they need a few blocks of columns.
double operations_of_small_vibration(const Job& job, std::size_t elements) {
  constexpr double resolutions = 1.0 + 2.0, blocks = 4.0;
  const double columns = std::min(2.0 * static_cast<double>(job.structure.pole.size()) + 10.0, 60.0);
  const double steps = job.period.repeats ? job.period.steps(job.first.steps_per_revolution) : 0.0;
  return resolutions * blocks * columns * steps * operations_of_step(job, elements);
}

/// What decides how fine the steps are, or how many there are.
CostDriver dominant_driver(const Job& job, const SimulationOptions& options) {
  constexpr double usual_s = 2.0, usual_rate_hz = 10240.0, usual_hz = 1000.0, usual_rad_per_s = 400.0,
                   usual_steps = 2000.0;
  double fastest = 0.0;
  for (const std::complex<double>& pole : job.structure.pole) fastest = std::max(fastest, std::abs(pole));
  const double steps_per_revolution = options.steps_per_revolution;
  return dominant_of(
      {{.field = "seconds", .value = options.seconds, .unit = "s", .times_usual = options.seconds / usual_s},
       {.field = "sample_rate_hz",
        .value = options.sample_rate_hz,
        .unit = "Hz",
        .times_usual = options.sample_rate_hz / usual_rate_hz},
       {.field = "frequency_hz",
        .value = fastest / (2.0 * pi),
        .unit = "Hz",
        .times_usual = fastest / (2.0 * pi) / usual_hz},
       {.field = "steps_per_revolution",
        .value = steps_per_revolution,
        .times_usual = steps_per_revolution / usual_steps},
       {.field = "spindle_speed_rad_per_s",
        .value = job.spindle_speed_rad_per_s,
        .unit = "rad/s",
        .times_usual = usual_rad_per_s / job.spindle_speed_rad_per_s}});
}

/// @param run  the motion over all the time too, else its small vibration alone
Cost cost_of(const Job& job, const SimulationOptions& options, bool run) {
  const CutModel model = job.model_at(job.first);
  const double steps_per_revolution = job.first.steps_per_revolution;
  const std::size_t elements = model.elements.size();
  // A node of a ring's surface, its sine and cosine.
  constexpr double bytes_of_node = 40.0;
  Cost cost = {.operations = operations_of_small_vibration(job, elements),
               .bytes = 2.0 * steps_per_revolution * bytes_of_node * static_cast<double>(model.rings.size()),
               .dominant = dominant_driver(job, options)};
  if (!run) return cost;
  // Steps are doubled once in most cuts. A sample has nine numbers, here and in the result, and its line of a file; a
  // period leaves its looks, a tooth its pass of a wall.
  constexpr double doubled_steps = 2.0, bytes_of_sample = 260.0, bytes_of_pass = 40.0;
  const double revolutions = options.seconds * job.spindle_speed_rad_per_s / (2.0 * pi);
  const double periods = revolutions * job.period.parts / job.period.revolutions;
  cost.operations += doubled_steps * revolutions * steps_per_revolution * operations_of_step(job, elements);
  cost.bytes += options.seconds * options.sample_rate_hz * bytes_of_sample +
                periods * static_cast<double>(phases * model.dimensions) * sizeof(double) +
                0.5 * revolutions * static_cast<double>(elements * job.walls.size()) * bytes_of_pass;
  return cost;
}

}  // namespace

SmallVibration small_vibration(const Job& job, const SimulationOptions& options, Progress& progress) {
  SmallVibration small;
  if (job.structure.pole.size() == 0) return small;
  small.status = SmallVibration::Status::not_periodic;
  if (!job.period.repeats) return small;
  require_affordable(cost_of(job, options, false));
  small.period_s = 2.0 * pi / job.spindle_speed_rad_per_s * job.period.revolutions / job.period.parts;
  std::array<Multiplier, 2> found;
  Resolution resolution = job.first;
  for (Multiplier& m : found) {
    const CutModel model = job.model_at(resolution);
    const int steps = job.period.steps(resolution.steps_per_revolution);
    m = model.dimensions == 3 ? multiplier_at<3>(model, job.structure, steps, options.seed, progress)
                              : multiplier_at<2>(model, job.structure, steps, options.seed, progress);
    resolution = doubled(resolution);
  }
  const double coarse = std::abs(found[0].value), fine = std::abs(found[1].value);
  small.multiplier = found[1].value;
  small.spectral_radius = std::max(0.0, fine + (fine - coarse) / 3.0);
  small.error_estimate = std::abs(fine - coarse) / 3.0;
  const bool converged = found[0].converged && found[1].converged && std::isfinite(fine);
  small.status = converged ? SmallVibration::Status::found : SmallVibration::Status::not_converged;
  return small;
}

Simulation simulate(const Job& job, const SimulationOptions& options, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  require_affordable(cost_of(job, options, true));
  Simulation out;
  out.sample_rate_hz = options.sample_rate_hz;
  out.small = small_vibration(job, options, progress);
  out.period_s = 2.0 * pi / job.spindle_speed_rad_per_s * job.period.revolutions / job.period.parts;
  if (job.model_at(job.first).dimensions == 3) {
    run<3>(job, options, progress, out);
  } else {
    run<2>(job, options, progress, out);
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

void require_damped(const modal::TipModes& structure) {
  const Eigen::Index n = structure.pole.size();
  if (structure.right.cols() != n || structure.left.cols() != n) {
    throw InvalidInput("structure", "must have one left and one right vector for each pole");
  }
  if (!structure.pole.allFinite() || !structure.right.allFinite() || !structure.left.allFinite() ||
      !structure.compliance.allFinite()) {
    throw InvalidInput("structure", "must hold finite numbers only");
  }
  for (const std::complex<double>& pole : structure.pole) {
    if (!(pole.real() < 0.0)) {
      throw InvalidInput("structure.pole", pole.real(), "rad/s", "must have a negative real part",
                         "A structure that is unstable without cutting cannot be judged in a cut");
    }
  }
}

}  // namespace robomill::simulation::detail
