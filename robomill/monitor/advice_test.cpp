#include "robomill/monitor/advice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace advice_test {

using namespace robomill;
using namespace robomill::monitor;

constexpr double rpm = std::numbers::pi / 30.0;

// n = 60 f/(N k): 600 Hz and two teeth give 18,000, 9,000, 6,000 … revolutions a minute.
TEST(Advise, NamesSpeedsOfWholePeriodsNearestFirst) {
  const Advice advice = advise(600.0, 2.0, 8000.0 * rpm, 2);
  ASSERT_EQ(advice.speeds.size(), 6U);
  EXPECT_EQ(advice.speeds[0].lobe, 2);
  EXPECT_NEAR(advice.speeds[0].spindle_speed_rad_per_s, 9000.0 * rpm, 1e-9);
  EXPECT_NEAR(advice.speeds[0].std_rad_per_s, 30.0 * rpm, 1e-9);
  EXPECT_NEAR(advice.speeds[1].spindle_speed_rad_per_s, 6000.0 * rpm, 1e-9);
  EXPECT_EQ(advice.mode.number, 0);
  for (const StableSpeed& s : advise(600.0, 2.0, 8000.0 * rpm, 2, nullptr, nullptr,
                                     {.lowest_rad_per_s = 4000.0 * rpm, .highest_rad_per_s = 10000.0 * rpm})
                                  .speeds) {
    EXPECT_GE(s.spindle_speed_rad_per_s, 4000.0 * rpm);
    EXPECT_LE(s.spindle_speed_rad_per_s, 10000.0 * rpm);
  }
}

// Sidebands n f_tooth ± f of each of the robot's modes at 17.40 and 540.08 Hz lead back to it.
TEST(Advise, FoldsSidebandsBackToTheMode) {
  const modal::ModalModel modes = data::robot_modes();
  const double speed = 6500.0 * rpm;
  const double tooth_hz = 325.0;
  for (const auto& [mode, frequency] : {std::pair{1, 17.40}, std::pair{7, 540.08}}) {
    for (const double line : {frequency, 2.0 * tooth_hz + frequency, std::abs(2.0 * tooth_hz - frequency)}) {
      const Advice advice = advise(line, 0.2, speed, 3, &modes);
      EXPECT_EQ(advice.mode.number, mode) << line;
      EXPECT_NEAR(advice.frequency_hz, frequency, 0.1) << line;
      EXPECT_NEAR(advice.expected_hz, frequency, 1e-9) << line;
      EXPECT_EQ(advice.lowest_hz, advice.frequency_hz);
    }
  }
}

// 539.5 Hz lies within the widths of modes 7 and 8; read as a mirror image of mode 8 the vibration is another one: then
// no speed follows from it. Of two equal modes, as equal directions have, either gives the same speeds.
TEST(Advise, NamesNoModeThatCannotBeDetermined) {
  const modal::ModalModel modes = data::robot_modes();
  const Advice open = advise(539.5, 0.2, 6500.0 * rpm, 3, &modes);
  EXPECT_FALSE(open.mode.known());
  EXPECT_EQ(open.frequency_hz, 0.0);
  EXPECT_LE(open.lowest_hz, 539.5);
  EXPECT_TRUE(open.speeds.empty());

  modal::ModalModel twice;
  twice.excitations = twice.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}};
  for (const Eigen::Index axis : {0, 1}) {
    modal::Mode mode;
    mode.frequency_hz = 700.0;
    mode.damping_ratio = 0.01;
    mode.left = mode.right = Eigen::Vector2cd::Unit(axis);
    twice.modes.push_back(mode);
  }
  const Advice either = advise(702.0 + 2.0 * 325.0, 0.2, 6500.0 * rpm, 3, &twice);
  EXPECT_FALSE(either.mode.known());
  EXPECT_NEAR(either.frequency_hz, 702.0, 1e-9);
  EXPECT_FALSE(either.speeds.empty());
}

TEST(Advise, NamesTheWorkpiecesMode) {
  modal::ModalModel part;
  part.excitations = part.responses = {{.axis = modal::Axis::x}};
  modal::Mode mode;
  mode.frequency_hz = 446.0;
  mode.damping_ratio = 0.005;
  mode.left = mode.right = Eigen::VectorXcd::Ones(1);
  part.modes.push_back(mode);
  const modal::ModalModel tool = data::robot_modes();
  const Advice advice = advise(446.5, 0.1, 6500.0 * rpm, 3, &tool, nullptr, {}, part);
  EXPECT_EQ(advice.mode, (modal::ModeId{1, modal::ModeOwner::workpiece}));
  EXPECT_NEAR(advice.expected_hz, 446.0, 1e-12);
}

TEST(Advise, TakesTheDeepestSpeedInRangeOfAChart) {
  stability::LobesResult lobes;
  lobes.axial_depth_m = Eigen::VectorXd::LinSpaced(3, 0.0, 4e-3);
  using Status = stability::Limit::Status;
  for (const auto& [speed, status, depth] :
       {std::tuple{700.0, Status::found, 1e-3}, std::tuple{800.0, Status::found, 3e-3},
        std::tuple{900.0, Status::stable_in_range, 0.0}}) {
    lobes.limit.push_back({.spindle_speed_rad_per_s = speed, .status = status, .axial_depth_m = depth});
  }
  const Advice all = advise(600.0, 1.0, 700.0, 2, nullptr, &lobes);
  ASSERT_TRUE(all.best);
  EXPECT_EQ(all.best->spindle_speed_rad_per_s, 900.0);
  EXPECT_EQ(all.best->axial_depth_m, 4e-3);
  const Advice slower = advise(600.0, 1.0, 700.0, 2, nullptr, &lobes, {.highest_rad_per_s = 850.0});
  ASSERT_TRUE(slower.best);
  EXPECT_EQ(slower.best->axial_depth_m, 3e-3);
}

// A peak that is narrower than the spindle holds its speed is none; between two speeds of the chart the limit lies on
// the line between theirs.
TEST(Advise, TakesTheLowestLimitOfTheWindow) {
  stability::LobesResult lobes;
  lobes.axial_depth_m = Eigen::VectorXd::LinSpaced(3, 0.0, 9e-3);
  for (const auto& [speed, depth] :
       {std::pair{700.0, 2e-3}, {800.0, 3e-3}, {810.0, 8e-3}, {820.0, 2.9e-3}, {900.0, 3.5e-3}}) {
    lobes.limit.push_back(
        {.spindle_speed_rad_per_s = speed, .status = stability::Limit::Status::found, .axial_depth_m = depth});
  }
  EXPECT_EQ(advise(600.0, 1.0, 700.0, 2, nullptr, &lobes).best->spindle_speed_rad_per_s, 810.0);
  const Advice safe = advise(600.0, 1.0, 700.0, 2, nullptr, &lobes, {.speed_window = 0.02});
  EXPECT_EQ(safe.best->spindle_speed_rad_per_s, 900.0);
  EXPECT_NEAR(safe.best->axial_depth_m, 3.5e-3 - (0.02 * 900.0 / 80.0) * 0.6e-3, 1e-12);
  EXPECT_THROW((void)advise(600.0, 1.0, 700.0, 2, nullptr, &lobes, {.speed_window = 0.5}), InvalidInput);
}

// In the deeper pocket forced vibration is the lower limit, which needs no margin: the other one is taken. Of the
// speeds of whole periods those are left out at which the cut, which is as deep as the limit at 700 rad/s at least,
// vibrates too much.
TEST(Advise, KeepsForcedVibrationWithinTheFeed) {
  stability::LobesResult lobes;
  lobes.axial_depth_m = Eigen::VectorXd::LinSpaced(3, 0.0, 9e-3);
  for (const auto& [speed, depth] :
       {std::pair{700.0, 2e-3}, {800.0, 8e-3}, {900.0, 2e-3}, {1000.0, 4e-3}, {1100.0, 2e-3}}) {
    lobes.limit.push_back(
        {.spindle_speed_rad_per_s = speed, .status = stability::Limit::Status::found, .axial_depth_m = depth});
  }
  const double first_hz = 800.0 * 2.0 / (2.0 * std::numbers::pi);  // tooth passing at 800 rad/s
  const auto advised = [&](const std::vector<double>& vibration_m, double window = 0.0) {
    return advise(first_hz, 1.0, 700.0, 2, nullptr, &lobes,
                  {.speed_window = window, .depth_margin = 0.25, .vibration_depth_m = vibration_m});
  };
  const Advice chatter = advised({9e-3, 9e-3, 9e-3, 9e-3, 9e-3});
  EXPECT_EQ(chatter.best->spindle_speed_rad_per_s, 800.0);
  EXPECT_NEAR(chatter.best->axial_depth_m, 6e-3, 1e-15);
  EXPECT_FALSE(chatter.best_vibrates);
  EXPECT_EQ(chatter.vibrating_speeds, 0);
  const Advice both = advised({9e-3, 1e-3, 9e-3, 9e-3, 9e-3});
  EXPECT_EQ(both.best->spindle_speed_rad_per_s, 1000.0);
  EXPECT_NEAR(both.best->axial_depth_m, 3e-3, 1e-15);
  EXPECT_FALSE(both.best_vibrates);
  EXPECT_EQ(both.vibrating_speeds, 1);
  for (const StableSpeed& speed : both.speeds) EXPECT_GT(speed.lobe, 1);
  const Advice vibrates = advised({9e-3, 5e-3, 9e-3, 9e-3, 9e-3});
  EXPECT_EQ(vibrates.best->spindle_speed_rad_per_s, 800.0);
  EXPECT_NEAR(vibrates.best->axial_depth_m, 5e-3, 1e-15);
  EXPECT_TRUE(vibrates.best_vibrates);
  EXPECT_EQ(vibrates.vibrating_speeds, 0);
  // Over the window the limit beside a speed counts, on the line to the next.
  EXPECT_NEAR(advised({9e-3, 5e-3, 1e-3, 9e-3, 9e-3}, 0.05).best->axial_depth_m, 3.4e-3, 1e-15);
  EXPECT_THROW((void)advised({9e-3}), InvalidInput);
}

/// Modes of the tool at these frequencies, 0.5 % of damping each.
modal::ModalModel modes_at(const std::vector<double>& frequencies_hz) {
  modal::ModalModel model;
  model.excitations = model.responses = {{.axis = modal::Axis::x}};
  for (const double frequency_hz : frequencies_hz) {
    modal::Mode mode;
    mode.frequency_hz = frequency_hz;
    mode.damping_ratio = 0.005;
    mode.left = mode.right = Eigen::VectorXcd::Ones(1);
    model.modes.push_back(mode);
  }
  return model;
}

// Without a filter 989 Hz sampled at 1,650 Hz shows up at 661 Hz. At 115 rotations a second neither line is a sideband
// of the other mode.
TEST(Advise, NamesTheAliasThatAloneFitsTheModes) {
  const AdviceOptions unfiltered{.unfiltered_sample_rate_hz = 1650.0};
  const auto advised = [](const std::vector<double>& frequencies_hz, const AdviceOptions& options) {
    const modal::ModalModel modes = modes_at(frequencies_hz);
    return advise(661.0, 0.2, 6900.0 * rpm, 2, &modes, nullptr, options);
  };
  for (const double line_hz : {661.0, 989.0, 2311.0}) {
    const Advice alone = advised({line_hz}, unfiltered);
    EXPECT_EQ(alone.line_hz, std::vector<double>{line_hz});
    EXPECT_EQ(alone.mode.number, 1);
    EXPECT_NEAR(alone.frequency_hz, line_hz, 1e-9);
    ASSERT_FALSE(alone.speeds.empty());
    const StableSpeed& nearest = alone.speeds.front();
    EXPECT_NEAR(nearest.spindle_speed_rad_per_s, 60.0 * line_hz / (2.0 * nearest.lobe) * rpm, 1e-9);
    // With a filter the line is where it was measured: the mode elsewhere does not explain it.
    const Advice filtered = advised({line_hz}, {});
    EXPECT_EQ(filtered.line_hz, std::vector<double>{661.0});
    EXPECT_EQ(filtered.mode.known(), line_hz == 661.0);
    EXPECT_NEAR(filtered.frequency_hz, 661.0, 1e-9);
  }
  for (const std::vector<double>& both : {std::vector{661.0, 989.0}, {661.0, 2311.0}, {989.0, 2311.0}}) {
    const Advice open = advised(both, unfiltered);
    EXPECT_EQ(open.line_hz, both);
    EXPECT_FALSE(open.mode.known());
    EXPECT_TRUE(open.speeds.empty());
    EXPECT_EQ(open.frequency_hz, 0.0);
    EXPECT_EQ(open.lowest_hz, 0.0);
  }
  EXPECT_EQ(advised({661.0, 989.0}, {}).mode.number, 1);
}

// As measured: 529 Hz and four rotations of 115 Hz, folded at 1,650 Hz.
TEST(Advise, AddsTheMultiplesOfRotationToTheUnfoldedLine) {
  const modal::ModalModel modes = modes_at({529.0});
  const Advice advice = advise(661.0, 0.2, 6900.0 * rpm, 2, &modes, nullptr, {.unfiltered_sample_rate_hz = 1650.0});
  EXPECT_EQ(advice.line_hz, std::vector<double>{989.0});
  EXPECT_EQ(advice.mode.number, 1);
  EXPECT_NEAR(advice.frequency_hz, 529.0, 1e-9);
}

// No mode near, or none given: nothing says which alias it is, and no chart helps.
TEST(Advise, NamesNoSpeedOfALineThatMayBeFolded) {
  const modal::ModalModel modes = modes_at({60.0});
  stability::LobesResult lobes;
  lobes.limit.push_back({.spindle_speed_rad_per_s = 700.0, .status = stability::Limit::Status::found});
  for (const modal::ModalModel* given : {&modes, static_cast<const modal::ModalModel*>(nullptr)}) {
    const Advice advice = advise(661.0, 0.2, 6900.0 * rpm, 2, given, &lobes, {.unfiltered_sample_rate_hz = 1650.0});
    EXPECT_EQ(advice.line_hz, (std::vector{661.0, 989.0, 2311.0}));
    EXPECT_TRUE(advice.speeds.empty());
    EXPECT_FALSE(advice.best);
  }
}

// At 10,240 Hz the aliases of each line lie ten tooth passings and more above all modes of the robot: it is what it is
// without a filter, too. At the end of what can be sampled no alias is out of range.
TEST(Advise, NeedsNoFilterFarAboveTheModes) {
  const modal::ModalModel modes = data::robot_modes();
  for (const double line_hz : {17.4, 540.08, 650.0 - 17.4}) {
    for (const double rate_hz : {10'240.0, 1e6}) {
      const Advice filtered = advise(line_hz, 0.2, 6500.0 * rpm, 3, &modes);
      const Advice advice =
          advise(line_hz, 0.2, 6500.0 * rpm, 3, &modes, nullptr, {.unfiltered_sample_rate_hz = rate_hz});
      EXPECT_EQ(advice.mode, filtered.mode) << line_hz;
      EXPECT_EQ(advice.line_hz, std::vector<double>{line_hz});
      EXPECT_EQ(advice.frequency_hz, filtered.frequency_hz) << line_hz;
    }
  }
}

TEST(Advise, RejectsWhatMakesNoSense) {
  const modal::ModalModel modes = data::robot_modes();
  EXPECT_EQ(test::field_of([] { static_cast<void>(advise(0.0, 1.0, 700.0, 2)); }), "frequency_hz");
  EXPECT_EQ(test::field_of([] { static_cast<void>(advise(600.0, -1.0, 700.0, 2)); }), "std_hz");
  EXPECT_EQ(test::field_of([] { static_cast<void>(advise(600.0, 1.0, 700.0, 0)); }), "teeth");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(advise(600.0, 1.0, 0.0, 2, &modes)); }), "spindle_speed_rad_per_s");
  EXPECT_EQ(test::field_of([] {
              static_cast<void>(advise(600.0, 1.0, 700.0, 2, nullptr, nullptr,
                                       {.lowest_rad_per_s = 900.0, .highest_rad_per_s = 800.0}));
            }),
            "highest_rad_per_s");
  const auto unfiltered = [](double rate_hz) {
    return test::field_of([=] {
      static_cast<void>(advise(600.0, 1.0, 700.0, 2, nullptr, nullptr, {.unfiltered_sample_rate_hz = rate_hz}));
    });
  };
  EXPECT_EQ(unfiltered(-1.0), "unfiltered_sample_rate_hz");
  EXPECT_EQ(unfiltered(NAN), "unfiltered_sample_rate_hz");
  EXPECT_EQ(unfiltered(600.0), "frequency_hz");
}

}  // namespace advice_test
