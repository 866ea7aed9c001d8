#include "robomill/path/files/setpoint_lines.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/table.hpp"

namespace robomill::path {
namespace setpoint_lines_test {

Setpoint random_setpoint(Random& random) {
  Setpoint out;
  out.sample.time_s = random.uniform(0.0, 1e4);
  for (int j = 0; j < 6; ++j) out.sample.joints[j] = random.normal();
  out.sample.tip_m = {random.normal(), 1e-9 * random.normal(), random.normal()};
  out.sample.axis = {random.normal(), random.normal(), 1.0};
  out.sample.block = random.index(100'000);
  out.feed_override = random.uniform(0.0, 1.5);
  out.state = PathInterpolator::State::holding;
  return out;
}

// What is read back is the same number, in both formats.
TEST(SetpointLines, ReadBackTheSame) {
  Random random(1, 51);
  EXPECT_EQ(setpoint_header(SetpointFormat::json, 6), "");
  EXPECT_EQ(setpoint_header(SetpointFormat::csv, 5),
            "time_s,q1,q2,q3,q4,q5,x_mm,y_mm,z_mm,i,j,k,block,override,state\n");
  for (int n = 0; n < 200; ++n) {
    const Setpoint point = random_setpoint(random);
    const int joints = n % 2 == 0 ? 6 : 5;
    std::string json, csv;
    append_setpoint(json, point, SetpointFormat::json, joints);
    append_setpoint(csv, point, SetpointFormat::csv, joints);
    EXPECT_EQ(json.find('\n'), json.size() - 1);
    const auto read = nlohmann::json::parse(json);
    EXPECT_EQ(read["time_s"], point.sample.time_s);
    ASSERT_EQ(read["joints"].size(), static_cast<std::size_t>(joints));
    std::vector<std::string> cells = io::split_texts(csv.substr(0, csv.size() - 1), ',');
    ASSERT_EQ(cells.size(), static_cast<std::size_t>(joints) + 10);
    for (int j = 0; j < joints; ++j) {
      EXPECT_EQ(read["joints"][static_cast<std::size_t>(j)], point.sample.joints[j]);
      EXPECT_EQ(std::stod(cells[static_cast<std::size_t>(j) + 1]), point.sample.joints[j]);
    }
    EXPECT_EQ(read["tip_mm"][1], point.sample.tip_m.y() / 1e-3);
    EXPECT_EQ(read["axis"][2], 1.0);
    EXPECT_EQ(read["block"], point.sample.block + 1);
    EXPECT_EQ(read["override"], point.feed_override);
    EXPECT_EQ(read["state"], "holding");
    EXPECT_EQ(cells.back(), "holding");
    EXPECT_EQ(std::stod(cells[cells.size() - 2]), point.feed_override);
  }
}

TEST(SetpointLines, FormatByTheEnding) {
  EXPECT_EQ(setpoint_format_of("a.csv"), SetpointFormat::csv);
  EXPECT_EQ(setpoint_format_of("a.CSV"), SetpointFormat::csv);
  EXPECT_EQ(setpoint_format_of("a.jsonl"), SetpointFormat::json);
  EXPECT_EQ(setpoint_format_of("/run/robot"), SetpointFormat::json);
}

}  // namespace setpoint_lines_test
}  // namespace robomill::path
