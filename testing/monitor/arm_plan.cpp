#include "testing/monitor/arm_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/simulation/engine.hpp"

namespace robomill::monitor::testing {
namespace {

using simulation::Schedule;
using std::numbers::pi;

constexpr double deepest_m = 5e-3, begins_s = 0.05;
constexpr double small_steps_per_s = 20000.0;  // 25 in a period of the tool's fastest mode

modal::Mode mode_along(const modal::MassMode& mode, const Eigen::Vector3d& direction) {
  modal::Mode out = modal::mode_from_mass(mode, 0, 1);
  out.left = direction * out.left(0);
  out.right = direction * out.right(0);
  return out;
}

modal::MassMode stiff_mode(double frequency_hz, double damping_ratio, double stiffness_n_per_m) {
  return {frequency_hz, damping_ratio, stiffness_n_per_m / std::pow(2.0 * pi * frequency_hz, 2)};
}

modal::ModalModel draw_arm(int arm_modes, Random& random) {
  modal::ModalModel out;
  out.excitations = out.responses = modal::tip_axes();
  std::vector<double> frequencies;
  while (static_cast<int>(frequencies.size()) < arm_modes) {
    const double here = log_uniform(8.0, 60.0, random);
    if (std::ranges::all_of(frequencies, [&](double f) { return std::abs(std::log(here / f)) > 0.12; })) {
      frequencies.push_back(here);
    }
  }
  for (const double frequency_hz : frequencies) {
    const double x = random.normal(), y = random.normal(), z = 0.6 * random.normal();
    const double damping_ratio = log_uniform(0.01, 0.05, random), stiffness = log_uniform(3e5, 4e6, random);
    out.modes.push_back(
        mode_along(stiff_mode(frequency_hz, damping_ratio, stiffness), Eigen::Vector3d(x, y, z).normalized()));
  }
  const double across = random.uniform(0.0, pi), tool_hz = random.uniform(350.0, 750.0);
  for (const int k : {0, 1}) {
    const double direction = across + 0.5 * pi * k, damping_ratio = random.uniform(0.02, 0.04);
    out.modes.push_back(mode_along(stiff_mode(tool_hz * (1.0 + 0.06 * k), damping_ratio, log_uniform(3e7, 1e8, random)),
                                   {std::cos(direction), std::sin(direction), 0.0}));
  }
  return out;
}

cutting::ForceCoefficients draw_material(Random& random) {
  const double kt = log_uniform(600e6, 2200e6, random);
  return {.tangential_n_per_m2 = kt,
          .radial_n_per_m2 = kt * random.uniform(0.3, 0.5),
          .tangential_edge_n_per_m = random.uniform(5e3, 3e4),
          .radial_edge_n_per_m = random.uniform(5e3, 3e4)};
}

simulation::MillingCut draw_arm_milling(Random& random) {
  simulation::MillingCut out;
  cutting::Milling& m = out.milling;
  m.tool.teeth = 1 + static_cast<int>(random.index(4));
  m.tool.diameter_m = log_uniform(0.01, 0.063, random);
  const bool up = random.uniform() < 0.5;
  m.immersion = cutting::immersion(up ? cutting::MillingDirection::up : cutting::MillingDirection::down,
                                   random.uniform(0.1, 0.9) * m.tool.diameter_m, m.tool.diameter_m);
  m.coefficients = draw_material(random);
  m.feed_per_tooth_m = random.uniform(4e-5, 2e-4);
  m.tool.runout_m = random.uniform(0.0, 0.4) * m.feed_per_tooth_m;
  m.process_damping = {.indentation_n_per_m3 = log_uniform(2e13, 1e14, random),
                       .wear_land_m = random.uniform(1e-5, 6e-5)};
  return out;
}

simulation::DrillingCut draw_arm_drilling(Random& random) {
  simulation::DrillingCut out;
  out.lips = 1 + static_cast<int>(random.index(2));
  out.diameter_m = random.uniform(0.008, 0.02);
  out.radial_width_m = 0.5 * out.diameter_m;
  out.coefficients = draw_material(random);
  out.feed_per_revolution_m = random.uniform(5e-5, 2e-4);
  out.runout_m = random.uniform(0.0, 0.2) * out.feed_per_revolution_m;
  return out;
}

double deepest(const CutPlan& plan) {
  return plan.drilling ? 0.5 * plan.drill.diameter_m : deepest_m;
}

/// From a small push: between the second and the last third of ten revolutions or more.
template <int D>
double small_growth(const simulation::detail::CutModel& model, const modal::TipModes& structure, double seconds) {
  simulation::detail::Engine<D> engine(model, structure, simulation::detail::Physics::perturbation);
  for (std::size_t k = 0; k < engine.modes(); ++k) engine.set_mode(k, {1e-6, 0.0});
  std::array<double, 3> size = {};
  while (engine.time_s() < seconds) {
    engine.step();
    const double third = std::min(2.0, std::floor(3.0 * engine.time_s() / seconds));
    size.at(static_cast<std::size_t>(third)) += engine.displacement().squaredNorm();
  }
  return 0.5 * std::log(size[2] / size[1]) / (seconds / 3.0);
}

double growth_of(const CutPlan& plan, double depth_m) {
  const double speed = plan.speed_rad_per_s(), turn_s = 2.0 * pi / speed;
  const double seconds = std::max(1.2, 10.0 * turn_s);
  const int steps = plan.teeth() * static_cast<int>(std::ceil(small_steps_per_s * turn_s / plan.teeth()));
  if (plan.drilling) {
    simulation::DrillingCut cut = plan.drill;
    cut.radial_width_m = depth_m;
    cut.runout_m = 0.0;
    return small_growth<3>(simulation::detail::drilling_model(cut, steps), cut.structure, seconds);
  }
  cutting::Milling milling = plan.milling.milling;
  milling.tool.runout_m = 0.0;
  return small_growth<2>(simulation::detail::milling_model(milling, speed, depth_m, {steps, 1}), plan.milling.structure,
                         seconds);
}

/// The lowest unstable depth; nothing where all are stable.
std::optional<double> lowest_unstable(const CutPlan& plan) {
  double low = 2e-6, high = low;
  while (growth_of(plan, high) < 0.0) {
    low = high;
    high *= 1.7;
    if (high > deepest(plan)) return std::nullopt;
  }
  for (int i = 0; i < 5; ++i) {
    const double middle = 0.5 * (low + high);
    (growth_of(plan, middle) < 0.0 ? low : high) = middle;
  }
  return low;
}

/// Entry, cutting, in half of them shallower for a while, exit.
Schedule stable_schedule(Random& random, double& ends_s) {
  double t = begins_s + log_uniform(0.02, 0.4, random);
  Schedule out = {.depth = {{begins_s, 0.0}, {t, 1.0}}};
  t += random.uniform(1.0, 2.5);
  if (random.uniform() < 0.5) {
    const double share = random.uniform(0.3, 0.8);
    out.depth.push_back({t, 1.0});
    t += random.uniform(0.0, 0.3);
    out.depth.push_back({t, share});
    t += random.uniform(0.6, 1.2);
    out.depth.push_back({t, share});
    t += random.uniform(0.0, 0.3);
    out.depth.push_back({t, 1.0});
  }
  t += random.uniform(1.0, 2.0);
  out.depth.push_back({t, 1.0});
  ends_s = t + log_uniform(0.02, 0.4, random);
  out.depth.push_back({ends_s, 0.0});
  return out;
}

/// Below the limit, beyond it, in half of them below it again; abrupt: beyond it from the entry on.
Schedule chatter_schedule(const ArmPlan& plan, Random& random, double& ends_s) {
  const double quiet = plan.limit_share * random.uniform(0.3, 0.7), turn_s = 2.0 * pi / plan.plan.speed_rad_per_s();
  Schedule out = {.depth = {{begins_s, 0.0}}};
  double t = begins_s + log_uniform(0.02, 0.4, random);
  if (plan.course != "abrupt") {
    out.depth.push_back({t, quiet});
    t += random.uniform(0.8, 2.0);
    out.depth.push_back({t, quiet});
    t += plan.course == "step" ? 0.0 : random.uniform(0.3, 1.5);
  }
  out.depth.push_back({t, 1.0});
  t += std::max(1.0, 10.0 * turn_s) + 5.0 / plan.growth_per_s;
  out.depth.push_back({t, 1.0});
  if (random.uniform() < 0.5) {
    t += random.uniform(0.05, 0.3);
    out.depth.push_back({t, quiet});
    t += random.uniform(1.2, 2.0);
    out.depth.push_back({t, quiet});
  }
  ends_s = t + random.uniform(0.02, 0.3);
  out.depth.push_back({ends_s, 0.0});
  return out;
}

/// A depth at which small vibration grows as wanted; nothing where none does.
bool set_depth_of_chatter(ArmPlan& out, double limit_m, double& depth_m, Random& random) {
  const double wanted_per_s = log_uniform(2.0, 30.0, random), most_m = std::min(4.0 * limit_m, deepest(out.plan));
  depth_m = limit_m;
  do {
    depth_m *= 1.15;
    out.growth_per_s = growth_of(out.plan, depth_m);
  } while (out.growth_per_s < wanted_per_s && 1.15 * depth_m < most_m);
  constexpr std::array<const char*, 3> courses = {"ramp", "step", "abrupt"};
  out.course = courses.at(random.index(courses.size()));
  return depth_m < most_m && out.growth_per_s > 1.5;
}

/// Nothing where the draw gives no cut as wanted.
std::optional<ArmPlan> try_arm_plan(bool chatter, Random& random) {
  ArmPlan out;
  CutPlan& plan = out.plan;
  const double speed = log_uniform(300.0, 3000.0, random) * pi / 30.0;
  plan.drilling = random.uniform() < 0.25;
  out.arm_modes = 2 + static_cast<int>(random.index(2));
  out.dynamics = draw_arm(out.arm_modes, random);
  if (plan.drilling) {
    plan.drill = draw_arm_drilling(random);
  } else {
    plan.milling = draw_arm_milling(random);
  }
  plan.drill.structure = plan.milling.structure = modal::tip_modes(out.dynamics, {}, 0.0);
  plan.drill.spindle_speed_rad_per_s = plan.milling.spindle_speed_rad_per_s = speed;
  const std::optional<double> limit_m = lowest_unstable(plan);
  if (!limit_m) return std::nullopt;
  double depth_m = *limit_m * random.uniform(0.3, 0.75), ends_s = 0.0;
  out.course = "stable";
  if (!chatter) out.growth_per_s = growth_of(plan, depth_m);
  if (chatter && !set_depth_of_chatter(out, *limit_m, depth_m, random)) return std::nullopt;
  out.limit_share = *limit_m / depth_m;
  Schedule schedule = chatter ? chatter_schedule(out, random, ends_s) : stable_schedule(random, ends_s);
  const double sag = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 0.02);
  out.speed_rad_per_s = speed * (1.0 - sag);
  if (sag > 0.0)
    schedule.speed = {{begins_s, 1.0}, {begins_s + 0.3, 1.0 - sag}, {ends_s, 1.0 - sag}, {ends_s + 0.3, 1.0}};
  plan.drill.schedule = plan.milling.schedule = schedule;
  plan.drill.radial_width_m = plan.milling.axial_depth_m = depth_m;
  plan.idle_before_s = random.uniform(0.5, 2.0);
  plan.seconds = ends_s + random.uniform(0.5, 1.5);
  plan.idle_after_s = 0.0;  // the arm rings on: simulated
  return out;
}

}  // namespace

ArmPlan draw_arm_plan(bool chatter, Random& random) {
  for (int tries = 0; tries < 200; ++tries) {
    if (std::optional<ArmPlan> plan = try_arm_plan(chatter, random)) return *std::move(plan);
  }
  throw InvalidInput("draws", 200.0, "", "gave no cut of an arm as wanted");
}

}  // namespace robomill::monitor::testing
