#include "robomill/path/speed/segment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::path {
namespace segment_test {

using Kind = Segment::Kind;

double b_at(const Segment& span, double share) {
  const double s = share, r = 1.0 - share;
  switch (span.kind) {
    case Kind::from_rest:
      return span.end_b * std::pow(s, 4.0 / 3.0);
    case Kind::to_rest:
      return span.begin_b * std::pow(r, 4.0 / 3.0);
    default:
      return r * r * span.begin_b + 2.0 * r * s * span.middle_b + s * s * span.end_b;
  }
}

/// ∫ du / √b, by the midpoint rule in w with u = L w³ at a rest, where b vanishes.
double time_of(const Segment& span, double to_share, int steps) {
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double w = (i + 0.5) / steps;
    if (span.kind == Kind::from_rest) {
      const double top = std::cbrt(to_share);
      const double share = std::pow(top * w, 3.0);
      sum += span.length_m * 3.0 * std::pow(top * w, 2.0) * top / steps / std::sqrt(b_at(span, share));
    } else if (span.kind == Kind::to_rest) {
      const double low = std::cbrt(1.0 - to_share), z = low + (1.0 - low) * w;
      sum += span.length_m * 3.0 * z * z * (1.0 - low) / steps / std::sqrt(b_at(span, 1.0 - z * z * z));
    } else {
      // Denser at both ends, near which it may nearly rest.
      const double share = w * w * (3.0 - 2.0 * w);
      sum += span.length_m * to_share * 6.0 * w * (1.0 - w) / steps / std::sqrt(b_at(span, to_share * share));
    }
  }
  return sum;
}

std::vector<Segment> spans() {
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
  for (const Segment& span : spans()) {
    const double found_s = duration_s(span), met_s = time_of(span, 1.0, 20000);
    EXPECT_NEAR(found_s, met_s, 1e-6 * met_s) << span.begin_b << ' ' << span.middle_b << ' ' << span.end_b;
  }
}

TEST(Segment, WayIsTheIntegralsInverse) {
  for (const Segment& span : spans()) {
    const double total_s = duration_s(span);
    EXPECT_EQ(way_m(span, 0.0, total_s), 0.0);
    EXPECT_NEAR(way_m(span, total_s, total_s), span.length_m, 1e-12 * span.length_m)
        << span.begin_b << ' ' << span.middle_b << ' ' << span.end_b;
    for (const double share : {0.1, 0.37, 0.5, 0.9}) {
      const double t_s = time_of(span, share, 20000);
      if (t_s > total_s) continue;
      EXPECT_NEAR(way_m(span, t_s, total_s), share * span.length_m, 1e-6 * span.length_m) << share;
    }
  }
}

// du/dt² = b everywhere, so that velocity goes on from span to span where b does.
TEST(Segment, SpeedIsTheRootOfB) {
  for (const Segment& span : spans()) {
    const double total_s = duration_s(span), d = 1e-5 * total_s;
    for (const double share : {0.02, 0.3, 0.6, 0.98}) {
      const double t = share * total_s;
      const double rate = (way_m(span, t + d, total_s) - way_m(span, t - d, total_s)) / (2.0 * d);
      const double b = b_at(span, way_m(span, t, total_s) / span.length_m);
      EXPECT_NEAR(rate * rate, b, 1e-6 * b + 1e-12) << share << ' ' << static_cast<int>(span.kind);
    }
  }
}

TEST(Segment, NeverRunsBack) {
  for (const Segment& span : spans()) {
    const double total_s = duration_s(span);
    double before = 0.0;
    for (int i = 1; i <= 1000; ++i) {
      const double now = way_m(span, total_s * i / 1000.0, total_s);
      ASSERT_GE(now, before - 1e-15 * span.length_m);
      ASSERT_LE(now, span.length_m);
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
