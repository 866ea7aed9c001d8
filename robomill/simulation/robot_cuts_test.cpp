// How many teeth cut in [RobotMillingChatter], which does not print it: three readings against its table 4-5, its text
// and its spectra. docs/errata.md has the figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "robomill/stability/lobes.hpp"
#include "testing/simulation/cuts.hpp"

namespace robomill::simulation {
namespace robot_cuts_test {

using stability::Limit;
using testing::rpm;

constexpr double none = std::numeric_limits<double>::infinity();  // stable to 5 mm, where the search ends

stability::LobesProblem robot_with(int teeth) {
  stability::LobesProblem problem = stability::testing::robot();
  problem.milling.tool.teeth = teeth;
  return problem;
}

std::vector<Limit> limits_of(int teeth, std::vector<double> speeds_rpm) {
  stability::LobesOptions options;
  options.axial_depth_m = {0.0, 5e-3};
  options.grid = {2, 100};
  for (double& speed : speeds_rpm) speed *= rpm;
  return limit_depths(robot_with(teeth), options, speeds_rpm);
}

double depth_mm(const Limit& limit) {
  return limit.status == Limit::Status::found ? 1e3 * limit.axial_depth_m : none;
}

/// Ranks from 1; equal values share the mean of theirs.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<double> out;
  for (const double value : values) {
    const auto below = std::ranges::count_if(values, [&](double other) { return other < value; });
    const auto equal = std::ranges::count(values, value);
    out.push_back(static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1));
  }
  return out;
}

/// Spearman's rank correlation.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const std::vector<double> x = ranks(a), y = ranks(b);
  const double mean = 0.5 * static_cast<double>(a.size() + 1);
  double xy = 0.0, xx = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    xy += (x[i] - mean) * (y[i] - mean);
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  return xy / std::sqrt(xx * yy);
}

// The speeds of table 4-5 and, at each, the middle of the depths that were cut.
const std::vector<double> speeds_rpm = {5000, 5500, 6500, 8000, 9500, 11000, 12500, 15000};
const std::vector<double> middle_mm = {0.75, 1.1, 0.7, 1.15, 0.75, 0.65, 0.75, 1.2};

struct Reading {
  int teeth = 0;
  std::vector<double> limit_mm;
  double correlation = 0.0;  // of the limits with the depths that were cut
};

// A study cuts about the limits that it expects: deeper where its pockets are.
TEST(RobotCuts, DepthsThatWereCutFollowThePocketsOfTwoTeeth) {
  const Reading readings[] = {{2, {1.58, 1.68, 0.85, none, 0.48, 0.54, 2.09, none}, 0.80},
                              {3, {2.00, 1.69, 0.30, 0.87, 3.92, 3.30, 0.65, 0.33}, -0.27},
                              {4, {0.23, 0.31, 1.43, none, 0.45, 0.26, 0.23, 0.26}, 0.22}};
  for (const Reading& reading : readings) {
    std::vector<double> found_mm;
    for (const Limit& limit : limits_of(reading.teeth, speeds_rpm)) found_mm.push_back(depth_mm(limit));
    for (std::size_t i = 0; i < speeds_rpm.size(); ++i) {
      if (reading.limit_mm[i] == none) {
        EXPECT_EQ(found_mm[i], none) << reading.teeth << ' ' << speeds_rpm[i];
      } else {
        EXPECT_NEAR(found_mm[i], reading.limit_mm[i], 0.01) << reading.teeth << ' ' << speeds_rpm[i];
      }
    }
    EXPECT_NEAR(rank_correlation(found_mm, middle_mm), reading.correlation, 0.01) << reading.teeth;
  }
}

// With two teeth 6,500 rpm stands 0.15 % beside a lobe of period doubling: 541.7 Hz, where modes 7 and 8 are, is 2.5
// times tooth passing, and 324.99 Hz is 1.5 times. There the limit lies below the two depths that the source has
// chattering.
TEST(RobotCuts, TwoTeethDoubleTheirPeriodBeside6500Rpm) {
  const std::vector<Limit> limits = limits_of(2, {6500.0, 6510.0, 6550.0});
  EXPECT_EQ(limits[0].kind, stability::BifurcationType::hopf);
  EXPECT_NEAR(depth_mm(limits[0]), 0.85, 0.01);
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_EQ(limits[i].kind, stability::BifurcationType::flip);
    EXPECT_LT(depth_mm(limits[i]), 0.6);
    const double tooth_passing_hz = limits[i].spindle_speed_rad_per_s / (2.0 * std::numbers::pi) * 2.0;
    EXPECT_NEAR(limits[i].chatter_frequency_hz / tooth_passing_hz, 2.5, 1e-6);
  }
  // The simulation, which shares no code with the lobes.
  const SmallVibration small = small_vibration(testing::cut_of(robot_with(2), 6550.0, 0.8e-3, 1e-5));
  ASSERT_EQ(small.status, SmallVibration::Status::found);
  EXPECT_LT(small.multiplier.real(), -1.0);
  EXPECT_NEAR(small.multiplier.imag(), 0.0, 1e-3);
}

/// Amplitude of the acceleration in x at a multiple of rotation, over the last whole revolutions [m/s²].
double amplitude(const Simulation& cut, double rotation_hz, int multiple) {
  const auto samples = static_cast<Eigen::Index>(std::lround(40.0 / rotation_hz * cut.sample_rate_hz));
  const Eigen::VectorXd x = cut.acceleration_m_per_s2.col(0).tail(samples);
  std::complex<double> sum = 0.0;
  for (Eigen::Index i = 0; i < samples; ++i) {
    const double turn = multiple * rotation_hz * static_cast<double>(i) / cut.sample_rate_hz;
    sum += x(i) * std::polar(1.0, -2.0 * std::numbers::pi * turn);
  }
  return 2.0 * std::abs(sum) / static_cast<double>(samples);
}

// Three rotations are no multiple of two teeth's passing. Period doubling puts a line there, and so does runout in a
// cut that does not chatter: the peak alone does not distinguish the two.
TEST(RobotCuts, PeriodDoublingAndRunoutBothPutALineAtThreeRotations) {
  const double speed_rpm = 6550.0, rotation_hz = speed_rpm / 60.0;
  const SimulationOptions options = {.seconds = 3.0, .sample_rate_hz = 240.0 * rotation_hz / 4.0};
  const auto lines = [&](double depth_m, double runout_m) {
    MillingCut cut = testing::cut_of(robot_with(2), speed_rpm, depth_m, 1e-5);
    cut.milling.tool.runout_m = runout_m;
    const Simulation done = simulate(cut, options);
    return std::array<double, 2>{amplitude(done, rotation_hz, 2), amplitude(done, rotation_hz, 3)};
  };
  const auto [quiet_tooth, quiet_three] = lines(0.2e-3, 0.0);
  const auto [doubled_tooth, doubled_three] = lines(0.8e-3, 0.0);
  const auto [runout_tooth, runout_three] = lines(0.2e-3, 3e-6);
  EXPECT_LT(quiet_three, 0.01 * quiet_tooth);
  EXPECT_GT(doubled_three, 0.2 * doubled_tooth);
  EXPECT_GT(runout_three, 0.2 * runout_tooth);
}

}  // namespace robot_cuts_test
}  // namespace robomill::simulation
