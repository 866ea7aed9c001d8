#include "robomill/path/speed/segment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::path {
namespace segment_test {

using Kind = Segment::Kind;

double b_at(const Segment& segment, double share) {
  const double s = share, r = 1.0 - share;
  switch (segment.kind) {
    case Kind::from_rest:
      return segment.end_b * std::pow(s, 4.0 / 3.0);
    case Kind::to_rest:
      return segment.begin_b * std::pow(r, 4.0 / 3.0);
    default:
      return r * r * segment.begin_b + 2.0 * r * s * segment.middle_b + s * s * segment.end_b;
  }
}

/// ∫ du / √b, by the midpoint rule in w with u = L w³ at a rest, where b vanishes.
double time_of(const Segment& segment, double to_share, int steps) {
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double w = (i + 0.5) / steps;
    if (segment.kind == Kind::from_rest) {
      const double top = std::cbrt(to_share);
      const double share = std::pow(top * w, 3.0);
      sum += segment.length_m * 3.0 * std::pow(top * w, 2.0) * top / steps / std::sqrt(b_at(segment, share));
    } else if (segment.kind == Kind::to_rest) {
      const double low = std::cbrt(1.0 - to_share), z = low + (1.0 - low) * w;
      sum += segment.length_m * 3.0 * z * z * (1.0 - low) / steps / std::sqrt(b_at(segment, 1.0 - z * z * z));
    } else {
      // Denser at both ends, near which it may nearly rest.
      const double share = w * w * (3.0 - 2.0 * w);
      sum += segment.length_m * to_share * 6.0 * w * (1.0 - w) / steps / std::sqrt(b_at(segment, to_share * share));
    }
  }
  return sum;
}

std::vector<Segment> segments() {
  std::vector<Segment> out = {
      {.length_m = 1e-3, .begin_b = 4e-4, .middle_b = 4e-4, .end_b = 4e-4},               // even
      {.length_m = 1e-3, .begin_b = 1e-4, .middle_b = 2e-4, .end_b = 3e-4},               // even acceleration
      {.length_m = 1e-3, .begin_b = 3e-4, .middle_b = 2e-4, .end_b = 1e-4},               // … and braking
      {.length_m = 1e-3, .begin_b = 1e-8, .middle_b = 4e-4, .end_b = 1e-3},               // rising from near rest
      {.length_m = 1e-3, .begin_b = 1e-3, .middle_b = 4e-4, .end_b = 1e-8},               // falling to near rest
      {.length_m = 1e-3, .begin_b = 1e-4, .middle_b = 1e-3, .end_b = 1e-4},               // a hill
      {.length_m = 1e-3, .begin_b = 1e-3, .middle_b = 1e-5, .end_b = 1e-3},               // a valley
      {.length_m = 1e-3, .begin_b = 4e-4, .middle_b = 4e-4 * (1 + 1e-9), .end_b = 4e-4},  // bends hardly
      {.length_m = 1e-3, .begin_b = 4e-4, .middle_b = 4e-4 * (1 - 1e-4), .end_b = 4e-4},  // near the series' border
      {.kind = Kind::from_rest, .length_m = 2e-4, .end_b = 1e-4},
      {.kind = Kind::to_rest, .length_m = 2e-4, .begin_b = 1e-4}};
  Random random(21);
  for (int i = 0; i < 300; ++i) {
    const auto b = [&] { return 1e-6 * std::pow(1e5, random.uniform()); };
    out.push_back({.length_m = 1e-5 * std::pow(1e4, random.uniform()), .begin_b = b(), .middle_b = b(), .end_b = b()});
  }
  return out;
}

TEST(Segment, DurationIsTheIntegral) {
  for (const Segment& segment : segments()) {
    const double found_s = duration_s(segment), met_s = time_of(segment, 1.0, 20000);
    EXPECT_NEAR(found_s, met_s, 1e-6 * met_s) << segment.begin_b << ' ' << segment.middle_b << ' ' << segment.end_b;
  }
}

TEST(Segment, WayIsTheIntegralsInverse) {
  for (const Segment& segment : segments()) {
    const double total_s = duration_s(segment);
    EXPECT_EQ(way_m(segment, 0.0, total_s), 0.0);
    EXPECT_NEAR(way_m(segment, total_s, total_s), segment.length_m, 1e-12 * segment.length_m)
        << segment.begin_b << ' ' << segment.middle_b << ' ' << segment.end_b;
    for (const double share : {0.1, 0.37, 0.5, 0.9}) {
      const double t_s = time_of(segment, share, 20000);
      if (t_s > total_s) continue;
      EXPECT_NEAR(way_m(segment, t_s, total_s), share * segment.length_m, 1e-6 * segment.length_m) << share;
    }
  }
}

// du/dt² = b everywhere, so that velocity goes on from segment to segment where b does.
TEST(Segment, SpeedIsTheRootOfB) {
  for (const Segment& segment : segments()) {
    const double total_s = duration_s(segment), d = 1e-5 * total_s;
    for (const double share : {0.02, 0.3, 0.6, 0.98}) {
      const double t = share * total_s;
      const double rate = (way_m(segment, t + d, total_s) - way_m(segment, t - d, total_s)) / (2.0 * d);
      const double b = b_at(segment, way_m(segment, t, total_s) / segment.length_m);
      EXPECT_NEAR(rate * rate, b, 1e-6 * b + 1e-12) << share << ' ' << static_cast<int>(segment.kind);
    }
  }
}

TEST(Segment, NeverRunsBack) {
  for (const Segment& segment : segments()) {
    const double total_s = duration_s(segment);
    double before = 0.0;
    for (int i = 1; i <= 1000; ++i) {
      const double now = way_m(segment, total_s * i / 1000.0, total_s);
      ASSERT_GE(now, before - 1e-15 * segment.length_m);
      ASSERT_LE(now, segment.length_m);
      before = now;
    }
  }
}

TEST(Segment, DwellStandsStill) {
  const Segment dwell{.kind = Kind::dwell, .begin_m = 0.1, .dwell_s = 0.25};
  EXPECT_EQ(duration_s(dwell), 0.25);
  EXPECT_EQ(way_m(dwell, 0.1, 0.25), 0.0);
}

}  // namespace segment_test
}  // namespace robomill::path
