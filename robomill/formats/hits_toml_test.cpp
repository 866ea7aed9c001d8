#include "robomill/formats/hits_toml.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/formats/test_files.hpp"

namespace robomill::formats {
namespace {

const std::string record = "time_s,force_v,ax,ay\n0,0,1,2\n0.001,0.5,3,4\n0.002,0,5,6\n";

TEST(HitsToml, TurnsVoltsIntoUnitsAndNamesDirections) {
  const testing::Folder folder;
  static_cast<void>(folder.file("a.csv", record));
  const HitsFile file = read_hits(folder.file("hits.toml", R"([acquisition]
response = "acceleration"
estimator = "Hv"
accelerometer_mass_kg = 0.004
force_mv_per_n = 2.5
response_mv_per_m_per_s2 = 10
[[hits]]
file = "a.csv"
time = "time_s"
force = "force_v"
force_direction = "-x"
responses = { x = "ax", -y = 4 }
)"));
  ASSERT_EQ(file.hits.size(), 1U);
  const modal::Hit& hit = file.hits[0];
  EXPECT_EQ(hit.excitation.axis, modal::Axis::x);
  EXPECT_TRUE(hit.against_axis);
  EXPECT_NEAR(hit.sample_rate_hz, 1000.0, 1e-6);
  EXPECT_DOUBLE_EQ(hit.force_n(1), 0.5 * 1000.0 / 2.5);
  ASSERT_EQ(hit.responses.size(), 2U);
  for (const modal::HitChannel& channel : hit.responses) {
    const bool y = channel.dof.axis == modal::Axis::y;
    EXPECT_EQ(channel.against_axis, y);
    EXPECT_DOUBLE_EQ(channel.samples(1), (y ? 4.0 : 3.0) * 100.0);
  }
  EXPECT_EQ(file.options.estimator, modal::Estimator::hv);
  EXPECT_EQ(file.options.accelerometer_mass_kg, 0.004);
}

TEST(HitsToml, TakesTheRateFromTheFileWhereThereIsNoTime) {
  const testing::Folder folder;
  static_cast<void>(folder.file("b.txt", "0 1\n2 3\n0 5\n"));
  const std::string row = "[[hits]]\nfile = \"b.txt\"\nforce = 1\nforce_direction = \"y\"\nresponses = { y = 2 }\n";
  const HitsFile file = read_hits(folder.file("hits.toml", "[acquisition]\nsample_rate_hz = 51200\n" + row));
  EXPECT_EQ(file.hits[0].sample_rate_hz, 51200.0);
  EXPECT_EQ(file.hits[0].responses[0].samples(2), 5.0);
  const std::string said =
      testing::refusal([&] { static_cast<void>(read_hits(folder.file("none.toml", "[acquisition]\n" + row))); });
  EXPECT_NE(said.find("sample_rate_hz is missing"), std::string::npos) << said;
}

TEST(HitsToml, RefusesInTheFilesWords) {
  const testing::Folder folder;
  static_cast<void>(folder.file("a.csv", record));
  const std::string row =
      "[[hits]]\nfile = \"a.csv\"\nforce = \"force_v\"\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n";
  const auto say = [&](const std::string& text) {
    return testing::refusal([&] { static_cast<void>(read_hits(folder.file("hits.toml", text))); });
  };
  EXPECT_NE(say("[acquisition]\naccelerometer_mass_kg = -1\n" + row)
                .find("hits.toml:2: acquisition.accelerometer_mass_kg = -1 kg"),
            std::string::npos);
  EXPECT_NE(say("[acquisition]\n").find("[[hits]]"), std::string::npos);
  EXPECT_NE(say("[acquisition]\nforce_mv_per_n = 0\n" + row).find("calibration"), std::string::npos);
  EXPECT_NE(say("[acquisition]\nsample_rate_hz = 2000\n" + row).find("1000 Hz"), std::string::npos);
  EXPECT_NE(say("[[hits]]\nfile = \"a.csv\"\nforce = \"f\"\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n")
                .find("force_v"),
            std::string::npos);
  EXPECT_NE(say("[[hits]]\nfile = \"a.csv\"\nforce = 2\nforce_direction = \"q\"\nresponses = { x = \"ax\" }\n")
                .find("direction"),
            std::string::npos);
  EXPECT_NE(say("[[hits]]\nfile = \"none.csv\"\nforce = 2\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n")
                .find("none.csv"),
            std::string::npos);
  EXPECT_NE(say("[acquisition]\nfilter = 3\n" + row).find("filter"), std::string::npos);
}

}  // namespace
}  // namespace robomill::formats
