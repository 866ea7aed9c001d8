#include "robomill/simulation/files/simulation_files.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "robomill/base/error.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/records/records.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace simulation_files_test {

Simulation sample(bool with_z) {
  Simulation s;
  s.sample_rate_hz = 10240.0;
  s.displacement_m.setZero(50, 3);
  s.acceleration_m_per_s2.setZero(50, 3);
  s.force_n.setZero(50, 3);
  for (Eigen::Index i = 0; i < 50; ++i) {
    const double t = static_cast<double>(i);
    s.displacement_m.row(i) << 1e-6 * t, -2e-7 * t * t, with_z ? 1e-8 * t : 0.0;
    s.acceleration_m_per_s2.row(i) << 3.5 * t, -1234.5678 + t, with_z ? t : 0.0;
    s.force_n.row(i) << 10.0 * t, -5.0, 0.25;
  }
  return s;
}

// What is written comes back through the readers that every verb uses.
TEST(SimulationFiles, ComeBackAsRecords) {
  const test::Folder folder;
  for (const bool with_z : {false, true}) {
    const Simulation s = sample(with_z);
    for (const char* name : {"simulation_files.csv", "simulation_files.mat"}) {
      const auto path = folder.at(name);
      write_simulation(path, s);
      const io::Record record = io::read_record(path);
      EXPECT_NEAR(record.sample_rate_hz, 10240.0, 1e-3);
      EXPECT_EQ(record.columns.size(), with_z ? 10U : 8U);
      EXPECT_LT((record.column("x_m") - s.displacement_m.col(0)).cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_LT((record.column("ay_m_per_s2") - s.acceleration_m_per_s2.col(1)).cwiseAbs().maxCoeff(), 1e-5);
      EXPECT_LT((record.column("fz_n") - s.force_n.col(2)).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
  const auto path = folder.at("simulation_files.wav");
  write_simulation(path, sample(false));
  const io::Record record = io::read_record(path);
  EXPECT_EQ(record.sample_rate_hz, 10240.0);
  ASSERT_EQ(record.columns.size(), 2U);
  EXPECT_LT((record.columns[1] - sample(false).acceleration_m_per_s2.col(1)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(SimulationFiles, RejectsWhatItCannotWrite) {
  const test::Folder folder;
  Simulation s = sample(false);
  EXPECT_THROW(write_simulation(folder.at("simulation_files.uff"), s), InvalidInput);
  EXPECT_THROW(write_simulation("/nowhere/at/all.csv", s), InvalidInput);
  s.sample_rate_hz = 1000.5;
  EXPECT_THROW(write_simulation(folder.at("simulation_files.wav"), s), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder.at("simulation_files.wav")));
}

TEST(SimulationFiles, JsonSaysNullForNone) {
  Simulation s = sample(false);
  s.verdict = Verdict::stable;
  io::Json json = io::Json::parse(simulation_json(s, 680.0, 1e-3));
  EXPECT_EQ(json["verdict"], "stable");
  EXPECT_TRUE(json["chatter_frequency_hz"].is_null());
  EXPECT_TRUE(json["small_vibration"].is_null());
  EXPECT_EQ(json["vibrating_peak_n"][0], 490.0);
  EXPECT_FALSE(json.contains("peak_force_n")) << "of the rigid cutter, in forces.json";
  s.verdict = Verdict::chatter;
  s.chatter_frequency_hz = 933.9;
  s.walls.push_back({.angle_rad = 0.0, .location_error_m = 2e-6, .ra_m = 1e-7});
  json = io::Json::parse(simulation_json(s, 680.0, 1e-3));
  EXPECT_EQ(json["chatter_frequency_hz"], 933.9);
  EXPECT_EQ(json["walls"][0]["location_error_um"], 2.0);
}

}  // namespace simulation_files_test
}  // namespace robomill::simulation
