#include "robomill/modal/frf.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace frf_test {

TEST(FrfName, ReadsAndWritesEveryForm) {
  for (const char* text : {"xx", "xy", "yx", "zz", "1x:3x", "x:my", "ry:x", "ry:my", "12rz:3mz"}) {
    EXPECT_EQ(to_string(parse_frf_name(text)), text);
  }
  const FrfName xy = parse_frf_name("xy");
  EXPECT_EQ(xy.response.axis, Axis::x);
  EXPECT_EQ(xy.excitation.axis, Axis::y);
}

TEST(FrfName, RejectsWhatNamesNoFrf) {
  for (const char* text : {"", "x", "xq", "xyz", "x:", ":x", "-1x:x", "99999999999x:x", "1:2"}) {
    EXPECT_THROW(static_cast<void>(parse_frf_name(text)), InvalidInput) << text;
  }
}

FrfSet two_lines() {
  FrfSet set;
  set.frequency_hz = Eigen::Vector2d(1.0, 2.0);
  set.frfs.push_back({.name = parse_frf_name("xx"), .receptance = Eigen::Vector2cd(1.0, 2.0)});
  return set;
}

TEST(FrfSet, AcceptsAGoodSet) {
  EXPECT_NO_THROW(two_lines().validate());
}

TEST(FrfSet, RejectsEveryFault) {
  FrfSet set = two_lines();
  set.frequency_hz(1) = 1.0;
  EXPECT_THROW(set.validate(), InvalidInput);
  set = two_lines();
  set.frequency_hz(0) = -1.0;
  EXPECT_THROW(set.validate(), InvalidInput);
  set = two_lines();
  set.frfs.front().receptance(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(set.validate(), InvalidInput);
  set = two_lines();
  set.frfs.front().receptance.resize(3);
  EXPECT_THROW(set.validate(), InvalidInput);
  set = two_lines();
  set.frfs.push_back(set.frfs.front());
  EXPECT_THROW(set.validate(), InvalidInput);
  set = two_lines();
  set.frfs.front().coherence = Eigen::VectorXd::Constant(1, 1.0);
  EXPECT_THROW(set.validate(), InvalidInput);
  EXPECT_THROW(FrfSet().validate(), InvalidInput);
}

}  // namespace frf_test
}  // namespace robomill::modal
