#include "robomill/simulation/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/simulation/engine.hpp"
#include "testing/simulation/cuts.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace simulation_test {

using detail::CutModel;
using detail::Engine;
using detail::Physics;
using std::numbers::pi;

CutModel model_of(const MillingCut& cut, int steps, int slices = 1) {
  return detail::milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, {steps, slices});
}

MillingCut benchmark_cut(double ratio, double speed_rpm, double depth_m) {
  return testing::cut_of(stability::testing::benchmark(ratio), speed_rpm, depth_m);
}

Eigen::MatrixXd displacements(const MillingCut& cut, Physics physics, int steps, int slices, double revolutions,
                              int every) {
  const CutModel model = model_of(cut, steps, slices);
  Engine<2> engine(model, cut.structure, physics);
  const int all = static_cast<int>(std::lround(revolutions * steps));
  Eigen::MatrixXd q(2, all / every);
  for (int i = 1; i <= all; ++i) {
    engine.step();
    if (i % every == 0) q.col(i / every - 1) = engine.displacement();
  }
  return q;
}

struct Feature {
  const char* name;
  MillingCut cut;
  int slices;
  double least_fall;  ///< of the error when steps and slices are doubled
  Physics physics = Physics::linear;
};

std::vector<Feature> features() {
  std::vector<Feature> all;
  const MillingCut plain = benchmark_cut(0.3, 7000.0, 3e-4);
  all.push_back({"plain", plain, 1, 3.2});
  all.push_back({"edge", plain, 1, 3.2});
  all.back().cut.milling.coefficients.tangential_edge_n_per_m = 1e4;
  all.back().cut.milling.coefficients.radial_edge_n_per_m = 1e4;
  all.push_back({"helix", plain, 6, 3.0});
  all.back().cut.milling.tool.helix_rad = 0.5;
  all.back().cut.axial_depth_m = 2e-3;
  all.push_back({"compliance", plain, 1, 3.2});
  all.back().cut.structure.compliance << 2e-8, 5e-9, 0.0, -3e-9, 1e-8, 0.0, 0.0, 0.0, 0.0;
  all.push_back({"process damping", plain, 1, 3.2});
  all.back().cut.milling.process_damping = {.indentation_n_per_m3 = 2e13, .wear_land_m = 8e-5};
  all.push_back({"unequal pitch", plain, 1, 3.0});
  all.back().cut.milling.tool.pitch_rad = {2.9, 2.0 * pi - 2.9};
  all.push_back({"swing", plain, 1, 3.0});
  all.back().cut.milling.speed_variation = {.amplitude_ratio = 0.2, .frequency_ratio = 0.3};
  all.push_back({"full", plain, 1, 3.2, Physics::full});
  all.back().cut.milling.immersion = {.entry_rad = 0.6, .exit_rad = 1.7};
  all.push_back({"runout", plain, 1, 3.0, Physics::full});
  all.back().cut.milling.immersion = {.entry_rad = 0.6, .exit_rad = 1.7};
  all.back().cut.milling.tool.runout_m = 4e-5;
  // Where contact is lost the edge of the cut falls between nodes.
  all.push_back({"contact lost", plain, 1, 2.0, Physics::full});
  return all;
}

// Entry and exit stand nowhere near a step's end, so that every step size cuts them differently.
TEST(Simulation, ConvergesAtSecondOrder) {
  for (const Feature& f : features()) {
    const Eigen::MatrixXd exact = displacements(f.cut, f.physics, 5120, f.slices * 16, 6.0, 32);
    double before = 0.0;
    double total_fall = 1.0;
    for (const int factor : {1, 2, 4}) {
      const Eigen::MatrixXd q = displacements(f.cut, f.physics, 320 * factor, f.slices * factor, 6.0, 2 * factor);
      const double error = (q - exact).norm() / exact.norm();
      if (before > 0.0) total_fall *= before / error;
      before = error;
    }
    EXPECT_GT(std::sqrt(total_fall), f.least_fall) << f.name;
    EXPECT_LT(before, 2e-3) << f.name;
  }
}

// Where contact is never lost, both ways to simulate are the same equation.
TEST(Simulation, FullAndLinearCutAgreeWhereContactIsNeverLost) {
  MillingCut cut = benchmark_cut(0.3, 7000.0, 2e-4);
  cut.milling.immersion = {.entry_rad = 0.6, .exit_rad = 1.7};
  cut.milling.feed_per_tooth_m = 3e-4;
  const CutModel model = model_of(cut, 640);
  Engine<2> full(model, cut.structure, Physics::full);
  Engine<2> linear(model, cut.structure, Physics::linear);
  double size = 0.0;
  for (int i = 0; i < 20 * 640; ++i) {
    full.step();
    linear.step();
    size = std::max(size, full.displacement().norm());
    ASSERT_NEAR((full.displacement() - linear.displacement()).norm(), 0.0, 1e-5 * size) << i;
  }
  EXPECT_EQ(full.steps_without_contact(), 0);
  EXPECT_GT(size, 1e-6);
}

// In steady state nothing regenerates: a compliance without modes bends by S F, F that of the rigid cut.
TEST(Simulation, AComplianceAloneBendsByTheRigidForce) {
  MillingCut rigid = testing::rigid_cut();
  MillingCut cut = rigid;
  cut.structure.compliance << 2e-8, 4e-9, 0.0, -6e-9, 3e-8, 0.0, 0.0, 0.0, 0.0;
  const int steps = 600;
  const CutModel rigid_model = model_of(rigid, steps), model = model_of(cut, steps);
  double largest = 0.0, sum = 0.0;
  Engine<2> stiff(rigid_model, rigid.structure, Physics::full), soft(model, cut.structure, Physics::full);
  for (int i = 0; i < 20 * steps; ++i) {
    stiff.step();
    soft.step();
    if (i < 19 * steps) continue;
    // Within the steps of entry and exit the compliance smears a jump, by the order of the step.
    largest = std::max(largest, (stiff.mean_force() - soft.mean_force()).norm());
    sum += (stiff.mean_force() - soft.mean_force()).norm();
  }
  EXPECT_LT(largest, 0.01 * 60.0);
  EXPECT_LT(sum / steps, 1e-4 * 60.0);
  EXPECT_EQ(to_string(simulate(cut, {.seconds = 0.1}).verdict), "stable");
}

// What the force puts in during a period of steady motion is what damping takes out, Σ F Δq = Σ c q̇² Δt.
TEST(Simulation, ForceFeedsWhatDampingTakes) {
  MillingCut cut = testing::rigid_cut();
  const double mass = 0.05, frequency = 300.0, zeta = 0.04;
  cut.structure = testing::one_mode(0, frequency, zeta, mass);
  cut.axial_depth_m = 5e-5;
  const int steps = 4000;
  const CutModel model = model_of(cut, steps);
  Engine<2> engine(model, cut.structure, Physics::full);
  double in = 0.0, out = 0.0;
  const double c = 2.0 * zeta * 2.0 * pi * frequency * mass;
  for (int i = 0; i < 120 * steps; ++i) {
    const Eigen::Vector2d before = engine.displacement();
    engine.step();
    const Eigen::Vector2d moved = engine.displacement() - before;
    if (i < 119 * steps) continue;
    in += engine.mean_force().dot(moved);
    out += c * moved(0) * moved(0) / engine.step_s();
  }
  EXPECT_GT(in, 0.0);
  EXPECT_NEAR(in, out, 1e-3 * out);
}

// Four teeth in a slot: Σ cos 2φ and Σ sin 2φ of those that cut vanish, so that process damping is a plain dashpot
// a N K l² / (4 Ω D) in every direction. Without cutting force the mode then decays as (c_0 + c)/2m says.
TEST(Simulation, ProcessDampingIsADashpotWhereTheCutIsContinuous) {
  MillingCut cut = testing::rigid_cut();
  const double mass = 0.5, frequency = 400.0, zeta = 0.01;
  cut.structure = testing::one_mode(1, frequency, zeta, mass);
  cut.milling.tool.teeth = 4;
  cut.milling.immersion = {.entry_rad = 0.0, .exit_rad = pi};
  cut.milling.process_damping = {.indentation_n_per_m3 = 4e13, .wear_land_m = 6e-5, .friction = 0.0};
  CutModel model = model_of(cut, 8000);
  for (detail::Element& element : model.elements) element.chip = {};
  Engine<2> engine(model, cut.structure, Physics::perturbation);
  engine.set_mode(0, 1.0);
  for (int i = 0; i < 8000; ++i) engine.step();
  const double c = 2.0 * zeta * 2.0 * pi * frequency * mass +
                   cut.axial_depth_m * 4.0 * 4e13 * 36e-10 / (4.0 * cut.spindle_speed_rad_per_s * 0.01);
  const double stiffness = mass * std::pow(2.0 * pi * frequency, 2);
  const double decay = 0.5 * c / mass;
  const double damped = std::sqrt(stiffness / mass - decay * decay);
  // z starts at 1 with the mode's own pole; in x = Re z that is x = 1, x' = Re λ.
  const double t = engine.time_s(), own = zeta * 2.0 * pi * frequency;
  const double expected = std::exp(-decay * t) * (std::cos(damped * t) + (decay - own) / damped * std::sin(damped * t));
  EXPECT_GT(decay, 1.5 * own);
  EXPECT_NEAR(engine.displacement()(1), expected, 1e-4 * std::exp(-decay * t));
}

TEST(Simulation, ChatterStaysFiniteAndShowsItsFrequency) {
  const stability::LobesProblem problem = stability::testing::robot();
  const MillingCut cut = testing::cut_of(problem, 6500.0, 0.9e-3, 1e-5);
  const Simulation s = simulate(cut, {.seconds = 1.0});
  EXPECT_EQ(s.verdict, Verdict::chatter);
  EXPECT_EQ(s.force_n.rows(), 10240);
  EXPECT_TRUE(s.resolved);
  EXPECT_LT(s.displacement_m.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_GT(s.missed_share, 0.0);
  // Near a mode of 540 or 544 Hz, or a tooth passing away from it.
  const double tooth_hz = 325.0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int n = -6; n <= 6; ++n) {
    for (const double sign : {1.0, -1.0}) {
      nearest = std::min(nearest, std::abs(sign * 542.0 + n * tooth_hz - s.chatter_frequency_hz));
    }
  }
  EXPECT_LT(nearest, 8.0) << s.chatter_frequency_hz;
  EXPECT_EQ(s.force_n.col(2).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Simulation, AStableCutSettles) {
  const MillingCut cut = benchmark_cut(0.05, 5000.0, 1e-3);
  const Simulation s = simulate(cut, {.seconds = 1.0});
  EXPECT_EQ(s.verdict, Verdict::stable);
  EXPECT_EQ(s.chatter_frequency_hz, 0.0);
  ASSERT_EQ(s.walls.size(), 1U);
  // Once settled, fifty tooth periods of 6 ms later everything is as before.
  const Eigen::Index n = s.displacement_m.rows() - 400;
  EXPECT_NEAR(s.displacement_m(n, 0), s.displacement_m(n - 3 * 1024, 0), 1e-3 * s.displacement_m.cwiseAbs().maxCoeff());
}

TEST(Simulation, AccelerationIsTheSecondDerivativeOfTheDisplacement) {
  const Simulation s = simulate(benchmark_cut(0.1, 5000.0, 0.3e-3), {.seconds = 0.5, .sample_rate_hz = 51200.0});
  const double h = 1.0 / 51200.0;
  double worst = 0.0;
  const double size = s.acceleration_m_per_s2.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 2000; i < 20000; ++i) {
    const auto q = [&](Eigen::Index k) { return s.displacement_m(k, 0); };
    const double second = (-q(i - 2) + 16.0 * q(i - 1) - 30.0 * q(i) + 16.0 * q(i + 1) - q(i + 2)) / (12.0 * h * h);
    worst = std::max(worst, std::abs(second - s.acceleration_m_per_s2(i, 0)));
  }
  EXPECT_LT(worst, 0.05 * size);
}

TEST(Simulation, HasTheSameBitsEveryTime) {
  const MillingCut cut = benchmark_cut(0.1, 5000.0, 1e-3);
  const Simulation a = simulate(cut, {.seconds = 0.2}), b = simulate(cut, {.seconds = 0.2});
  EXPECT_EQ(a.displacement_m, b.displacement_m);
  EXPECT_EQ(a.small.spectral_radius, b.small.spectral_radius);
}

TEST(Simulation, ALinearCutThatGrowsEndsWhereItLeavesTheWorld) {
  const MillingCut cut = benchmark_cut(1.0, 5000.0, 1e-3);
  const Simulation s = simulate(cut, {.seconds = 2.0, .loss_of_contact = false});
  EXPECT_TRUE(s.diverged);
  EXPECT_EQ(s.verdict, Verdict::chatter);
  EXPECT_LT(s.displacement_m.rows(), 20480);
  EXPECT_TRUE(s.displacement_m.allFinite());
}

template <class Break>
std::string rejected(const Break& change) {
  MillingCut cut = benchmark_cut(0.1, 5000.0, 1e-3);
  SimulationOptions options;
  change(cut, options);
  return test::field_of([&] { static_cast<void>(simulate(cut, options)); });
}

TEST(Simulation, RejectsBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using C = MillingCut;
  using O = SimulationOptions;
  EXPECT_EQ(rejected([](C& c, O&) { c.spindle_speed_rad_per_s = 0.0; }), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([](C& c, O&) { c.spindle_speed_rad_per_s = 1e9; }), "spindle_speed_rad_per_s");
  EXPECT_EQ(rejected([](C& c, O&) { c.axial_depth_m = -1e-3; }), "axial_depth_m");
  EXPECT_EQ(rejected([](C& c, O&) { c.axial_depth_m = 2.0; }), "axial_depth_m");
  EXPECT_EQ(rejected([&](C& c, O&) { c.axial_depth_m = nan; }), "axial_depth_m");
  EXPECT_EQ(rejected([](C& c, O&) { c.milling.tool.teeth = 0; }), "teeth");
  EXPECT_EQ(rejected([](C& c, O&) { c.structure.pole(0) = {3.0, 5000.0}; }), "structure.pole");
  EXPECT_EQ(rejected([&](C& c, O&) { c.structure.left(0, 0) = nan; }), "structure");
  EXPECT_EQ(rejected([](C& c, O&) { c.structure.right.resize(3, 1); }), "structure");
  EXPECT_EQ(rejected([](C&, O& o) { o.seconds = 0.0; }), "seconds");
  EXPECT_EQ(rejected([](C&, O& o) { o.seconds = 1e5; }), "seconds");
  EXPECT_EQ(rejected([&](C&, O& o) { o.sample_rate_hz = nan; }), "sample_rate_hz");
  EXPECT_EQ(rejected([](C&, O& o) { o.sample_rate_hz = 0.1; }), "sample_rate_hz");
  EXPECT_EQ(rejected([](C&, O& o) { o.steps_per_revolution = 3; }), "steps_per_revolution");
  EXPECT_EQ(rejected([](C&, O& o) { o.slices = -1; }), "slices");
  EXPECT_EQ(rejected([](C&, O& o) { o.tolerance = 0.0; }), "tolerance");
  EXPECT_EQ(rejected([](C& c, O& o) {
              c.axial_depth_m = 0.0;
              o.seconds = 0.05;
            }),
            "accepted");
  EXPECT_EQ(rejected([](C& c, O&) { c.milling.feed_per_tooth_m = 0.0; }), "feed_per_tooth_m");
}

TEST(Simulation, IsRejectedBeforeItRunsWhereItWouldTakeTooMuch) {
  const std::string long_one =
      test::rejection([] { static_cast<void>(simulate(benchmark_cut(0.1, 5000.0, 1e-3), {.seconds = 3600.0})); });
  EXPECT_TRUE(long_one.starts_with("seconds = 3600 s; would take about 9.")) << long_one;
  EXPECT_NE(long_one.find("GB of memory, more than 2 GB"), std::string::npos) << long_one;
  MillingCut quick = benchmark_cut(0.1, 5000.0, 1e-3);
  quick.structure.pole(0) = {-1e4, 6e6};
  EXPECT_EQ(test::field_of([&] { static_cast<void>(simulate(quick, {.seconds = 200.0})); }), "frequency_hz");
}

TEST(Simulation, StopsWhenAsked) {
  std::atomic<bool> stop = true;
  Progress progress({}, &stop);
  EXPECT_THROW(static_cast<void>(simulate(benchmark_cut(0.1, 5000.0, 1e-3), {}, progress)), Interrupted);
}

}  // namespace simulation_test
}  // namespace robomill::simulation
