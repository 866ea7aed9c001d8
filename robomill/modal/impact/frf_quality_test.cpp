#include "robomill/modal/impact/frf_quality.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"

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

// Receptances of resonances at 60 and 240 Hz.
Eigen::VectorXcd two_resonances(const Eigen::VectorXd& f) {
  Eigen::VectorXcd h(f.size());
  for (Index k = 0; k < f.size(); ++k) {
    const double w = f(k);
    h(k) = 1.0 / Complex(60.0 * 60.0 - w * w, 2.0 * 0.02 * 60.0 * w) +
           0.2 / Complex(240.0 * 240.0 - w * w, 2.0 * 0.02 * 240.0 * w);
  }
  return h;
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
  f.set.frfs[0].receptance = -two_resonances(f.set.frequency_hz);
  expect_fault(f, Grade::usable, "runs against the force", "signs");

  f = clean();
  f.evidence[0].relative_noise.setConstant(0.5);
  expect_fault(f, Grade::poor, "whole band", "more sensitive");
}

// What drift and flicker of the accelerometer add to a receptance: (b/f + flicker of any phase)/f², as one hit's tail
// may hide it, up to 60 times the resonance at the first line.
Eigen::VectorXcd low_frequency_noise(const Eigen::VectorXd& f, double share, Random& random) {
  const double resonance = 1.0 / (2.0 * 0.02 * 60.0 * 60.0);  // |H| at 60 Hz
  const Complex drift = std::polar(1.0, random.uniform(0.0, 2.0 * std::numbers::pi));
  Eigen::VectorXcd out(f.size());
  for (Index k = 0; k < f.size(); ++k) {
    const Complex flicker(random.normal(), random.normal());
    out(k) = share * resonance * (drift + 0.5 * flicker / std::sqrt(f(k))) / (f(k) * f(k));
  }
  return out;
}

TEST(GradeFrfs, ADriftIsNoWrongSign) {
  for (const double share : {0.3, 3.0, 20.0, 60.0}) {
    for (int seed = 0; seed < 200; ++seed) {
      Random random(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(share));
      for (const double sign : {1.0, -1.0}) {
        Fixture f = clean();
        f.set.frfs[0].name = parse_frf_name("xx");
        f.set.frfs[0].receptance =
            sign * two_resonances(f.set.frequency_hz) + low_frequency_noise(f.set.frequency_hz, share, random);
        const std::vector<std::string> faults = first_grade(f).faults;
        const auto of_sign = [](const std::string& fault) { return fault.find("runs against") != std::string::npos; };
        EXPECT_EQ(std::ranges::any_of(faults, of_sign), sign < 0.0) << share << ", seed " << seed;
      }
    }
  }
}

}  // namespace frf_quality_test
}  // namespace robomill::modal
