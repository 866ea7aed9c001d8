#include "robomill/cutting/coefficients.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace coefficients_test {

using std::numbers::pi;
using test::field_of;
using test::seeds;

constexpr double mm = 1e-3;
constexpr double n_per_mm2 = 1e6;
constexpr double n_per_mm = 1e3;

struct Constants {
  double tangential = 1825.0 * n_per_mm2, radial = 770.0 * n_per_mm2, axial = 735.0 * n_per_mm2;
  double tangential_edge = 29.7 * n_per_mm, radial_edge = 55.7 * n_per_mm, axial_edge = 1.8 * n_per_mm;
};

/// The mean by summing a tooth's force over φ, without the closed forms.
Eigen::Vector3d slot_mean(const Constants& k, int teeth, double depth_m, double feed_m) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double phi = (i + 0.5) * pi / steps;
    const double chip = feed_m * std::sin(phi);
    const double t = k.tangential * chip + k.tangential_edge, r = k.radial * chip + k.radial_edge;
    sum += Eigen::Vector3d(-t * std::cos(phi) - r * std::sin(phi), t * std::sin(phi) - r * std::cos(phi),
                           k.axial * chip + k.axial_edge);
  }
  return sum * teeth * depth_m / (2.0 * steps);
}

SlotForce slot(const Constants& k, int teeth, double depth_m, double feed_m, double speed_rad_per_s = 100.0) {
  return {feed_m, depth_m, speed_rad_per_s, slot_mean(k, teeth, depth_m, feed_m)};
}

void expect_constants(const SlotFit& fit, const Constants& k, double relative) {
  const auto near = [relative](double found, double planted) {
    EXPECT_NEAR(found, planted, relative * std::abs(planted));
  };
  near(fit.tangential.cutting_n_per_m2, k.tangential);
  near(fit.radial.cutting_n_per_m2, k.radial);
  near(fit.axial.cutting_n_per_m2, k.axial);
  near(fit.tangential.edge_n_per_m, k.tangential_edge);
  near(fit.radial.edge_n_per_m, k.radial_edge);
  near(fit.axial.edge_n_per_m, k.axial_edge);
}

bool notes_say(const std::vector<std::string>& notes, const char* words) {
  return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

// Source: [BudakAltintasArmarego1996], Ti6Al4V: the means of one feed by the published constants are these.
TEST(Slots, GiveBackThePublishedConstants) {
  const Constants k;
  const Eigen::Vector3d published(-555.8508, 655.6513, 255.9891);
  EXPECT_LT((slot_mean(k, 4, 5.08 * mm, 0.05 * mm) - published).cwiseAbs().maxCoeff(), 1e-4);
  std::vector<SlotForce> slots;
  for (const double feed_mm : {0.0125, 0.025, 0.1, 0.2}) slots.push_back(slot(k, 4, 5.08 * mm, feed_mm * mm));
  slots.push_back({0.05 * mm, 5.08 * mm, 100.0, published});
  const SlotFit fit = identify_from_slots(slots, {.teeth = 4});
  EXPECT_EQ(fit.status, SlotFit::Status::identified);
  expect_constants(fit, k, 1e-5);
  EXPECT_LT(fit.residual_n.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_GT(fit.axial.r_squared, 1.0 - 1e-9);
  EXPECT_TRUE(fit.notes.empty()) << fit.notes.front();
  const MillingCoefficients found = fit.coefficients();
  EXPECT_EQ(found.radial_edge_n_per_m, std::vector<double>{fit.radial.edge_n_per_m});
}

/// Nine slots at three feeds and three depths.
std::vector<SlotForce> slots_of_three_depths() {
  std::vector<SlotForce> slots;
  for (const double depth_mm : {1.0, 2.0, 3.0}) {
    for (const double feed_mm : {0.05, 0.1, 0.2}) slots.push_back(slot({}, 4, depth_mm * mm, feed_mm * mm));
  }
  return slots;
}

// Each fault leaves forces that scatter more about the model than about their mean.
TEST(Slots, RejectForcesThatAreNoSlots) {
  const auto message_of = [](const auto& spoil) {
    std::vector<SlotForce> slots = slots_of_three_depths();
    spoil(slots);
    return test::rejection([&] { static_cast<void>(identify_from_slots(slots, {.teeth = 4})); });
  };
  const std::string unit = message_of([](auto& slots) { slots[4].axial_depth_m *= 1000.0; });
  EXPECT_NE(unit.find("R² of fy is -"), std::string::npos) << unit;
  EXPECT_NE(unit.find("Row 5 is the odd one"), std::string::npos) << unit;
  const std::string still = message_of([](auto& slots) {
    for (SlotForce& row : slots) row.mean_force_n = {-500.0 + 0.01 * row.axial_depth_m, 600.0, 0.0};
    slots[0].mean_force_n.y() = 601.0;
  });
  EXPECT_NE(still.find("R² of fy is -"), std::string::npos) << still;
  const std::string columns = message_of([](auto& slots) {
    for (SlotForce& row : slots) row.mean_force_n = {row.mean_force_n.y(), 1e3 - row.mean_force_n.z(), 5.0};
  });
  EXPECT_NE(columns.find("slots"), std::string::npos) << columns;
}

// Scatter about the model lowers R² without making it nonsense: that is reported, and the numbers stand.
TEST(Slots, ReportAPoorFit) {
  Random random(11);
  std::vector<SlotForce> slots = slots_of_three_depths();
  for (SlotForce& row : slots) row.mean_force_n.y() = 400.0 * random.normal();
  try {
    const SlotFit fit = identify_from_slots(slots, {.teeth = 4});
    EXPECT_LT(fit.tangential.r_squared, 0.5);
    EXPECT_TRUE(notes_say(fit.notes, "R² of fy is 0."));
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
}

TEST(Slots, RandomConstantsAndDepths) {
  Random random(1);
  for (int seed = 0; seed < seeds(200); ++seed) {
    const Constants k{random.uniform(1e8, 4e9), random.uniform(1e7, 2e9),  random.uniform(-1e9, 1e9),
                      random.uniform(1e3, 1e5), random.uniform(-1e3, 1e5), random.uniform(-1e4, 1e4)};
    const int teeth = 1 + static_cast<int>(random.index(8));
    std::vector<SlotForce> slots;
    for (int row = 0; row < 3; ++row) {
      slots.push_back(slot(k, teeth, random.uniform(0.5, 5.0) * mm, (0.02 + 0.03 * row) * mm, 50.0));
    }
    expect_constants(identify_from_slots(slots, {.teeth = teeth}), k, 1e-6);
  }
}

// A deviation is one where the truth lies within two of them 95 times in a hundred, in every direction.
TEST(Slots, DeviationsCoverTheNoise) {
  const Constants k;
  std::vector<SlotForce> clean;
  for (int row = 0; row < 40; ++row) clean.push_back(slot(k, 4, 5.08 * mm, (0.01 + 0.005 * row) * mm));
  const int cases = seeds(4000);
  int cutting = 0, edge = 0;
  double correlation = 0.0;
  for (int seed = 0; seed < cases; ++seed) {
    Random random(7, static_cast<std::uint64_t>(seed));
    std::vector<SlotForce> slots = clean;
    for (SlotForce& row : slots) {
      for (double& force : row.mean_force_n) force += 10.0 * random.normal();
    }
    const SlotFit fit = identify_from_slots(slots, {.teeth = 4});
    const auto within = [](double found, double planted, double deviation) {
      return std::abs(found - planted) <= 2.0 * deviation ? 1 : 0;
    };
    cutting += within(fit.tangential.cutting_n_per_m2, k.tangential, fit.tangential.cutting_deviation_n_per_m2) +
               within(fit.radial.cutting_n_per_m2, k.radial, fit.radial.cutting_deviation_n_per_m2) +
               within(fit.axial.cutting_n_per_m2, k.axial, fit.axial.cutting_deviation_n_per_m2);
    edge += within(fit.tangential.edge_n_per_m, k.tangential_edge, fit.tangential.edge_deviation_n_per_m) +
            within(fit.radial.edge_n_per_m, k.radial_edge, fit.radial.edge_deviation_n_per_m) +
            within(fit.axial.edge_n_per_m, k.axial_edge, fit.axial.edge_deviation_n_per_m);
    EXPECT_NEAR(fit.tangential.noise_n, 10.0, 5.0);
    correlation = fit.radial.correlation;
  }
  // Student's t of 38 degrees of freedom: 94.7 %.
  EXPECT_NEAR(cutting / (3.0 * cases), 0.947, 0.02);
  EXPECT_NEAR(edge / (3.0 * cases), 0.947, 0.02);
  EXPECT_LT(correlation, -0.5);
}

TEST(Slots, OneFeedCannotPartCuttingFromEdge) {
  const Constants k;
  const std::vector<SlotForce> slots = {slot(k, 4, 2.0 * mm, 0.05 * mm), slot(k, 4, 5.0 * mm, 0.05 * mm)};
  const SlotFit fit = identify_from_slots(slots, {.teeth = 4});
  EXPECT_EQ(fit.status, SlotFit::Status::edge_unknown);
  EXPECT_TRUE(std::isinf(fit.tangential.cutting_deviation_n_per_m2));
  EXPECT_TRUE(notes_say(fit.notes, "one feed"));
  // All of the force, and so the upper bound: K + Ke (1/π) / (c/4).
  EXPECT_NEAR(fit.tangential.cutting_n_per_m2, k.tangential + k.tangential_edge * 4.0 / pi / (0.05 * mm), 1e4);
  const SlotFit without = identify_from_slots(slots, {.teeth = 4, .edge_forces = false});
  EXPECT_EQ(without.status, SlotFit::Status::identified);
  EXPECT_DOUBLE_EQ(without.tangential.cutting_n_per_m2, fit.tangential.cutting_n_per_m2);
  EXPECT_TRUE(std::isfinite(without.tangential.cutting_deviation_n_per_m2));
}

TEST(Slots, TwoRowsLeaveNoDeviation) {
  const Constants k;
  const SlotFit fit =
      identify_from_slots({slot(k, 4, 2.0 * mm, 0.05 * mm), slot(k, 4, 2.0 * mm, 0.1 * mm)}, {.teeth = 4});
  expect_constants(fit, k, 1e-6);
  EXPECT_TRUE(std::isinf(fit.axial.edge_deviation_n_per_m));
  EXPECT_TRUE(std::isnan(fit.axial.noise_n));
  EXPECT_TRUE(notes_say(fit.notes, "third"));
}

TEST(Slots, DetectForcesOnTheWorkpieceAndWrongUnits) {
  const Constants k;
  std::vector<SlotForce> slots;
  for (const double feed_mm : {0.05, 0.1, 0.15}) slots.push_back(slot(k, 4, 2.0 * mm, feed_mm * mm));
  std::vector<SlotForce> on_workpiece = slots, kilonewtons = slots;
  for (SlotForce& row : on_workpiece) row.mean_force_n *= -1.0;
  for (SlotForce& row : kilonewtons) row.mean_force_n *= 1e-3;
  EXPECT_TRUE(notes_say(identify_from_slots(on_workpiece, {.teeth = 4}).notes, "on the workpiece"));
  EXPECT_TRUE(notes_say(identify_from_slots(kilonewtons, {.teeth = 4}).notes, "units"));
  for (SlotForce& row : slots) row.mean_force_n.x() *= -1.0;
  EXPECT_TRUE(notes_say(identify_from_slots(slots, {.teeth = 4}).notes, "x along the feed"));
}

TEST(Slots, SaysWhetherTheSpeedMatters) {
  const Constants slow;
  Constants fast = slow;
  fast.tangential *= 0.9;
  std::vector<SlotForce> clean_differing, clean_alike;
  for (int row = 0; row < 8; ++row) {
    const double feed_m = (0.02 + 0.02 * row) * mm;
    clean_differing.push_back(slot(slow, 4, 5.0 * mm, feed_m, 100.0 + 0.1 * row));
    clean_differing.push_back(slot(fast, 4, 5.0 * mm, feed_m, 200.0));
    clean_alike.push_back(slot(slow, 4, 5.0 * mm, feed_m, 100.0));
    clean_alike.push_back(slot(slow, 4, 5.0 * mm, feed_m, 200.0));
  }
  int seen = 0, false_alarms = 0;
  const int cases = seeds(1000);
  for (int seed = 0; seed < cases; ++seed) {
    Random random(3, static_cast<std::uint64_t>(seed));
    std::vector<SlotForce> differing = clean_differing, alike = clean_alike;
    for (std::vector<SlotForce>* rows : {&differing, &alike}) {
      for (SlotForce& row : *rows) {
        for (double& force : row.mean_force_n) force += 8.0 * random.normal();
      }
    }
    const SlotFit fit = identify_from_slots(differing, {.teeth = 4});
    ASSERT_EQ(fit.by_speed.size(), 2U);
    EXPECT_EQ(fit.by_speed[0].rows, 8);
    EXPECT_NEAR(fit.by_speed[1].tangential.cutting_n_per_m2, fast.tangential, 0.1 * fast.tangential);
    seen += fit.depends_on_speed ? 1 : 0;
    false_alarms += identify_from_slots(alike, {.teeth = 4}).depends_on_speed ? 1 : 0;
  }
  EXPECT_GT(seen, 0.95 * cases);
  EXPECT_LE(false_alarms, std::max(3.0, 0.025 * cases));
}

TEST(Slots, RejectsWhatCannotBe) {
  const Constants k;
  const auto with = [&](auto&& change) {
    std::vector<SlotForce> slots = {slot(k, 4, 2.0 * mm, 0.05 * mm), slot(k, 4, 2.0 * mm, 0.1 * mm)};
    SlotOptions options{.teeth = 4};
    change(slots, options);
    return field_of([&] { static_cast<void>(identify_from_slots(slots, options)); });
  };
  using Slots = std::vector<SlotForce>;
  EXPECT_EQ(with([](Slots& s, SlotOptions&) { s.pop_back(); }), "slots");
  EXPECT_EQ(with([](Slots& s, SlotOptions&) { s[1].axial_depth_m = 0.0; }), "slots[2].axial_depth_m");
  EXPECT_EQ(with([](Slots& s, SlotOptions&) { s[0].feed_per_tooth_m = -1e-5; }), "slots[1].feed_per_tooth_m");
  EXPECT_EQ(with([](Slots& s, SlotOptions&) { s[0].mean_force_n.y() = NAN; }), "slots[1].mean_force_n");
  EXPECT_EQ(with([](Slots& s, SlotOptions&) { s[0].spindle_speed_rad_per_s = -1.0; }),
            "slots[1].spindle_speed_rad_per_s");
  EXPECT_EQ(with([](Slots&, SlotOptions& o) { o.teeth = 0; }), "teeth");
  EXPECT_EQ(with([](Slots&, SlotOptions& o) { o.significance = 1.0; }), "significance");
}

}  // namespace coefficients_test
}  // namespace robomill::cutting
