#include "testing/monitor/corpus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/simulation/engine.hpp"
#include "robomill/stability/lobes.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::monitor::testing {
namespace {

using simulation::Schedule;
using std::numbers::pi;

constexpr double rpm = pi / 30.0;
constexpr double greatest_depth_m = 6e-3;
constexpr std::array<double, 3> noises = {0.05, 0.15, 0.4};

/// One draw of everything but depth and schedule.
struct Draw {
  CutPlan plan;
  stability::LobesProblem problem;  // of milling
};

/// @param low  with a short tool, whose two modes are so much stiffer that the arm's chatter first
Draw draw_milling(bool low, Random& random) {
  Draw draw;
  stability::LobesProblem& p = draw.problem;
  p.dynamics = data::robot_modes();
  if (low) {
    for (std::size_t k = 6; k < 8; ++k) p.dynamics.modes[k].left *= 0.1;
  }
  p.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
  p.milling.tool.teeth = 2 + static_cast<int>(random.index(3));
  p.milling.tool.diameter_m = 2e-3 * static_cast<double>(4 + random.index(5));
  const bool up = random.uniform() < 0.5;
  p.milling.immersion =
      cutting::immersion(up ? cutting::MillingDirection::up : cutting::MillingDirection::down,
                         random.uniform(0.1, 0.6) * p.milling.tool.diameter_m, p.milling.tool.diameter_m);
  const double kt = random.uniform(600e6, 1000e6);
  p.milling.coefficients = {.tangential_n_per_m2 = kt,
                            .radial_n_per_m2 = kt * random.uniform(0.3, 0.5),
                            .tangential_edge_n_per_m = random.uniform(2e3, 8e3),
                            .radial_edge_n_per_m = random.uniform(2e3, 8e3)};
  p.milling.feed_per_tooth_m = random.uniform(4e-5, 1e-4);
  if (random.uniform() < 0.3) p.milling.tool.helix_rad = 0.5;
  draw.plan.milling.structure = modal::tip_modes(p.dynamics, {}, p.feed_direction_rad);
  draw.plan.milling.spindle_speed_rad_per_s =
      (low ? random.uniform(2000.0, 9000.0) : random.uniform(4000.0, 15000.0)) * rpm;
  return draw;
}

Draw draw_drilling(Random& random) {
  Draw draw;
  draw.plan.drilling = true;
  simulation::DrillingCut& d = draw.plan.drill;
  d.diameter_m = random.uniform() < 0.5 ? 5e-3 : 6e-3;
  d.radial_width_m = 0.5 * d.diameter_m;
  d.feed_per_revolution_m = random.uniform(1.2e-5, 4e-5);
  d.runout_m = random.uniform(5e-6, 4e-5);
  const double kt = random.uniform(600e6, 1000e6);
  d.coefficients = {.tangential_n_per_m2 = kt,
                    .radial_n_per_m2 = kt * random.uniform(0.3, 0.5),
                    .tangential_edge_n_per_m = random.uniform(2e3, 8e3),
                    .radial_edge_n_per_m = random.uniform(2e3, 8e3)};
  d.structure = modal::tip_modes(data::robot_modes(), {}, random.uniform(0.0, 2.0 * pi));
  d.spindle_speed_rad_per_s = random.uniform(1300.0, 4150.0) * rpm;
  return draw;
}

/// Growth of small vibration at a depth (drilling: width) [1/s], and where it vibrates.
struct Growth {
  double per_s = 0.0;
  double frequency_hz = 0.0;
  std::complex<double> multiplier;
};

/// From a small push, between the second and the last third of the time.
double drilling_growth(simulation::DrillingCut cut, double speed_rad_per_s, double width_m) {
  constexpr double seconds = 0.36;
  cut.schedule = {};
  cut.radial_width_m = width_m;
  cut.spindle_speed_rad_per_s = speed_rad_per_s;
  const int steps = cut.lips * static_cast<int>(std::ceil(24000.0 * 2.0 * pi / speed_rad_per_s / cut.lips));
  const simulation::detail::CutModel model = simulation::detail::drilling_model(cut, steps);
  simulation::detail::Engine<3> engine(model, cut.structure, simulation::detail::Physics::perturbation);
  for (std::size_t k = 0; k < engine.modes(); ++k) engine.set_mode(k, {1e-6, 0.0});
  std::array<double, 3> size = {};
  while (engine.time_s() < seconds) {
    engine.step();
    size.at(std::min<std::size_t>(2, static_cast<std::size_t>(engine.time_s() / seconds * 3.0))) +=
        engine.displacement().squaredNorm();
  }
  return 0.5 * std::log(size[2] / size[1]) / (seconds / 3.0);
}

Growth growth_at(const Draw& draw, double speed_rad_per_s, double depth_m) {
  if (draw.plan.drilling) {
    return {drilling_growth(draw.plan.drill, speed_rad_per_s, depth_m), 0.0, 0.0};
  }
  const stability::PointResult point = stability::evaluate_point(
      draw.problem, {.method = stability::Method::semi_discretization, .intervals = 40}, {speed_rad_per_s, depth_m});
  const double period_s = 2.0 * pi / speed_rad_per_s / draw.problem.milling.tool.teeth;
  return {std::log(point.spectral_radius) / period_s, point.chatter_frequency_hz, point.multiplier};
}

double greatest(const Draw& draw) {
  return draw.plan.drilling ? draw.plan.drill.radial_width_m : greatest_depth_m;
}

/// The lowest unstable depth, from below by tenths and then by halves; the greatest one where all are stable.
double limit_at(const Draw& draw, double speed_rad_per_s) {
  double low = 0.005 * greatest(draw), high = low;
  while (high < greatest(draw) && growth_at(draw, speed_rad_per_s, high).per_s < 0.0) {
    low = high;
    high *= 1.5;
  }
  if (high >= greatest(draw)) return greatest(draw);
  for (int i = 0; i < 5; ++i) {
    const double middle = 0.5 * (low + high);
    (growth_at(draw, speed_rad_per_s, middle).per_s < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void set(Draw& draw, double speed_rad_per_s, double depth_m, Schedule schedule) {
  CutPlan& plan = draw.plan;
  if (plan.drilling) {
    plan.drill.spindle_speed_rad_per_s = speed_rad_per_s;
    plan.drill.radial_width_m = depth_m;
    plan.drill.schedule = std::move(schedule);
    return;
  }
  plan.milling.milling = draw.problem.milling;
  plan.milling.spindle_speed_rad_per_s = speed_rad_per_s;
  plan.milling.axial_depth_m = depth_m;
  plan.milling.schedule = std::move(schedule);
}

/// Speed before and after a change, and its time; the greater one is the plan's.
struct SpeedChange {
  double before_rad_per_s = 0.0, after_rad_per_s = 0.0, from_s = 0.0, to_s = 0.0;
  [[nodiscard]] double greatest() const { return std::max(before_rad_per_s, after_rad_per_s); }
  [[nodiscard]] std::vector<Schedule::Point> line() const {
    if (before_rad_per_s == after_rad_per_s) return {};
    return {{from_s, before_rad_per_s / greatest()}, {to_s, after_rad_per_s / greatest()}};
  }
};

SpeedChange steady(double speed_rad_per_s) {
  return {speed_rad_per_s, speed_rad_per_s, 0.0, 0.0};
}

/// Entry, cutting at `depth_m`, exit.
void plan_stable(Draw& draw, const SpeedChange& speed, double depth_m, Random& random) {
  const double entry_s = random.uniform(0.005, 0.15), exit_s = random.uniform(0.005, 0.15);
  const double end_s = draw.plan.seconds - 0.2;
  Schedule schedule = {.depth = {{0.02, 0.0}, {0.02 + entry_s, 1.0}}, .speed = speed.line()};
  if (random.uniform() < 0.5) {
    // Shallower for a while.
    const double at_s = random.uniform(0.8, 1.2), share = random.uniform(0.3, 0.8);
    schedule.depth.push_back({at_s, 1.0});
    schedule.depth.push_back({at_s + random.uniform(0.0, 0.2), share});
    schedule.depth.push_back({at_s + 0.4, share});
    schedule.depth.push_back({at_s + 0.4 + random.uniform(0.0, 0.2), 1.0});
  }
  schedule.depth.push_back({end_s - exit_s, 1.0});
  schedule.depth.push_back({end_s, 0.0});
  set(draw, speed.greatest(), depth_m, schedule);
}

/// @param limit_share  the limit as a share of the plan's depth
void plan_chatter(Draw& draw, const SpeedChange& speed, double depth_m, double limit_share, const std::string& course,
                  Random& random) {
  const double quiet = limit_share * random.uniform(0.3, 0.7);
  const double entry_s = random.uniform(0.005, 0.15);
  Schedule schedule = {.depth = {{0.02, 0.0}}, .speed = speed.line()};
  double t = 0.02 + entry_s;
  if (course == "abrupt") {
    schedule.depth.push_back({0.02 + random.uniform(0.0, 0.02), 1.0});
  } else {
    schedule.depth.push_back({t, quiet});
    t = random.uniform(0.9, 1.3);
    schedule.depth.push_back({t, quiet});
    t += course == "step" ? 0.0 : random.uniform(0.3, 1.0);
    schedule.depth.push_back({t, 1.0});
  }
  t += random.uniform(1.0, 1.3);
  if (random.uniform() < 0.5) {
    schedule.depth.push_back({t, 1.0});
    schedule.depth.push_back({t + random.uniform(0.0, 0.2), quiet});
    t += 0.9;
    schedule.depth.push_back({t, quiet});
  } else {
    schedule.depth.push_back({t, 1.0});
  }
  t += random.uniform(0.005, 0.1);
  schedule.depth.push_back({t, 0.0});
  draw.plan.seconds = t + 0.2;
  set(draw, speed.greatest(), depth_m, schedule);
}

/// Whether what was planned came true.
/// @param most  of the chatter, in reference levels
bool came_true(const CutPlan& plan, const CleanCut& clean, const Truth& truth, bool low, double most) {
  if (clean.diverged) return false;
  const double level = reference_level(plan, clean);
  if (truth.chatter) {
    if (low && truth.displacement_hz > 120.0) return false;
    return truth.final_m_per_s2 > 0.5 * level && truth.final_m_per_s2 < most * level &&
           truth.end_s - truth.t10_s > 0.4 && !truth.lines_hz.empty() && truth.comb_gain > 0.3;
  }
  return settles(plan, clean);
}

RecordedCut record(DrawnCut& drawn, const Truth& truth, int noise, Random& random) {
  RecordedCut out;
  out.noise = noise;
  out.teeth = drawn.plan.teeth();
  drawn.disturbance = {.noise = noises.at(static_cast<std::size_t>(noise)),
                       .hum = random.uniform(0.01, 0.1),
                       .unbalance = random.uniform(0.01, 0.1),
                       .gain_swing = random.uniform(0.0, 0.25),
                       .knocks_per_s = random.uniform(0.1, 0.8)};
  drawn.random = random;
  out.samples = disturbed(drawn.plan, drawn.clean, drawn.disturbance, random);
  const double off = random.uniform() < 0.2 ? 0.0 : random.uniform(-0.05, 0.05);
  out.hint_rad_per_s = static_cast<double>(drawn.clean.speed_rad_per_s.front()) * (1.0 + off);
  out.truth = truth;
  return out;
}

/// A depth above the limit at which small vibration grows as fast as wanted, or a multiple of the limit: a drill's
/// many waves a revolution grow slowly just above it.
double chatter_depth(const Draw& draw, double speed_rad_per_s, double limit_m, double growth_per_s,
                     double most_limits = 3.0) {
  const double most_m = most_limits * limit_m;
  double depth_m = 1.15 * limit_m;
  while (depth_m < most_m && depth_m < greatest(draw) &&
         growth_at(draw, speed_rad_per_s, depth_m).per_s < growth_per_s) {
    depth_m *= draw.plan.drilling ? 1.3 : 1.1;
  }
  return std::min(depth_m, greatest(draw));
}

/// A plan of chatter; nothing where this draw gives none.
std::optional<CutPlan> chatter_plan(const CutWish& wish, Random& random) {
  Draw one = wish.drilling ? draw_drilling(random) : draw_milling(wish.low, random);
  const double speed = one.plan.speed_rad_per_s();
  if (speed > wish.most_speed_rad_per_s) return std::nullopt;
  const double limit_m = limit_at(one, speed);
  if (limit_m > 0.7 * greatest(one)) return std::nullopt;
  const double wanted_per_s =
      std::exp(random.uniform(std::log(wish.least_growth_per_s), std::log(wish.most_growth_per_s)));
  const double depth_m = chatter_depth(one, speed, limit_m, wanted_per_s, wish.most_limits);
  const Growth growth = growth_at(one, speed, depth_m);
  if (growth.per_s < 2.0 / 3.0 * wish.least_growth_per_s) return std::nullopt;
  if (!wish.drilling) {
    if ((growth.frequency_hz < 120.0) != wish.low) return std::nullopt;
    if (random.uniform() < 0.7) one.problem.milling.tool.runout_m = random.uniform(0.0, 1.2e-5);
  }
  SpeedChange change = steady(speed);
  if (wish.course != "abrupt" && random.uniform() < 0.3) {
    change.before_rad_per_s *= random.uniform(0.93, 1.07);
    change.from_s = random.uniform(0.35, 0.5);
    change.to_s = change.from_s + random.uniform(0.1, 0.3);
  }
  plan_chatter(one, change, depth_m, limit_m / depth_m, wish.course, random);
  one.plan.idle_before_s = random.uniform(0.25, 0.6);
  return one.plan;
}

}  // namespace

CutPlan stable_plan(bool drilling, double seconds, Random& random) {
  Draw draw = drilling ? draw_drilling(random) : draw_milling(random.uniform() < 0.4, random);
  draw.plan.seconds = seconds;
  draw.plan.idle_before_s = random.uniform(0.25, 0.6);
  SpeedChange speed = steady(draw.plan.speed_rad_per_s());
  double limit_m = limit_at(draw, speed.before_rad_per_s);
  if (random.uniform() < 0.5) {
    speed.after_rad_per_s *= random.uniform(0.9, 1.1);
    speed.from_s = random.uniform(0.6, 0.4 * seconds);
    speed.to_s = speed.from_s + random.uniform(0.1, 0.6);
    for (const double share : {0.33, 0.67, 1.0}) {
      const double between = speed.before_rad_per_s + share * (speed.after_rad_per_s - speed.before_rad_per_s);
      limit_m = std::min(limit_m, limit_at(draw, between));
    }
  }
  if (!drilling && random.uniform() < 0.7) draw.problem.milling.tool.runout_m = random.uniform(0.0, 1.2e-5);
  plan_stable(draw, speed, limit_m * random.uniform(0.3, 0.75), random);
  return draw.plan;
}

bool settles(const CutPlan& plan, const CleanCut& clean) {
  const std::vector<float> amplitude = truth_of(plan, clean, false).amplitude_m_per_s2;
  const double most = 0.25 * reference_level(plan, clean);
  const auto longest = static_cast<std::size_t>(0.1 * corpus_rate_hz);
  std::size_t cutting = 0, loud = 0;
  for (std::size_t i = 0; i < amplitude.size(); ++i) {
    if (clean.depth_share[i] <= 0.0F) continue;
    ++cutting;
    loud = static_cast<double>(amplitude[i]) < most ? 0 : loud + 1;
    if (loud > longest) return false;
  }
  return static_cast<double>(cutting) > 0.8 * corpus_rate_hz;
}

DrawnCut draw(const CutWish& wish, Random& random) {
  DrawnCut out;
  // Draws at too high a speed cost nothing.
  const int most = wish.most_speed_rad_per_s < 1e300 ? 10'000 : 200;
  for (out.draws = 1; out.draws < most; ++out.draws) {
    const std::optional<CutPlan> plan =
        wish.chatter ? chatter_plan(wish, random)
                     : std::optional(stable_plan(wish.drilling, random.uniform(2.6, 3.4), random));
    if (!plan || plan->speed_rad_per_s() > wish.most_speed_rad_per_s) continue;
    out.plan = *plan;
    out.clean = simulate(out.plan);
    if (out.clean.diverged) continue;
    const Truth truth = truth_of(out.plan, out.clean, wish.chatter);
    if (!came_true(out.plan, out.clean, truth, wish.low && !wish.drilling, wish.drilling ? 300.0 : 10.0)) continue;
    out.recorded = record(out, truth, wish.noise, random);
    out.recorded.course = wish.chatter ? wish.course : "stable";
    out.recorded.kind = wish.drilling   ? "drilling"
                        : !wish.chatter ? "milling"
                        : wish.low      ? "milling low"
                                        : "milling high";
    return out;
  }
  throw InvalidInput("draws", out.draws, "", "gave no cut that does as planned");
}

DrawnCut draw(std::uint64_t seed) {
  const std::uint64_t place = (seed - 1) % 20, block = (seed - 1) / 20;
  const bool drilling = place == 0 || place == 7 || place == 13;
  const CutWish wish = {.drilling = drilling,
                        .chatter = (place + block) % 2 == 1,
                        .low = (place / 2 + block) % 2 == 0,
                        .course = std::array{"ramp", "step", "abrupt"}.at((place / 2 + block / 2) % 3),
                        .noise = static_cast<int>((place / 2 + 2 * block) % 3),
                        .least_growth_per_s = drilling ? 15.0 : 6.0,
                        .most_limits = drilling ? 8.0 : 3.0};
  Random random(seed, 7);
  return draw(wish, random);
}

RecordedCut cut(std::uint64_t seed) {
  return draw(seed).recorded;
}

RecordedCut locked_chatter(std::uint64_t seed) {
  Random random(seed, 8);
  for (int tries = 0; tries < 100; ++tries) {
    Draw one = draw_milling(false, random);
    double speed = one.plan.speed_rad_per_s();
    const double limit_m = limit_at(one, speed);
    if (limit_m > 3e-3) continue;
    const double depth_m = chatter_depth(one, speed, limit_m, 30.0);
    DrawnCut out;
    const std::uint64_t course = random.index(1000);
    // The frequency of full chatter is not that of small vibration: the speed is led to where a multiple meets it.
    for (int pass = 0; pass < 8; ++pass) {
      Random again(seed, 100 + course);
      plan_chatter(one, steady(speed), depth_m, limit_m / depth_m, "step", again);
      out.plan = one.plan;
      out.plan.locked = true;
      out.clean = simulate(out.plan);
      if (out.clean.diverged) break;
      const Truth truth = truth_of(out.plan, out.clean, true);
      if (!came_true(out.plan, out.clean, truth, false, 30.0)) break;
      const double ratio = 2.0 * pi * truth.frequency_hz / speed, multiple = std::round(ratio);
      if (std::abs(ratio - multiple) * speed < 2.0 * pi * 0.3) {
        if (static_cast<int>(multiple) % out.plan.teeth() == 0) break;
        out.recorded = record(out, truth, static_cast<int>(seed % 3), random);
        out.recorded.kind = "locked";
        out.recorded.course = "step";
        return out.recorded;
      }
      speed *= ratio / multiple;
    }
  }
  throw InvalidInput("seed", static_cast<double>(seed), "", "gave no chatter that locks");
}

RecordedCut period_doubling(std::uint64_t seed) {
  Random random(seed, 9);
  for (int tries = 0; tries < 400; ++tries) {
    Draw one = draw_milling(false, random);
    cutting::Milling& milling = one.problem.milling;
    milling.tool.teeth = random.uniform() < 0.5 ? 2 : 4;
    milling.tool.helix_rad = 0.0;
    const bool up = random.uniform() < 0.5;
    milling.immersion =
        cutting::immersion(up ? cutting::MillingDirection::up : cutting::MillingDirection::down,
                           random.uniform(0.04, 0.1) * milling.tool.diameter_m, milling.tool.diameter_m);
    // Tooth passing a little above two thirds of the tool's frequency: the flip lobe.
    const double speed = 2.0 * pi * 542.0 * random.uniform(0.62, 0.75) / milling.tool.teeth;
    one.plan.milling.spindle_speed_rad_per_s = speed;
    const double limit_m = limit_at(one, speed);
    if (limit_m > 0.7 * greatest(one)) continue;
    const double depth_m = chatter_depth(one, speed, limit_m, 30.0);
    const Growth growth = growth_at(one, speed, depth_m);
    if (growth.per_s < 8.0 || growth.multiplier.real() > 0.0 || std::abs(growth.multiplier.imag()) > 1e-6) continue;
    DrawnCut out;
    const std::string course = random.uniform() < 0.5 ? "step" : "ramp";
    plan_chatter(one, steady(speed), depth_m, limit_m / depth_m, course, random);
    out.plan = one.plan;
    out.plan.locked = true;
    out.clean = simulate(out.plan);
    if (out.clean.diverged) continue;
    const Truth truth = truth_of(out.plan, out.clean, true);
    if (!came_true(out.plan, out.clean, truth, false, 30.0)) continue;
    const double halves = 4.0 * pi * truth.frequency_hz / (speed * milling.tool.teeth);
    if (std::abs(halves - std::round(halves)) > 0.02 || static_cast<int>(std::round(halves)) % 2 == 0) continue;
    out.recorded = record(out, truth, static_cast<int>(seed % 3), random);
    out.recorded.kind = "period doubling";
    out.recorded.course = course;
    return out.recorded;
  }
  throw InvalidInput("seed", static_cast<double>(seed), "", "gave no period doubling");
}

}  // namespace robomill::monitor::testing
