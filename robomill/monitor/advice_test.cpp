#include "robomill/monitor/advice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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
}

}  // namespace advice_test
