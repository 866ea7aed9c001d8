#include "robomill/io/key_unit.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "robomill/base/units.hpp"

namespace robomill::io {
namespace key_unit_test {

TEST(KeyUnit, IsWhatTheEndOfAKeySays) {
  EXPECT_EQ(unit_of_key("coefficients.tangential_n_per_mm2"), "N/mm^2");
  EXPECT_EQ(unit_of_key("tangential_edge_n_per_mm"), "N/mm");
  EXPECT_EQ(unit_of_key("cut.axial_depth_mm[1]"), "mm");
  EXPECT_EQ(unit_of_key("spindle_speed_rpm"), "rpm");
  EXPECT_EQ(unit_of_key("feed_per_tooth_mm"), "mm");
  EXPECT_EQ(unit_of_key("youngs_modulus_gpa"), "GPa");
  EXPECT_EQ(unit_of_key("density_kg_per_m3"), "kg/m^3");
  EXPECT_EQ(unit_of_key("joint_stiffness_n_m_per_rad"), "N m/rad");
  EXPECT_EQ(unit_of_key("rotational_damping_n_m_s_per_rad"), "N m s/rad");
  EXPECT_EQ(unit_of_key("response_mv_per_m_per_s2"), "mV/(m/s^2)");
  EXPECT_EQ(unit_of_key("max_jerk_mm_per_s3"), "mm/s^3");
  EXPECT_EQ(unit_of_key("feed_mm_per_min"), "mm/min");
  EXPECT_EQ(unit_of_key("false_alarms_per_hour"), "1/h");
  EXPECT_EQ(unit_of_key("power_kw"), "kW");
  EXPECT_EQ(unit_of_key("damping_ratio"), "");
  EXPECT_EQ(unit_of_key("teeth"), "");
  EXPECT_EQ(unit_of_key("n"), "");
}

struct Case {
  const char* key;
  const char* member;
  double factor;
};

// The factors are those of base/units.hpp to the last bit: what is converted by a row is what was converted by hand.
TEST(KeyUnit, NamesTheMemberInSi) {
  for (const auto& [key, member, factor] : {Case{"diameter_mm", "diameter_m", units::mm},
                                            {"runout_um", "runout_m", units::um},
                                            {"helix_deg", "helix_rad", units::deg},
                                            {"spindle_speed_rpm", "spindle_speed_rad_per_s", units::rpm},
                                            {"spindle_ramp_rpm_per_s", "spindle_ramp_rad_per_s2", units::rpm},
                                            {"tangential_n_per_mm2", "tangential_n_per_m2", units::n_per_mm2},
                                            {"tangential_edge_n_per_mm", "tangential_edge_n_per_m", units::n_per_mm},
                                            {"indentation_n_per_mm3", "indentation_n_per_m3", units::n_per_mm3},
                                            {"feed_mm_per_min", "feed_m_per_s", units::mm / units::minute},
                                            {"removal_rate_mm3_per_s", "removal_rate_m3_per_s", units::mm3},
                                            {"max_jerk_deg_per_s3", "max_jerk_rad_per_s3", units::deg},
                                            {"window_ms", "window_s", units::ms},
                                            {"power_kw", "power_w", units::kw},
                                            {"frequency_hz", "frequency_hz", 1.0},
                                            {"damping_ratio", "damping_ratio", 1.0},
                                            {"teeth", "teeth", 1.0}}) {
    const KeyUnit unit = key_unit(key);
    EXPECT_EQ(unit.member, member) << key;
    EXPECT_EQ(unit.factor, factor) << key;
  }
}

}  // namespace key_unit_test
}  // namespace robomill::io
