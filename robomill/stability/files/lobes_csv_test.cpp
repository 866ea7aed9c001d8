#include "robomill/stability/files/lobes_csv.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "robomill/base/units.hpp"

namespace robomill::stability {
namespace lobes_csv_test {

LobesResult two_limits() {
  LobesResult r;
  r.limit.resize(2);
  r.limit[0].spindle_speed_rad_per_s = 4000.0 * units::rpm;
  r.limit[1] = {16000.0 * units::rpm, Limit::Status::found, 2.5e-3, 540.0, BifurcationType::hopf, {8}, 3e-7};
  return r;
}

TEST(LimitsCsv, HasARowASpeed) {
  EXPECT_EQ(limits_csv(two_limits()),
            "spindle_speed_rpm,axial_depth_mm,chatter_frequency_hz,kind,mode,mode_of,error_estimate\n"
            "4000,,,,,,\n16000,2.5,540,hopf,8,tool,3e-07\n");
}

// Between the speeds of the samples the band is a straight line; beside an open end it is not known.
TEST(LimitsCsv, HasTheBandAtTheSpeedsOfTheLimit) {
  LobesResult result = two_limits();
  result.limit[0].spindle_speed_rad_per_s = 12000.0 * units::rpm;
  UncertainLimits band;
  band.samples = 20;
  band.spindle_speed_rad_per_s = Eigen::Vector3d(8000.0, 14000.0, 16000.0) * units::rpm;
  band.limit_5_percent_m = Eigen::Vector3d(1e-3, 2.5e-3, 2e-3);
  band.limit_50_percent_m = Eigen::Vector3d(2e-3, 2e-3, 2.4e-3);
  band.limit_95_percent_m = Eigen::Vector3d(std::numeric_limits<double>::infinity(), 2e-3, 3e-3);
  EXPECT_EQ(limits_csv(result, band),
            "spindle_speed_rpm,axial_depth_mm,chatter_frequency_hz,kind,mode,mode_of,error_estimate,"
            "limit_5_percent_mm,limit_50_percent_mm,limit_95_percent_mm\n"
            "12000,,,,,,,2,2,\n16000,2.5,540,hopf,8,tool,3e-07,2,2.4,3\n");
}

TEST(PointsCsv, HasARowAPoint) {
  PointResult point;
  point.spindle_speed_rad_per_s = 6500.0 * units::rpm;
  point.axial_depth_m = 0.6e-3;
  point.limit_depth_m = 0.5e-3;
  point.spectral_radius = 1.125;
  point.error_estimate = 1e-7;
  point.chatter_frequency_hz = 563.5;
  point.mode = {2, modal::ModeOwner::workpiece};
  EXPECT_EQ(points_csv({point}),
            "spindle_speed_rpm,axial_depth_mm,limit_depth_mm,stable,spectral_radius,error_estimate,gain_margin,"
            "dominant_frequency_hz,kind,mode,mode_of\n6500,0.6,0.5,false,1.125,1e-07,,563.5,hopf,2,workpiece\n");
  EXPECT_EQ(points_csv({point}, SweptParameter::radial_depth).rfind("spindle_speed_rpm,radial_depth_mm,stable,", 0),
            0U);
}

TEST(SweepCsv, HasARowAnInterval) {
  SweepResult sweep;
  sweep.parameter = SweptParameter::lead;
  sweep.spindle_speed_rad_per_s = Eigen::Vector2d(4000.0, 8000.0) * units::rpm;
  sweep.stable = {{}, {{-10.0 * units::deg, 5.0 * units::deg}, {20.0 * units::deg, 25.0 * units::deg}}};
  EXPECT_EQ(sweep_csv(sweep), "spindle_speed_rpm,from_lead_deg,to_lead_deg\n4000,,\n8000,-10,5\n8000,20,25\n");
}

TEST(ComparisonCsv, HasARowAMethod) {
  MethodComparison comparison;
  comparison.rows.resize(2);
  comparison.rows[0].limits = two_limits().limit;
  comparison.rows[0].seconds = 0.5;
  comparison.rows[1].method = Method::full_discretization;
  comparison.rows[1].rejection = "needs \"equal\" pitch";
  EXPECT_EQ(comparison_csv(comparison),
            "method,lowest_limit_mm,median_error,worst_error,differ,seconds,rejection\ncollocation,2.5,0,0,0,0.5,\n"
            "full-discretization,,,,,,\"needs \"\"equal\"\" pitch\"\n");
}

}  // namespace lobes_csv_test
}  // namespace robomill::stability
