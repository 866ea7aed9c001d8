#include "robomill/modal/impact/hit_split.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "examples/first-lobes/hammer.hpp"
#include "robomill/base/random.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hit_split_test {

using Eigen::Index;

constexpr double rate_hz = 10'240.0;

/// A half sine; t from its begin.
double half_sine(double t, double width_s) {
  return t < 0.0 || t > width_s ? 0.0 : std::sin(std::numbers::pi * t / width_s);
}

struct Blow {
  double at_s = 0.0, peak_n = 100.0, width_s = 1e-3;
  double answer = 1.0;  ///< of the structure
};

/// Blows on one mode at 200 Hz, with what else a sensor shows.
Hit record_of(double seconds, const std::vector<Blow>& blows, Random& random, double noise_n = 0.05,
              double offset_n = 0.0, double swing_n = 0.0, double swing_hz = 0.7) {
  const auto n = static_cast<Index>(seconds * rate_hz);
  Hit hit;
  hit.file = "long.csv";
  hit.sample_rate_hz = rate_hz;
  hit.force_n.resize(n);
  Eigen::VectorXd response(n);
  const double phase = 6.0 * random.uniform();
  for (Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    double force = offset_n + swing_n * std::sin(2.0 * std::numbers::pi * swing_hz * t + phase);
    double moved = 0.0;
    for (const Blow& blow : blows) {
      const double since = t - blow.at_s;
      force += blow.peak_n * half_sine(since, blow.width_s);
      // A force sensor rings, the structure decays.
      if (since > blow.width_s) force += 0.01 * blow.peak_n * std::exp(-900.0 * since) * std::sin(6e3 * since);
      if (since > 0.0) {
        moved += blow.answer * blow.peak_n * std::exp(-25.0 * since) * std::sin(2.0 * std::numbers::pi * 200.0 * since);
      }
    }
    hit.force_n(i) = force + noise_n * random.normal();
    response(i) = moved + 0.01 * random.normal();
  }
  hit.responses = {{.dof = Dof{}, .samples = response}};
  return hit;
}

/// Random blows, each so long after the one before.
std::vector<Blow> blows_of(Random& random, int count, double least_s, double most_s) {
  std::vector<Blow> out;
  double at_s = 0.1 + random.uniform();
  for (int k = 0; k < count; ++k) {
    out.push_back(
        {.at_s = at_s, .peak_n = 100.0 + 400.0 * random.uniform(), .width_s = 2e-4 + 3e-3 * random.uniform()});
    at_s += least_s + (most_s - least_s) * random.uniform();
  }
  return out;
}

// One pulse, with bounces and whatever else: the record comes back as it is, bit for bit.
TEST(HitSplit, ARecordOfOneHitStaysWhole) {
  for (int seed = 0; seed < test::seeds(500); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<Blow> blows = blows_of(random, 1, 1.0, 1.0);
    for (std::uint64_t bounce = random.index(3); bounce > 0; --bounce) {
      Blow later = blows.back();
      later.at_s += 0.005 + 0.4 * random.uniform();
      later.peak_n *= 0.1 + 0.9 * random.uniform();
      blows.push_back(later);
    }
    const double peak_n = blows.front().peak_n;
    const Hit record = record_of(3.0, blows, random, 0.02 * peak_n * random.uniform(), 30.0 * random.normal(),
                                 0.15 * peak_n * random.uniform(), 0.3 + random.uniform());
    const std::vector<Hit> hits = split_hits(record, usual_hit_spacing_s);
    ASSERT_EQ(hits.size(), 1U) << seed;
    EXPECT_EQ(hits[0].file, "long.csv");
    EXPECT_EQ(hits[0].force_n, record.force_n);
    EXPECT_EQ(hits[0].responses[0].samples, record.responses[0].samples);
    EXPECT_TRUE(hits[0].fault.empty());
  }
}

TEST(HitSplit, FindsEveryHitOfARecord) {
  for (int seed = 0; seed < test::seeds(500); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const int count = 2 + static_cast<int>(random.index(8));
    const std::vector<Blow> blows = blows_of(random, count, 0.6, 2.5);
    const double sign = random.index(4) == 0 ? -1.0 : 1.0;
    Hit record = record_of(blows.back().at_s + 1.5, blows, random, 0.5 * random.uniform(), 20.0 * random.normal(),
                           5.0 * random.uniform(), 0.3 + random.uniform());
    record.force_n *= sign;
    const std::vector<HitSegment> found = find_hit_segments(record.force_n, rate_hz);
    ASSERT_EQ(found.size(), blows.size()) << seed;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double peak_s = blows[k].at_s + 0.5 * blows[k].width_s;
      EXPECT_NEAR(static_cast<double>(found[k].peak) / rate_hz, peak_s, 1e-3) << seed;
      EXPECT_GE(found[k].onset - found[k].begin, std::min<Index>(256, found[k].onset)) << seed;
      EXPECT_EQ(found[k].begin, k == 0 ? found[k].begin : found[k - 1].end) << seed;
    }
  }
}

// The teeth of a cutter at any speed, a load that stays, noise alone.
TEST(HitSplit, WhatIsNoSeriesOfHitsStaysWhole) {
  Random random(1);
  for (const double period_s : {2e-3, 5e-3, 0.02, 0.1}) {
    std::vector<Blow> teeth;
    for (double t = 0.05; t < 3.0; t += period_s) teeth.push_back({.at_s = t, .width_s = 0.3 * period_s});
    EXPECT_TRUE(find_hit_segments(record_of(3.0, teeth, random).force_n, rate_hz).empty()) << period_s;
  }
  Eigen::VectorXd load = Eigen::VectorXd::Zero(40'960);
  load.segment(8'000, 6'000).setConstant(50.0);
  load.segment(25'000, 6'000).setConstant(60.0);
  EXPECT_TRUE(find_hit_segments(load, rate_hz).empty());
  EXPECT_TRUE(find_hit_segments(record_of(3.0, {}, random).force_n, rate_hz).empty());
  EXPECT_TRUE(find_hit_segments(Eigen::VectorXd::Zero(5'000), rate_hz).empty());
  EXPECT_TRUE(find_hit_segments(Eigen::VectorXd::Constant(5'000, 3.0), rate_hz).empty());
}

TEST(HitSplit, TheSpacingDecidesWhatABounceIs) {
  Random random(1);
  const Hit record = record_of(4.0, {{.at_s = 0.5}, {.at_s = 0.8}, {.at_s = 2.5}}, random);
  EXPECT_EQ(split_hits(record, 0.5).size(), 2U);
  EXPECT_EQ(split_hits(record, 0.2).size(), 3U);
  EXPECT_EQ(split_hits(record, 2.0).size(), 1U);
}

/// The reasons of a hit's verdict, in one text.
std::string reasons(const FrfResult& result, std::size_t which) {
  std::string out;
  for (const std::string& reason : result.hits.at(which).reasons) out += reason + ". ";
  return out;
}

TEST(HitSplit, EachHitIsJudgedByItself) {
  Random random(3);
  const std::vector<Blow> blows = {{.at_s = 1.0},
                                   {.at_s = 3.0},
                                   {.at_s = 3.03, .peak_n = 40.0},  // bounces
                                   {.at_s = 5.0},
                                   {.at_s = 7.0, .peak_n = 60.0, .answer = 0.02},  // laid down
                                   {.at_s = 9.0},
                                   {.at_s = 9.75},  // follows too soon
                                   {.at_s = 11.75},
                                   {.at_s = 13.7}};  // the recorder is switched off
  const std::vector<Hit> hits = split_hits(record_of(13.9, blows, random), usual_hit_spacing_s, 100.0);
  ASSERT_EQ(hits.size(), 8U);
  EXPECT_EQ(hits[1].file, "long.csv, hit 2 of 8 at 103.00 s");
  const FrfResult result = estimate_frfs(hits, {.max_frequency_hz = 1000.0});
  EXPECT_NE(reasons(result, 1).find("double hit"), std::string::npos) << reasons(result, 1);
  EXPECT_NE(reasons(result, 3).find("was the hammer laid down"), std::string::npos) << reasons(result, 3);
  EXPECT_NE(reasons(result, 4).find("the next hit follows 0.75 s after it"), std::string::npos) << reasons(result, 4);
  EXPECT_NE(reasons(result, 7).find("the record ends 0.2 s after it"), std::string::npos) << reasons(result, 7);
  for (const std::size_t which : {0U, 2U, 5U, 6U}) EXPECT_TRUE(result.hits[which].accepted) << reasons(result, which);
  EXPECT_EQ(result.grades.at(0).hits, 4);
}

/// Records behind each other, each cut to a length of its own.
Hit one_record(const std::vector<Hit>& hits, double least_s, Random& random) {
  std::vector<Index> lengths;
  Index total = 0;
  for (const Hit& hit : hits) {
    const double s = static_cast<double>(hit.force_n.size()) / hit.sample_rate_hz;
    lengths.push_back(static_cast<Index>((least_s + (s - least_s) * random.uniform()) * hit.sample_rate_hz));
    total += lengths.back();
  }
  Hit out = hits.front();
  out.file = "all.csv";
  out.force_n.resize(total);
  for (HitChannel& channel : out.responses) channel.samples.resize(total);
  Index at = 0;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    out.force_n.segment(at, lengths[k]) = hits[k].force_n.head(lengths[k]);
    for (std::size_t c = 0; c < out.responses.size(); ++c) {
      out.responses[c].samples.segment(at, lengths[k]) = hits[k].responses[c].samples.head(lengths[k]);
    }
    at += lengths[k];
  }
  return out;
}

/// ‖ΔH‖ / ‖H‖ of two sets over one axis, the worst FRF.
double difference(const FrfSet& have, const FrfSet& want) {
  double worst = 0.0;
  for (const Frf& frf : want.frfs) {
    worst = std::max(worst, (have.find(frf.name)->receptance - frf.receptance).norm() / frf.receptance.norm());
  }
  return worst;
}

// Ten hits in x on the published robot, in ten files and in one. Without noise they differ by the leak of 17.4 Hz,
// whose vibration lasts 5 s; with noise by less than what deviation states.
TEST(HitSplit, TenHitsOfOneRecordGiveTheFrfsOfTenFiles) {
  ModalModel model = data::robot_modes();
  model.excitations.resize(1);
  for (Mode& mode : model.modes) mode.left.conservativeResize(1);
  for (const double noise : {0.0, 1.0}) {
    examples::Hammer hammer;
    hammer.record_s = 6.0;
    hammer.pretrigger_s = 0.4;
    hammer.force_noise_n *= noise;
    hammer.response_noise *= noise;
    const std::vector<Hit> files = examples::simulate_hits(model, 10, 0.1, hammer, 7);
    Random random(11);
    const std::vector<Hit> cut_apart = split_hits(one_record(files, 5.4, random), usual_hit_spacing_s);
    ASSERT_EQ(cut_apart.size(), 10U);
    const HitOptions options{.min_frequency_hz = 10.0,
                             .max_frequency_hz = 1000.0,
                             .frequency_resolution_hz = 0.25,
                             .exponential_window = ExponentialWindow::off};
    const FrfResult of_one = estimate_frfs(cut_apart, options), of_ten = estimate_frfs(files, options);
    EXPECT_EQ(of_one.grades.at(0).hits, 10);
    EXPECT_LT(difference(of_one.set, of_ten.set), noise > 0.0 ? 5e-3 : 1e-4);
    const FrfSet truth = synthesize(model, of_one.set.frequency_hz);
    EXPECT_LT(difference(of_one.set, truth), std::max(1e-3, 1.5 * difference(of_ten.set, truth)));
  }
}

// What cannot be cut is left to who judges it.
TEST(HitSplit, LeavesUnsoundRecordsAlone) {
  Random random(1);
  const Hit sound = record_of(3.0, {{.at_s = 0.5}, {.at_s = 1.7}}, random);
  ASSERT_EQ(split_hits(sound, 0.5).size(), 2U);
  Hit hit = sound;
  hit.force_n(77) = std::nan("");
  EXPECT_EQ(split_hits(hit, 0.5).size(), 1U);
  hit = sound;
  hit.responses[0].samples.conservativeResize(100);
  EXPECT_EQ(split_hits(hit, 0.5).size(), 1U);
  hit = sound;
  hit.sample_rate_hz = 0.0;
  EXPECT_EQ(split_hits(hit, 0.5).size(), 1U);
  hit = sound;
  hit.force_n = Eigen::VectorXd();
  EXPECT_EQ(split_hits(hit, 0.5).size(), 1U);
  EXPECT_EQ(split_hits(sound, 1e300).size(), 1U);
}

}  // namespace hit_split_test
}  // namespace robomill::modal
