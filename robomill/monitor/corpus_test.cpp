// What the corpus says of its cuts is so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "testing/monitor/corpus.hpp"
#include "testing/monitor/hours.hpp"
#include "testing/monitor/score.hpp"
#include "testing/support.hpp"

namespace robomill::monitor::testing {
namespace corpus_test {

using std::numbers::pi;

/// Amplitude at one frequency of x between two times, Hann window.
double line(const CleanCut::Columns& x, double frequency_hz, double from_s, double to_s) {
  const auto from = static_cast<Eigen::Index>(from_s * corpus_rate_hz),
             to = static_cast<Eigen::Index>(to_s * corpus_rate_hz);
  std::complex<double> a = 0.0, b = 0.0;
  double weight = 0.0;
  for (Eigen::Index i = from; i < to; ++i) {
    const double w = 0.5 - 0.5 * std::cos(2.0 * pi * static_cast<double>(i - from) / static_cast<double>(to - from));
    const std::complex<double> turn = std::polar(w, -2.0 * pi * frequency_hz * static_cast<double>(i) / corpus_rate_hz);
    a += x(i, 0) * turn;
    b += x(i, 1) * turn;
    weight += w;
  }
  return 2.0 * std::sqrt(std::norm(a) + std::norm(b)) / weight;
}

/// Where the 0.3 s begin in which a cut chatters most.
double loudest_s(const Truth& truth) {
  const auto n = static_cast<std::ptrdiff_t>(0.3 * corpus_rate_hz);
  const auto power = [](double sum, float a) { return sum + static_cast<double>(a) * static_cast<double>(a); };
  const std::vector<float>& a = truth.amplitude_m_per_s2;
  double most = 0.0, at_s = 0.0;
  for (auto from = a.begin(); a.end() - from >= n; from += n / 10) {
    const double here = std::accumulate(from, from + n, 0.0, power);
    if (here <= most) continue;
    most = here;
    at_s = static_cast<double>(from - a.begin()) / corpus_rate_hz;
  }
  return at_s;
}

TEST(Corpus, HasTheClassesItPromises) {
  int drilling = 0, chatter = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RecordedCut c = cut(seed);
    drilling += c.kind == "drilling" ? 1 : 0;
    chatter += c.truth.chatter ? 1 : 0;
    EXPECT_EQ(c.samples.size() / 2, c.truth.amplitude_m_per_s2.size());
    EXPECT_TRUE(std::ranges::all_of(c.samples, [](float v) { return std::isfinite(v); }));
    const double off = c.hint_rad_per_s / static_cast<double>(c.truth.speed_rad_per_s.front()) - 1.0;
    EXPECT_LE(std::abs(off), 0.05 + 1e-6);
    if (!c.truth.chatter) continue;
    EXPECT_LE(c.truth.start_s, c.truth.t10_s);
    EXPECT_LT(c.truth.t10_s + 0.4, c.truth.end_s);
    EXPECT_FALSE(c.truth.lines_hz.empty());
  }
  EXPECT_EQ(drilling, 3);
  EXPECT_EQ(chatter, 10);
}

TEST(Corpus, ASeedIsACut) {
  EXPECT_EQ(cut(4).samples, cut(4).samples);
  EXPECT_NE(cut(4).samples, cut(1004).samples);
}

// By another way: at the chatter's frequency the whole signal, forced vibration included, has the line that the truth
// gives where it chatters most (of several lines the strongest), and next to nothing of it before chatter starts.
TEST(Corpus, TheChatterLineIsInTheSignalFromItsOnsetOn) {
  int checked = 0;
  const auto last = 1000 + static_cast<std::uint64_t>(test::seeds(200));
  for (std::uint64_t seed = 1001; seed <= last; ++seed) {
    if ((seed - 1) % 20 % 2 == (seed - 1) / 20 % 2) continue;  // stable
    const DrawnCut d = draw(seed);
    const Truth& t = d.recorded.truth;
    ASSERT_TRUE(t.chatter);
    const double from_s = loudest_s(t);
    const double late = line(d.clean.acceleration_m_per_s2, t.frequency_hz, from_s, from_s + 0.3);
    EXPECT_GT(late, 0.2 * t.final_m_per_s2) << seed;  // several lines share it, and some chatter comes in bursts
    if (d.recorded.course == "abrupt" || t.start_s < 0.9) continue;
    const double early = line(d.clean.acceleration_m_per_s2, t.frequency_hz, t.start_s - 0.3, t.start_s);
    EXPECT_LT(early, 0.15 * late) << seed;
    ++checked;
  }
  EXPECT_GE(checked, 4);
}

TEST(Corpus, LockedChatterIsAtAMultipleOfRotation) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RecordedCut c = locked_chatter(seed);
    const double rotation_hz = static_cast<double>(c.truth.speed_rad_per_s.back()) / (2.0 * pi);
    const double multiple = c.truth.frequency_hz / rotation_hz;
    EXPECT_NEAR(multiple * rotation_hz, std::round(multiple) * rotation_hz, 0.3);
    EXPECT_NE(static_cast<int>(std::round(multiple)) % c.teeth, 0);
  }
}

TEST(Corpus, PeriodDoublingIsAtOddHalvesOfToothPassing) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RecordedCut c = period_doubling(seed);
    EXPECT_EQ(c.teeth % 2, 0);
    const double halves =
        4.0 * pi * c.truth.frequency_hz / static_cast<double>(c.truth.speed_rad_per_s.back()) / c.teeth;
    EXPECT_NEAR(halves, std::round(halves), 0.02);
    EXPECT_EQ(static_cast<int>(std::round(halves)) % 2, 1);
  }
}

TEST(Corpus, HoursGoOnWithoutRepeatingAndEnd) {
  StableHours hours(3, 0.01, 3), again(3, 0.01, 3);
  std::vector<float> first;
  double seconds = 0.0;
  for (auto samples = hours.next(); !samples.empty(); samples = hours.next()) {
    const auto same = again.next();
    ASSERT_TRUE(std::ranges::equal(samples, same));
    EXPECT_FALSE(std::ranges::equal(samples, first));
    first.assign(samples.begin(), samples.end());
    seconds += static_cast<double>(samples.size()) / 2.0 / corpus_rate_hz;
    EXPECT_GT(hours.hint_rad_per_s(), 100.0);
  }
  EXPECT_GE(seconds, 36.0);
  EXPECT_LT(seconds, 46.0);
  EXPECT_DOUBLE_EQ(seconds, hours.seconds());
}

/// A second of chatter from 1 s to 2 s at 500 Hz in a recording of three.
RecordedCut known() {
  RecordedCut c;
  c.samples.assign(2 * 3 * 10240, 0.0F);
  c.truth = {.chatter = true, .start_s = 0.95, .t10_s = 1.0, .end_s = 2.0, .ends = true, .final_m_per_s2 = 1.0};
  c.truth.frequency_hz = 500.0;
  c.truth.lines_hz = {500.0, 600.0};
  c.truth.amplitude_m_per_s2.assign(3 * 10240, 1.0F);
  return c;
}

TEST(Score, CountsWhatItSays) {
  const RecordedCut c = known();
  const std::vector<DetectorDecision> decisions = {
      {.time_s = 0.5, .chatter = true, .stable = false, .frequency_hz = 100.0},
      {.time_s = 0.6},
      {.time_s = 0.97, .chatter = false, .stable = false, .blind = true},
      {.time_s = 1.04, .chatter = true, .stable = false, .frequency_hz = 602.0},
      {.time_s = 2.05, .chatter = true, .stable = false},
      {.time_s = 2.2},
      {.time_s = 2.5, .chatter = true, .stable = false}};
  const CutScore s = score(c, decisions);
  EXPECT_TRUE(s.found);
  EXPECT_EQ(s.false_alarms, 2);
  EXPECT_NEAR(s.delay_s, 0.04, 1e-12);
  EXPECT_NEAR(s.frequency_error_hz, 2.0, 1e-12);
  EXPECT_NEAR(s.strongest_error_hz, 102.0, 1e-12);
  EXPECT_NEAR(s.recovery_s, 0.2, 1e-12);
  RecordedCut stable = c;
  stable.truth.chatter = false;
  EXPECT_EQ(score(stable, decisions).false_alarms, 3);
  EXPECT_FALSE(score(stable, decisions).found);
  const Summary sum = summarise(std::vector{s, score(stable, decisions), score(c, {})});
  EXPECT_EQ(sum.cuts, 3);
  EXPECT_EQ(sum.chatter, 2);
  EXPECT_EQ(sum.found, 1);
  EXPECT_DOUBLE_EQ(sum.blind_share, 1.0 / 7.0);
  EXPECT_EQ(sum.false_alarms, 5);
  EXPECT_NEAR(sum.delay_95_s, 0.04, 1e-12);
}

TEST(Score, QuantilesLieBetweenValues) {
  EXPECT_DOUBLE_EQ(quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(quantile({0.0, 10.0, std::numeric_limits<double>::quiet_NaN()}, 0.95), 9.5);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

// The plain rules detect what nobody could miss.
TEST(Score, BaselinesDetectAStrongLine) {
  RecordedCut c = known();
  Random random(5);
  for (std::size_t i = 0; i < c.samples.size() / 2; ++i) {
    const double t = static_cast<double>(i) / corpus_rate_hz;
    const double line = t > 1.0 && t < 2.0 ? 20.0 * std::sin(2.0 * pi * 517.0 * t) : 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      c.samples[2 * i + k] = static_cast<float>(std::sin(2.0 * pi * 300.0 * t) + line + 0.05 * random.normal());
    }
  }
  c.truth.speed_rad_per_s.assign(c.samples.size() / 2, static_cast<float>(2.0 * pi * 100.0));
  for (const Detector& detector : {Detector(rms_five_sigma), Detector(comb_rms_ratio)}) {
    const CutScore s = score(c, detector(c));
    EXPECT_TRUE(s.found);
    EXPECT_LT(s.delay_s, 0.08);
  }
}

}  // namespace corpus_test
}  // namespace robomill::monitor::testing
