#include "robomill/modal/directions.hpp"

#include <gtest/gtest.h>

#include <string>

#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace directions_test {

ModalModel one_direction(Axis axis) {
  ModalModel one;
  one.excitations = one.responses = {{.axis = axis}};
  one.modes = {{.frequency_hz = 500.0,
                .damping_ratio = 0.02,
                .left = Eigen::VectorXcd::Constant(1, 0.01),
                .right = Eigen::VectorXcd::Constant(1, std::complex<double>(0.0, -0.01))}};
  return one;
}

TEST(EqualDirections, DoublesTheMeasuredOne) {
  const ModalModel one = one_direction(Axis::x);
  const ModalModel both = with_equal_directions(one);
  const Eigen::Vector2d frequency_hz(100.0, 499.0);
  const FrfSet measured = synthesize(one, frequency_hz);
  const FrfSet planar = synthesize(both, frequency_hz);
  for (const char* name : {"xx", "yy"}) {
    EXPECT_LT((planar.find(parse_frf_name(name))->receptance - measured.frfs[0].receptance).norm(), 1e-18);
    EXPECT_EQ(with_equal_directions(measured).find(parse_frf_name(name))->receptance, measured.frfs[0].receptance);
  }
  for (const char* name : {"xy", "yx"}) {
    EXPECT_EQ(planar.find(parse_frf_name(name))->receptance.norm(), 0.0);
  }
  EXPECT_THROW(static_cast<void>(with_equal_directions(both)), InvalidInput);
  EXPECT_THROW(static_cast<void>(with_equal_directions(planar)), InvalidInput);
}

// What a fit says of its modes stays with them when each becomes two.
TEST(EqualDirections, DoublesAFitWithWhatItSays) {
  FitResult fit;
  fit.model = one_direction(Axis::y);
  fit.model.modes.push_back(fit.model.modes[0]);
  fit.by_frf = {{.name = parse_frf_name("yy"), .relative = 0.1}};
  fit.at_bounds = {{2, FitBound::damping}};
  const FitResult both = with_equal_directions(fit);
  EXPECT_EQ(both.model.modes.size(), 4U);
  EXPECT_TRUE(both.bounds_of(2).empty());
  EXPECT_EQ(both.bounds_of(3), std::vector<FitBound>{FitBound::damping});
  EXPECT_EQ(both.bounds_of(4), std::vector<FitBound>{FitBound::damping});
  ASSERT_EQ(both.by_frf.size(), 2U);
  EXPECT_EQ(to_string(both.by_frf[0].name) + to_string(both.by_frf[1].name), "xxyy");
}

TEST(MissingDirections, AreThoseWithoutForceOrResponse) {
  EXPECT_TRUE(unknown_directions(data::robot_modes()).empty());
  EXPECT_EQ(unknown_directions(one_direction(Axis::x)), std::vector<Axis>{Axis::y});
  EXPECT_EQ(unknown_directions(one_direction(Axis::z)), (std::vector<Axis>{Axis::x, Axis::y}));
  const auto set_of = [](const std::vector<const char*>& names) {
    FrfSet set{.frequency_hz = Eigen::Vector2d(1.0, 2.0), .frfs = {}};
    for (const char* name : names) {
      set.frfs.push_back({.name = parse_frf_name(name), .receptance = Eigen::Vector2cd::Zero()});
    }
    return set;
  };
  EXPECT_TRUE(unknown_directions(set_of({"xx", "yy"})).empty());
  EXPECT_TRUE(unknown_directions(set_of({"xx", "xy", "yx"})).empty());
  // Hits in x alone, and a sensor in x alone: the one knows no force in y, the other no response.
  EXPECT_EQ(unknown_directions(set_of({"xx", "yx"})), std::vector<Axis>{Axis::y});
  EXPECT_EQ(unknown_directions(set_of({"xx", "xy"})), std::vector<Axis>{Axis::y});
}

TEST(MissingDirections, HaveToBeSaid) {
  const std::vector<Axis> y = {Axis::y};
  const auto field = [](const std::vector<Axis>& unknown, const MissingDirections& said) {
    return test::field_of([&] { require_said(unknown, said); });
  };
  EXPECT_EQ(field({}, {}), "accepted");
  EXPECT_EQ(field(y, {.equal = true}), "accepted");
  EXPECT_EQ(field(y, {.rigid = y}), "accepted");
  EXPECT_EQ(field(y, {}), "");
  EXPECT_EQ(field({}, {.equal = true}), "equal_directions");
  EXPECT_EQ(field({Axis::x, Axis::y}, {.equal = true}), "equal_directions");
  EXPECT_EQ(field({}, {.rigid = y}), "rigid_directions");
  EXPECT_EQ(field({Axis::x}, {.rigid = y}), "rigid_directions");
  EXPECT_EQ(field(y, {.equal = true, .rigid = y}), "equal_directions");
  EXPECT_EQ(field({Axis::x, Axis::y}, {.rigid = y}), "");
  const std::string said = test::rejection([&] { require_said(y, {}); });
  EXPECT_NE(said.find("rigid_directions = [\"y\"]"), std::string::npos) << said;
  EXPECT_NE(said.find("equal_directions = true"), std::string::npos) << said;
}

TEST(MissingDirections, AreListedWhereTheyAreAssumed) {
  EXPECT_FALSE(assumed_of({}));
  EXPECT_EQ(assumed_of({.rigid = {Axis::y}})->what, "Direction y, not measured");
  EXPECT_EQ(assumed_of({.rigid = {Axis::x, Axis::y}})->what, "Direction x and y, not measured");
  EXPECT_EQ(assumed_of({.equal = true})->key, "equal_directions");
}

}  // namespace directions_test
}  // namespace robomill::modal
