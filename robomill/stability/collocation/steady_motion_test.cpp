#include "robomill/stability/collocation/steady_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/stability/collocation/mesh/silhouette.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace steady_motion_test {

using namespace detail;
using cutting::CutterKind;
using std::numbers::pi;

cutting::Cutter random_cutter(Random& random) {
  cutting::Cutter cutter;
  cutting::FlatEndMill& mill = cutter.mill;
  mill = {.teeth = 1 + static_cast<int>(random.index(4)),
          .diameter_m = random.uniform(0.006, 0.016),
          .helix_rad = random.uniform(0.0, 0.6)};
  cutter.kind = static_cast<CutterKind>(random.index(4));
  if (cutter.kind == CutterKind::bull_nose) cutter.corner_radius_m = 0.3 * mill.diameter_m;
  if (cutter.kind == CutterKind::general) {
    cutter.bottom_angle_rad = random.uniform(0.05, 0.3);
    cutter.side_angle_rad = random.uniform(-0.1, 0.3);
  }
  if (mill.teeth > 1 && random.index(2) == 0) {
    mill.pitch_rad.assign(static_cast<std::size_t>(mill.teeth), 2.0 * pi / mill.teeth);
    mill.pitch_rad.front() += 0.1;
    mill.pitch_rad.back() -= 0.1;
    mill.runout_m = 2e-5;
  }
  return cutter;
}

struct Drawn {
  cutting::Cutter cutter;
  cutting::Engagement engagement;
  cutting::MillingCoefficients coefficients;
};

Drawn draw(Random& random) {
  Drawn drawn;
  drawn.cutter = random_cutter(random);
  const cutting::Cut cut = {.axial_depth_m = random.uniform(2e-4, 1.5e-3),
                            .radial_depth_m = drawn.cutter.mill.diameter_m * random.uniform(0.1, 0.8),
                            .direction = static_cast<cutting::MillingDirection>(random.index(3)),
                            .lead_rad = random.uniform(-0.3, 0.3),
                            .tilt_rad = random.uniform(-0.3, 0.3)};
  drawn.engagement = cutting::engage(drawn.cutter, cut, {.slices = 40});
  drawn.coefficients = {.tangential_n_per_m2 = {2e8, 7e8},
                        .radial_n_per_m2 = {1e8, 3e8},
                        .axial_n_per_m2 = {2e8},
                        .tangential_edge_n_per_m = {1e4},
                        .radial_edge_n_per_m = {3e3, 1e4},
                        .axial_edge_n_per_m = {-2e3}};
  return drawn;
}

/// ∫ F dθ of a stretch over what it has of [from, to].
Eigen::Vector3d integral(const ForceStretch& f, double from_rad, double to_rad) {
  const double a = std::max(from_rad, f.from_rad);
  const double b = std::min(to_rad, f.to_rad);
  if (!(b > a)) return Eigen::Vector3d::Zero();
  const std::complex<double> i(0.0, 1.0);
  const std::complex<double> once = (std::polar(1.0, b) - std::polar(1.0, a)) / i;
  const std::complex<double> twice = (std::polar(1.0, 2.0 * b) - std::polar(1.0, 2.0 * a)) / (2.0 * i);
  return f.mean * (b - a) + (f.first * once + f.second * twice).real();
}

// The kernel of forces sums means over steps, step by step; here the same force is harmonics between borders.
TEST(SteadyForce, IsThatOfTheForceKernel) {
  constexpr int steps = 360;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(611, seed);
    const Drawn drawn = draw(random);
    if (drawn.engagement.empty()) continue;
    const double feed_m = 5e-5;
    const cutting::CuttingForce expected =
        cutting::cutting_force(drawn.cutter, drawn.engagement, drawn.coefficients,
                               {.feed_per_tooth_m = feed_m, .spindle_speed_rad_per_s = 1000.0}, {.steps = steps});
    const SteadyForce force =
        steady_force(drawn.cutter, drawn.engagement, drawn.coefficients, feed_m, drawn.engagement.feed_from_tool);
    const double step = 2.0 * pi / steps;
    double worst = 0.0;
    for (Eigen::Index k = 0; k < steps; ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      const double from = expected.rotation_rad(k) - 0.5 * step;
      const double shift = std::floor(from / force.period_rad) * force.period_rad;
      for (const ForceStretch& stretch : force.stretches) {
        for (const double more : {0.0, force.period_rad}) {
          sum += integral(stretch, from - shift - more, from + step - shift - more);
        }
      }
      worst = std::max(worst, (sum / step - expected.force_n.col(k)).norm());
    }
    EXPECT_LT(worst, 1e-9 * expected.peak_force_n) << seed;
  }
}

// Put back into m q'' + c q' + k q = d (d · F), between borders of the force, and around the period's end.
TEST(SteadyMotion, SolvesTheEquationOfMotion) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(612, seed);
    const Drawn drawn = draw(random);
    if (drawn.engagement.empty()) continue;
    const Eigen::Vector3d along = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const testing::RealMode mode = {random.uniform(200.0, 1500.0), random.uniform(0.01, 0.1), 0.3, along};
    LobesProblem problem;
    problem.spatial.emplace();
    problem.dynamics = testing::spatial_model({mode});
    const TipDynamicsIn<3> tip = tip_dynamics<3>(tip_modes(problem));
    const double speed = random.uniform(300.0, 1500.0);
    const SteadyForce force =
        steady_force(drawn.cutter, drawn.engagement, drawn.coefficients, 5e-5, drawn.engagement.feed_from_tool);
    const SteadyMotion motion(tip, force, speed);
    const double omega = 2.0 * pi * mode.frequency_hz;
    constexpr double h = 3e-4;
    int compared = 0;
    double largest = 0.0, worst = 0.0;
    for (int i = 0; i < 400; ++i) {
      const double theta = random.uniform(0.0, force.period_rad);
      const bool near_border = std::ranges::any_of(force.stretches, [&](const ForceStretch& f) {
        return std::abs(theta - f.from_rad) < 2.0 * h || std::abs(theta - f.to_rad) < 2.0 * h;
      });
      if (near_border) continue;
      ++compared;
      const double before = along.dot(motion.at(theta - h)), here = along.dot(motion.at(theta)),
                   after = along.dot(motion.at(theta + h));
      const double velocity = (after - before) / (2.0 * h) * speed;
      const double acceleration = (after - 2.0 * here + before) / (h * h) * speed * speed;
      Eigen::Vector3d push = Eigen::Vector3d::Zero();
      for (const ForceStretch& f : force.stretches) {
        if (theta < f.from_rad || theta > f.to_rad) continue;
        push += f.mean + (f.first * std::polar(1.0, theta) + f.second * std::polar(1.0, 2.0 * theta)).real();
      }
      const double left = acceleration + 2.0 * mode.damping_ratio * omega * velocity + omega * omega * here;
      largest = std::max(largest, std::abs(acceleration) + omega * omega * std::abs(here));
      worst = std::max(worst, std::abs(left - along.dot(push) / mode.modal_mass_kg));
    }
    EXPECT_GT(compared, 50) << seed;
    EXPECT_LT(worst, 1e-5 * largest) << seed;
    const Eigen::Vector3d end = motion.at(force.period_rad - 1e-9);
    EXPECT_LT((end - motion.at(0.0)).norm(), 1e-6 * std::max(end.norm(), 1e-9)) << seed;
  }
}

// The cutter lies on one side of the plane through each place, square to its normal, which the feed runs along.
TEST(Silhouette, IsWhereTheCutterReachesFarthest) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(613, seed);
    const cutting::Cutter cutter = random_cutter(random);
    const cutting::Profile profile(cutter);
    const Eigen::Matrix3d turn = cutting::feed_from_tool(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
    const Silhouette silhouette(profile, turn);
    std::vector<Eigen::Vector3d> surface;
    for (int i = 0; i < 400; ++i) {
      const cutting::Profile::Point p = profile.at(random.uniform(0.0, profile.length_m()));
      const double angle = random.uniform(0.0, 2.0 * pi);
      surface.push_back(turn * Eigen::Vector3d(p.radius_m * std::sin(angle), p.radius_m * std::cos(angle), p.height_m));
    }
    int places = 0;
    for (const Silhouette::Stretch& stretch : silhouette.stretches()) {
      for (const int side : {-1, 1}) {
        for (const double parameter : silhouette.parameters(stretch, side, 0.1, 0.2)) {
          ++places;
          const cutting::Profile::Point point = stretch.at(parameter);
          const SilhouettePoint place = silhouette.at(point, side);
          const double kappa = point.position_rad, phi = place.angle_rad;
          const Eigen::Vector3d normal(std::sin(kappa) * std::sin(phi), std::sin(kappa) * std::cos(phi),
                                       -std::cos(kappa));
          EXPECT_LT((turn * normal - place.normal).norm(), 1e-9) << seed;
          EXPECT_EQ(place.normal.x(), 0.0);
          const Eigen::Vector3d here =
              turn * Eigen::Vector3d(point.radius_m * std::sin(phi), point.radius_m * std::cos(phi), point.height_m);
          for (const Eigen::Vector3d& p : surface) {
            EXPECT_LE(place.normal.dot(p - here), 1e-9 * cutter.mill.diameter_m) << seed;
          }
          EXPECT_GE(place.position_m.z(), -1e-9 * cutter.mill.diameter_m) << seed;
        }
      }
    }
    EXPECT_GT(places, 20) << seed;
  }
}

}  // namespace steady_motion_test
}  // namespace robomill::stability
