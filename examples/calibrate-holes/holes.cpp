#include "examples/calibrate-holes/holes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/modal/tip.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::examples {
namespace {

using simulation::DrillingCut;
using std::numbers::pi;
using Columns = simulation::Simulation::Columns;

constexpr Eigen::Index idle = 3072;   ///< samples before and after the cut
constexpr Eigen::Index window = 512;  ///< over which an amplitude is taken
constexpr double core_share = 0.1;    ///< of the drill's diameter, without lips
constexpr double most_displacement_m = 2e-3;

/// A feed in turn with a speed at which a turn takes 0.02 to 0.2 mm.
void draw_speed(Hole& hole, Random& random) {
  double per_turn_m = 0.0;
  do {
    hole.cut.spindle_speed_rad_per_s = random.uniform(1200.0, 4500.0) * pi / 30.0;
    hole.feed_m_per_s = 0.9e-3 * std::pow(9.6 / 0.9, random.uniform());
    per_turn_m = hole.feed_m_per_s * 2.0 * pi / hole.cut.spindle_speed_rad_per_s;
  } while (per_turn_m < 2e-5 || per_turn_m > 2e-4);
  hole.cut.feed_per_revolution_m = per_turn_m;
}

/// The point goes in until the lips cut over their whole width, then the hole goes on for half a second.
void plan_drilled(Hole& hole, double diameter_m) {
  hole.kind = "drilled";
  hole.cut.diameter_m = diameter_m;
  hole.cut.radial_width_m = (0.5 - core_share) * diameter_m;
  const double entry_s = hole.cut.radial_width_m / std::tan(0.5 * hole.cut.point_angle_rad) / hole.feed_m_per_s;
  const double through_s = 0.02 + entry_s + 0.5;
  hole.cut.schedule.depth = {{0.02, 0.0}, {0.02 + entry_s, 1.0}, {through_s, 1.0}, {through_s + 0.1, 0.0}};
  hole.seconds = through_s + 0.15;
}

/// A point of 90 degrees widens the hole's rim as fast as it goes in, stays for 0.2 s and goes back.
void plan_countersunk(Hole& hole, double hole_m, Random& random) {
  hole.kind = "countersunk";
  hole.cut.point_angle_rad = 0.5 * pi;
  hole.cut.radial_width_m = random.uniform(1.2e-3, 2.4e-3);
  hole.cut.diameter_m = hole_m + 2.0 * hole.cut.radial_width_m;
  const double end_s = 0.02 + hole.cut.radial_width_m / hole.feed_m_per_s;
  hole.cut.schedule.depth = {{0.02, 0.0}, {end_s, 1.0}, {end_s + 0.2, 1.0}, {end_s + 0.22, 0.0}};
  hole.seconds = end_s + 0.27;
}

/// Material, runout and how stiff the robot stands.
void draw_setup(Hole& hole, Random& random) {
  const double kt = random.uniform(600e6, 1000e6);
  hole.cut.coefficients = {.tangential_n_per_m2 = kt,
                           .radial_n_per_m2 = kt * random.uniform(0.3, 0.5),
                           .tangential_edge_n_per_m = random.uniform(2e3, 8e3),
                           .radial_edge_n_per_m = random.uniform(2e3, 8e3)};
  hole.cut.structure = modal::tip_modes(data::robot_modes(), {}, random.uniform(0.0, 2.0 * pi));
  // A foot presses the robot against the part.
  const double stiffer = 8.0 * std::pow(60.0 / 8.0, random.uniform());
  hole.cut.structure.right /= stiffer;
  hole.cut.structure.compliance /= stiffer;
  hole.cut.runout_m = random.uniform(2e-6, 1e-5);
}

Hole draw(std::uint64_t index, Random& random) {
  Hole hole;
  draw_speed(hole, random);
  draw_setup(hole, random);
  const double drill_m = index / 2 % 2 == 0 ? 6e-3 : 5e-3;
  if (index % 2 == 0) {
    plan_drilled(hole, drill_m);
  } else {
    plan_countersunk(hole, drill_m, random);
  }
  return hole;
}

simulation::Simulation run(const DrillingCut& cut, double seconds, bool regeneration) {
  const double steps = 4.0 * hole_rate_hz * 2.0 * pi / cut.spindle_speed_rad_per_s;
  return simulation::simulate(cut, {.seconds = seconds,
                                    .sample_rate_hz = hole_rate_hz,
                                    .regeneration = regeneration,
                                    .steps_per_revolution = cut.lips * static_cast<int>(std::ceil(steps / cut.lips))});
}

/// Root mean square over both channels and the window that ends at each sample.
std::vector<double> amplitudes(const Columns& x) {
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(x.rows()));
  double sum = 0.0;
  for (Eigen::Index m = 0; m < x.rows(); ++m) {
    sum += x.row(m).head<2>().squaredNorm();
    if (m >= window) sum -= x.row(m - window).head<2>().squaredNorm();
    out.push_back(std::sqrt(std::max(0.0, sum) / (2.0 * window)));
  }
  return out;
}

/// Whether it is clear what the hole does; sets chatter and onset.
/// @param alone   the cut with a twentieth of the runout: what vibrates as much as with all of it forced is chatter
/// @param forced  with runout, with a rigid cutter's chips: it cannot chatter
/// @param cut     with runout
bool judge(Hole& hole, const simulation::Simulation& alone, const simulation::Simulation& forced,
           const simulation::Simulation& cut) {
  const Eigen::Index rows = cut.acceleration_m_per_s2.rows();
  if (cut.diverged || alone.diverged || cut.displacement_m.leftCols<2>().cwiseAbs().maxCoeff() > most_displacement_m)
    return false;
  const std::vector<double> quiet = amplitudes(forced.acceleration_m_per_s2);
  const std::vector<double> chatter = amplitudes(alone.acceleration_m_per_s2);
  const std::vector<double> added = amplitudes(cut.acceleration_m_per_s2 - forced.acceleration_m_per_s2);
  // While the lips cut over nearly their whole width; entry and exit are blows.
  const auto& depth = hole.cut.schedule.depth;
  const auto sample = [rows](double t) {
    return static_cast<std::size_t>(std::min(rows - 1, static_cast<Eigen::Index>(t * hole_rate_hz)));
  };
  const std::size_t from = sample(0.9 * depth[1].time_s), to = sample(depth[2].time_s);
  double usual = 0.0;
  for (std::size_t m = from; m < to; ++m) usual += quiet[m] / static_cast<double>(to - from);
  const auto most = [to](const std::vector<double>& x) {
    return *std::max_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(to));
  };
  const double final_m_per_s2 = most(added);
  hole.chatter = most(chatter) > 0.5 * usual && final_m_per_s2 > 2.0 * usual;
  if (!hole.chatter) return most(chatter) < 0.2 * usual && final_m_per_s2 < usual;
  // Its first sign: as strong as what is forced, or as the spindle's noise.
  const double sign_m_per_s2 = std::min(std::max(usual, 1.0), 0.5 * final_m_per_s2);
  std::size_t onset = 0;
  while (added[onset] < 0.5 * final_m_per_s2) ++onset;
  while (onset > 0 && added[onset] > sign_m_per_s2) --onset;
  hole.onset_s = static_cast<double>(onset + static_cast<std::size_t>(idle)) / hole_rate_hz;
  return true;
}

/// Noise, hum and a gain that is not quite known; idle time on both sides. The spindle's noise is always there; the
/// cut's own is a share of the forced vibration and grows with the lips' width, so that no sample tells of chatter to
/// come.
void record(Hole& hole, const simulation::Simulation& cut, const simulation::Simulation& forced, Random& random) {
  const Eigen::Index rows = cut.acceleration_m_per_s2.rows();
  const double level =
      std::sqrt(forced.acceleration_m_per_s2.leftCols<2>().squaredNorm() / (2.0 * static_cast<double>(rows)));
  const double spindle = random.uniform(0.5, 2.0);
  const double own = level * random.uniform(0.05, 0.3);
  const simulation::detail::Profile width(hole.cut.schedule.depth);
  const double hum = random.uniform(0.1, 1.0);
  const double gain = random.uniform(0.9, 1.1);
  hole.record.sample_rate_hz = hole_rate_hz;
  hole.record.acceleration_m_per_s2 = Columns::Zero(rows + 2 * idle, 3);
  hole.record.acceleration_m_per_s2.middleRows(idle, rows) = cut.acceleration_m_per_s2;
  hole.record.displacement_m = Columns::Zero(rows + 2 * idle, 3);
  hole.record.displacement_m.middleRows(idle, rows) = cut.displacement_m;
  for (Eigen::Index m = 0; m < rows + 2 * idle; ++m) {
    const double cut_s = static_cast<double>(m - idle) / hole_rate_hz;
    const double noise = spindle + (m >= idle && m < idle + rows ? own * width.at(cut_s) : 0.0);
    const double mains = hum * std::sin(2.0 * pi * 50.0 * static_cast<double>(m) / hole_rate_hz);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      double& a = hole.record.acceleration_m_per_s2(m, axis);
      a = gain * (a + noise * random.normal() + mains);
    }
  }
}

/// The first of a hundred draws that is clear, and does what is wanted of it.
/// @throws InvalidInput if none is
template <typename Draw, typename Wanted>
Hole first_clear(Random& random, std::uint64_t index, Draw draw, Wanted wanted) {
  for (int draws = 1; draws <= 100; ++draws) {
    Hole hole = draw(random);
    hole.draws = draws;
    const simulation::Simulation cut = run(hole.cut, hole.seconds, true);
    const simulation::Simulation forced = run(hole.cut, hole.seconds, false);
    DrillingCut alone = hole.cut;
    alone.runout_m *= 0.05;
    if (!judge(hole, run(alone, hole.seconds, true), forced, cut) || !wanted(hole)) continue;
    record(hole, cut, forced, random);
    return hole;
  }
  throw InvalidInput("index", static_cast<double>(index), "",
                     "gave no hole that is clearly stable or clearly chatters, as is asked");
}

}  // namespace

Hole simulate_hole(std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  return first_clear(
      random, index, [index](Random& r) { return draw(index, r); }, [](const Hole&) { return true; });
}

Hole simulate_hole(const HoleConditions& conditions, bool chatter, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  const auto given = [&conditions](Random& r) {
    Hole hole;
    hole.feed_m_per_s = conditions.feed_m_per_s;
    hole.cut.spindle_speed_rad_per_s = conditions.spindle_speed_rad_per_s;
    hole.cut.feed_per_revolution_m = conditions.feed_m_per_s * 2.0 * pi / conditions.spindle_speed_rad_per_s;
    hole.cut.point_angle_rad = conditions.point_angle_rad;
    draw_setup(hole, r);
    plan_drilled(hole, conditions.diameter_m);
    return hole;
  };
  return first_clear(random, index, given, [chatter](const Hole& hole) { return hole.chatter == chatter; });
}

}  // namespace robomill::examples
