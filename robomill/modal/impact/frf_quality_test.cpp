#include "robomill/modal/impact/frf_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

namespace robomill::modal {
namespace frf_quality_test {

using Complex = std::complex<double>;
using Eigen::Index;

Eigen::VectorXd axis(Index n) {
  return Eigen::VectorXd::LinSpaced(n, 1.0, static_cast<double>(n));
}

// A half sine of 1 ms: |F| falls by 20 dB where |cos(πx)/(1 - 4x²)| = 0.1, x = f · 1 ms = 1.2962…
TEST(ExcitedBand, EndsWhereTheForceHasFallenByTwentyDecibels) {
  const Eigen::VectorXd f = axis(3000);
  Eigen::VectorXd force(3000);
  for (Index k = 0; k < 3000; ++k) {
    const double x = f(k) * 1e-3;
    force(k) = k == 499 ? std::numbers::pi / 4.0 : std::abs(std::cos(std::numbers::pi * x) / (1.0 - 4.0 * x * x));
  }
  const Band band = excited_band(f, force);
  EXPECT_EQ(band.low_hz, 1.0);
  const double x = band.high_hz * 1e-3;
  const double next = x + 1e-3;
  EXPECT_GE(std::abs(std::cos(std::numbers::pi * x) / (1.0 - 4.0 * x * x)), 0.1);
  EXPECT_LT(std::abs(std::cos(std::numbers::pi * next) / (1.0 - 4.0 * next * next)), 0.1);
  EXPECT_NEAR(band.high_hz, 1297.0, 10.0);
}

// Noise that falls as 1/f² crosses a tenth at 40 Hz; a narrow antiresonance above does not matter.
TEST(LowestTrustworthy, IsWhereTheNoiseFallsBelowATenth) {
  const Eigen::VectorXd f = axis(1000);
  Eigen::VectorXd error = 0.1 * (40.0 / f.array()).square();
  error.segment(99, 4).setConstant(2.0);
  EXPECT_NEAR(lowest_trustworthy(f, error), 41.0, 1.0);
  EXPECT_EQ(lowest_trustworthy(f, Eigen::VectorXd::Constant(1000, 0.5)), 1000.0);
  EXPECT_EQ(lowest_trustworthy(f, Eigen::VectorXd::Constant(1000, 0.01)), 1.0);
}

TEST(DriftOf, IsZeroForAFreeBodyAndFlickerElse) {
  const Eigen::VectorXcd body = Eigen::VectorXcd::Constant(100, 0.2);
  EXPECT_EQ(drift_of(body, 1.0, 2).norm(), 0.0);
  Eigen::VectorXcd velocity(100);
  velocity(0) = 0.0;
  for (Index k = 1; k < 100; ++k) velocity(k) = 0.2 / Complex(0.0, static_cast<double>(k));
  EXPECT_EQ(drift_of(velocity, 1.0, 1).norm(), 0.0);

  Eigen::VectorXcd drift = body;
  for (Index k = 0; k < 100; k += 2) drift(k) = Complex(0.0, 0.2);
  const Eigen::VectorXd size = drift_of(drift, 1.0, 2);
  EXPECT_NEAR(size(22), 0.1, 1e-12);
  EXPECT_NEAR(size(88), 0.05, 1e-12);
}

struct Fixture {
  FrfSet set;
  std::vector<FrfEvidence> evidence;
  HitOptions options;
};

// Two FRFs, xy and yx, equal, clean.
Fixture clean() {
  Fixture f;
  const Index n = 500;
  f.set.frequency_hz = axis(n);
  for (const char* name : {"xy", "yx"}) {
    Frf frf;
    frf.name = parse_frf_name(name);
    frf.receptance = Eigen::VectorXcd::Constant(n, Complex(1e-7, -1e-8));
    frf.coherence = Eigen::VectorXd::Ones(n);
    frf.deviation = Eigen::VectorXd::Constant(n, 1e-10);
    f.set.frfs.push_back(frf);
    FrfEvidence evidence;
    evidence.hits = 5;
    evidence.force_n_s = Eigen::VectorXd::Ones(n);
    evidence.relative_noise = Eigen::VectorXd::Constant(n, 1e-3);
    evidence.sensor_noise = Eigen::VectorXd::Constant(n, 1e-3);
    evidence.drift = Eigen::VectorXd::Zero(n);
    f.evidence.push_back(evidence);
  }
  return f;
}

FrfGrade first_grade(const Fixture& f) {
  return grade_frfs(f.set, f.evidence, f.options).front();
}

void expect_fault(const Fixture& f, Grade grade, const std::string& fault, const std::string& remedy) {
  const FrfGrade got = first_grade(f);
  EXPECT_EQ(got.grade, grade);
  ASSERT_EQ(got.faults.size(), 1u);
  ASSERT_EQ(got.remedies.size(), 1u);
  EXPECT_NE(got.faults[0].find(fault), std::string::npos) << got.faults[0];
  EXPECT_NE(got.remedies[0].find(remedy), std::string::npos) << got.remedies[0];
}

TEST(GradeFrfs, FindsNoFaultInAGoodOne) {
  const FrfGrade grade = first_grade(clean());
  EXPECT_EQ(grade.grade, Grade::good);
  EXPECT_TRUE(grade.faults.empty());
  EXPECT_DOUBLE_EQ(grade.mean_coherence, 1.0);
  EXPECT_DOUBLE_EQ(grade.reciprocity_error, 0.0);
  EXPECT_EQ(grade.hits, 5);
}

TEST(GradeFrfs, NamesEachFaultAndItsRemedy) {
  Fixture f = clean();
  f.evidence[0].force_n_s.tail(200).setConstant(0.01);
  f.options.max_frequency_hz = 500.0;
  expect_fault(f, Grade::usable, "nothing above 300 Hz", "harder tip");

  f = clean();
  f.set.frfs[0].coherence.setConstant(0.7);
  f.evidence[0].relative_noise.setConstant(0.05);
  expect_fault(f, Grade::poor, "do not agree", "same spot");
  f.evidence[0].sensor_noise.setConstant(0.05);
  expect_fault(f, Grade::poor, "weak against the noise", "hit harder");

  f = clean();
  f.set.frfs[1].receptance *= 1.5;
  expect_fault(f, Grade::usable, "xy and its mirror differ by 40 %", "directions");

  f = clean();
  f.evidence[0].hits = 1;
  f.set.frfs[0].coherence.resize(0);
  expect_fault(f, Grade::usable, "one hit only", "hit again");

  f = clean();
  f.options.min_frequency_hz = 1.0;
  f.evidence[0].drift = 0.1 * (40.0 / f.set.frequency_hz.array()).square();
  expect_fault(f, Grade::usable, "noise rules below", "softer tip");

  f = clean();
  f.evidence[0].remaining = 0.1;
  f.evidence[0].remaining_hz = 17.0;
  expect_fault(f, Grade::usable, "10 % of the vibration at 17 Hz", "record longer");

  f = clean();
  f.evidence[0].restless = true;
  expect_fault(f, Grade::usable, "moved before", "wait longer");

  f = clean();
  f.set.frfs[0].name = parse_frf_name("xx");
  f.set.frfs[0].receptance *= -1.0;
  expect_fault(f, Grade::usable, "runs against the force", "signs");

  f = clean();
  f.evidence[0].relative_noise.setConstant(0.5);
  expect_fault(f, Grade::poor, "whole band", "more sensitive");
}

}  // namespace frf_quality_test
}  // namespace robomill::modal
