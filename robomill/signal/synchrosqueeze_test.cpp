#include "robomill/signal/synchrosqueeze.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/base/lanes.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "testing/allocations.hpp"
#include "testing/support.hpp"

namespace robomill::signal {
namespace synchrosqueeze_test {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr WindowKind all_kinds[] = {WindowKind::hann, WindowKind::blackman_harris};

Eigen::VectorXd noise(Eigen::Index n, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd x(n);
  for (double& value : x) value = random.normal();
  return x;
}

/// The bands' shares of the signal from stored columns, line by line.
Eigen::MatrixXd sums_of_lines(const Eigen::MatrixXcd& squeezed, const SynchrosqueezeOptions& o,
                              const Eigen::VectorXd& edges_hz) {
  const Eigen::Index bands = edges_hz.size() - 1;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(bands, squeezed.cols());
  for (Eigen::Index k = 0; k < squeezed.rows(); ++k) {
    const double f = static_cast<double>(k) * o.sample_rate_hz / static_cast<double>(o.window_length);
    for (Eigen::Index b = 0; b < bands; ++b) {
      if (f < edges_hz(b) || f > edges_hz(b + 1) || (f == edges_hz(b + 1) && b + 1 < bands)) continue;
      out.row(b) += squeezed.row(k).real() / static_cast<double>(o.window_length);
    }
  }
  return out;
}

/// Σ_d x_{m+d} w(d) e^{-2πikd/N}, term by term.
Complex defining_sum(const Eigen::VectorXd& x, const Eigen::VectorXd& w, Eigen::Index m, Eigen::Index k) {
  const Eigen::Index n = w.size();
  Complex sum = 0.0;
  for (Eigen::Index d = -n / 2; d < n / 2; ++d) {
    if (m + d < 0 || m + d >= x.size()) continue;
    const double angle = -2.0 * pi * static_cast<double>((k * (d + n)) % n) / static_cast<double>(n);
    sum += x(m + d) * w(d + n / 2) * std::polar(1.0, angle);
  }
  return sum;
}

struct Case {
  WindowKind kind;
  Eigen::Index hop;
};
class SynchrosqueezeCases : public ::testing::TestWithParam<Case> {
 protected:
  [[nodiscard]] static SynchrosqueezeOptions options(Eigen::Index n = 64) {
    return {.sample_rate_hz = 1000.0, .window_length = n, .hop = GetParam().hop, .window = GetParam().kind};
  }
};

// Both paths, sliding lines and FFT, against the definition of V_g, V_g' and ω̂.
TEST_P(SynchrosqueezeCases, IsItsDefiningSum) {
  const SynchrosqueezeOptions o = options();
  const Eigen::VectorXd x = noise(700, 1), g = window_samples(o.window, 64);
  const Eigen::VectorXd slope = window_derivative(o.window, 64, o.sample_rate_hz);
  const Synchrosqueezed out = synchrosqueeze(x, o);
  ASSERT_EQ(out.transform.cols(), (700 + o.hop - 1) / o.hop);
  for (Eigen::Index column = 0; column < out.transform.cols(); column += 7) {
    const Eigen::Index m = column * o.hop;
    EXPECT_DOUBLE_EQ(out.time_s(column), static_cast<double>(m) / 1000.0);
    Eigen::VectorXcd squeezed = Eigen::VectorXcd::Zero(33);
    for (Eigen::Index k = 0; k <= 32; ++k) {
      const Complex v = defining_sum(x, g, m, k);
      EXPECT_LT(std::abs(out.transform(k, column) - v), 1e-12) << "column " << column << " line " << k;
      const double omega_hz = out.frequency_hz(k) - std::imag(defining_sum(x, slope, m, k) / v) / (2.0 * pi);
      const double line = std::round(omega_hz / out.frequency_hz(1));
      squeezed(line >= 0.0 && line <= 32.0 ? static_cast<Eigen::Index>(line) : k) += (k % 32 == 0 ? 1.0 : 2.0) * v;
    }
    EXPECT_LT((out.squeezed.col(column) - squeezed).cwiseAbs().maxCoeff(), 1e-11) << "column " << column;
  }
}

TEST_P(SynchrosqueezeCases, BandsSumToTheSignal) {
  Random random(2);
  for (int trial = 0; trial < 5; ++trial) {
    SynchrosqueezeOptions o = options(2 * static_cast<Eigen::Index>(4 + random.index(100)));
    o.threshold = trial == 0 ? 0.5 : 0.0;
    const Eigen::VectorXd x = noise(900, 3 + static_cast<std::uint64_t>(trial));
    Eigen::VectorXd edges(2 + static_cast<Eigen::Index>(random.index(9)));
    edges(0) = 0.0;
    for (Eigen::Index b = 1; b < edges.size(); ++b) edges(b) = edges(b - 1) + random.uniform(1e-3, 1.0);
    edges *= 500.0 / edges(edges.size() - 1);
    edges(edges.size() - 1) = 500.0;
    const Synchrosqueezed out = synchrosqueeze(x, o);
    const Eigen::VectorXd whole =
        out.squeezed.real().colwise().sum().transpose() / static_cast<double>(o.window_length);
    const Eigen::MatrixXd bands = sums_of_lines(out.squeezed, o, edges), direct = band_signals(x, o, edges);
    for (Eigen::Index column = 0; column < whole.size(); ++column) {
      EXPECT_NEAR(whole(column), x(column * o.hop), 1e-12);
      EXPECT_NEAR(bands.col(column).sum(), x(column * o.hop), 1e-12);
    }
    EXPECT_LT((bands - direct).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// Narrow bands, bands without a line, lines without a band: the sum in lanes against the one over stored columns.
TEST_P(SynchrosqueezeCases, BandsMayBeNarrowAndLeaveLinesOut) {
  const SynchrosqueezeOptions o = options(200);
  const Eigen::VectorXd x = noise(600, 10);
  Eigen::VectorXd fine = Eigen::VectorXd::LinSpaced(252, 30.0, 400.0), rough(4);
  rough << 77.0, 78.0, 120.0, 480.0;
  for (const Eigen::VectorXd& edges : {fine, rough}) {
    const Eigen::MatrixXd stored = sums_of_lines(synchrosqueeze(x, o).squeezed, o, edges);
    EXPECT_LT((stored - band_signals(x, o, edges)).cwiseAbs().maxCoeff(), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(WindowsAndHops, SynchrosqueezeCases, ::testing::ValuesIn([] {
                           std::vector<Case> cases;
                           for (const WindowKind kind : all_kinds) {
                             for (const Eigen::Index hop : {1, 5, 60}) cases.push_back({kind, hop});
                           }
                           return cases;
                         }()),
                         [](const auto& one) { return "case" + std::to_string(one.index); });

/// The line with the most in a column.
Eigen::Index highest(const Eigen::MatrixXcd& squeezed, Eigen::Index column) {
  Eigen::Index at = 0;
  squeezed.col(column).cwiseAbs().maxCoeff(&at);
  return at;
}

// Away from the other tone's skirt all of a tone goes to the line nearest to it, wherever it lies between lines.
TEST(Synchrosqueeze, GathersTwoTonesInTheirLines) {
  const double rate_hz = 10240.0;
  const SynchrosqueezeOptions o = {.sample_rate_hz = rate_hz, .hop = 64, .window = WindowKind::blackman_harris};
  const double first_hz = 683.6, second_hz = 2107.3;
  Eigen::VectorXd x(8192);
  for (Eigen::Index m = 0; m < x.size(); ++m) {
    const double t = static_cast<double>(m) / rate_hz;
    x(m) = 1.3 * std::cos(2.0 * pi * first_hz * t + 0.4) + 0.7 * std::cos(2.0 * pi * second_hz * t - 1.1);
  }
  const Synchrosqueezed out = synchrosqueeze(x, o);
  const auto first = static_cast<Eigen::Index>(std::lround(first_hz / 20.0));
  const auto second = static_cast<Eigen::Index>(std::lround(second_hz / 20.0));
  for (Eigen::Index column = 8; column < 120; ++column) {
    EXPECT_EQ(highest(out.squeezed, column), first);
    const double scale = 1.0 / 512.0, t = out.time_s(column);
    // -92 dB of what leaks past the window's main lobe stays in place or goes elsewhere.
    EXPECT_LT(std::abs(scale * out.squeezed(first, column) - std::polar(1.3, 2.0 * pi * first_hz * t + 0.4)), 2e-3);
    EXPECT_LT(std::abs(scale * out.squeezed(second, column) - std::polar(0.7, 2.0 * pi * second_hz * t - 1.1)), 2e-3);
  }
}

TEST(Synchrosqueeze, SmallCoefficientsKeepTheirLine) {
  Eigen::VectorXd x(2048);
  for (Eigen::Index m = 0; m < x.size(); ++m) x(m) = std::sin(0.3217 * static_cast<double>(m));
  SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 128, .hop = 512};
  o.threshold = 1.01;  // above the tone
  const Synchrosqueezed out = synchrosqueeze(x, o);
  for (Eigen::Index k = 0; k < 65; ++k) {
    EXPECT_EQ(out.squeezed(k, 2), (k % 64 == 0 ? 1.0 : 2.0) * out.transform(k, 2));
  }
  o.threshold = 0.5;  // the tone's main lobe moves
  EXPECT_GT(std::abs(synchrosqueeze(x, o).squeezed(7, 2)), 1.5 * std::abs(2.0 * out.transform(7, 2)));
}

TEST(Synchrosqueeze, DoesNotDependOnThreads) {
  const SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 64};
  const Eigen::VectorXd x = noise(3000, 4), edges = equal_bands(1000.0, 16);
  const int threads = thread_count();
  set_thread_count(1);
  const Synchrosqueezed one = synchrosqueeze(x, o);
  const Eigen::MatrixXd bands = band_signals(x, o, edges);
  set_thread_count(3);
  const Synchrosqueezed three = synchrosqueeze(x, o);
  EXPECT_EQ(one.transform, three.transform);
  EXPECT_EQ(one.squeezed, three.squeezed);
  EXPECT_EQ(one.squeezed, synchrosqueeze(x, o, Keep::squeezed).squeezed);
  EXPECT_EQ(bands, band_signals(x, o, edges));
  set_thread_count(threads);
}

TEST(SynchrosqueezeStream, GivesTheNumbersOfTheWholeRecord) {
  for (const WindowKind kind : all_kinds) {
    for (const Eigen::Index hop : {1, 7, 256}) {
      const SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 96, .hop = hop, .window = kind};
      const Eigen::VectorXd x = noise(2500, 5), edges = equal_bands(1000.0, 5);
      const Synchrosqueezed whole = synchrosqueeze(x, o);
      const Eigen::MatrixXd bands = band_signals(x, o, edges);
      SynchrosqueezeStream stream(o, edges);
      Eigen::VectorXcd squeezed(49);
      Eigen::Index column = 0;
      for (Eigen::Index m = 0; m < x.size() + 47; ++m) {
        if (!stream.push(m < x.size() ? x(m) : 0.0)) continue;
        ASSERT_EQ(stream.centre(), static_cast<std::uint64_t>(column * hop));
        ASSERT_EQ(column * hop + 47, m);
        stream.squeezed({squeezed.data(), 49});
        ASSERT_LT((squeezed - whole.squeezed.col(column)).cwiseAbs().maxCoeff(), 4e-12);
        for (Eigen::Index b = 0; b < 5; ++b) {
          ASSERT_NEAR(stream.band_values()[static_cast<std::size_t>(b)], bands(b, column), 1e-13);
        }
        ++column;
      }
      EXPECT_EQ(column, whole.transform.cols());
    }
  }
}

TEST(SynchrosqueezeStream, AnySplitGivesTheSameBits) {
  for (const Eigen::Index hop : {1, 3, 64}) {
    const SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 64, .hop = hop};
    const Eigen::VectorXd edges = equal_bands(1000.0, 4), x = noise(5000, 6);
    const auto size_of_x = static_cast<std::size_t>(x.size());
    const auto run = [&](std::uint64_t seed) {
      SynchrosqueezeStream stream(o, edges);
      Random random(seed);
      std::vector<double> out, room(4 * 200);
      for (std::size_t at = 0; at < size_of_x;) {
        const std::size_t size = std::min(size_of_x - at, 1 + static_cast<std::size_t>(random.index(170)));
        const std::size_t columns = 1 + static_cast<std::size_t>(random.index(200));  // perhaps too few for all of it
        const auto done =
            stream.push(std::span<const double>(x.data() + at, size), std::span<double>(room).first(4 * columns));
        EXPECT_LE(done.columns, columns);
        out.insert(out.end(), room.begin(), room.begin() + static_cast<std::ptrdiff_t>(4 * done.columns));
        at += done.samples;
      }
      return out;
    };
    const std::vector<double> once = run(1);
    EXPECT_EQ(once.size(), 4 * static_cast<std::size_t>((5000 - 32) / hop + 1));
    EXPECT_EQ(once, run(2));
  }
}

TEST(SynchrosqueezeStream, EveryKernelGivesTheSameBits) {
  const Kernels best = kernels();
  const SynchrosqueezeOptions o = {
      .sample_rate_hz = 1000.0, .window_length = 64, .window = WindowKind::blackman_harris};
  const Eigen::VectorXd x = noise(2000, 7), edges = equal_bands(1000.0, 16);
  const auto run = [&](Kernels choice) {
    kernels() = choice;
    return band_signals(x, o, edges);
  };
  const Eigen::MatrixXd plain = run(Kernels::baseline);
  if (best != Kernels::baseline) {
    EXPECT_EQ(plain, run(Kernels::avx2));
  }
  EXPECT_EQ(plain, run(best));
  kernels() = best;
}

// A thousandth of 1e9 samples, in full a hundredth; all of them in bench/synchrosqueeze_soak.cpp.
TEST(SynchrosqueezeStream, RoundingDoesNotGrowWithTime) {
  const SynchrosqueezeOptions o = {.sample_rate_hz = 10240.0, .window_length = 512, .hop = 16};
  SynchrosqueezeStream stream(o, equal_bands(10240.0, 16));
  Random random(8);
  std::vector<double> last(512);
  const std::uint64_t samples = static_cast<std::uint64_t>(test::seeds(10)) * 1'000'000;
  double worst = 0.0;
  for (std::uint64_t m = 0; m < samples; ++m) {
    const double x = random.uniform(-0.5, 0.5) + 0.5 * std::sin(0.7 * static_cast<double>(m));
    last[m % 512] = x;
    if (!stream.push(x)) continue;
    double sum = 0.0;
    for (const double band : stream.band_values()) sum += band;
    worst = std::max(worst, std::abs(sum - last[stream.centre() % 512]));
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(SynchrosqueezeStream, ForgetsWhatWasNotFinite) {
  const SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 64};
  SynchrosqueezeStream faulty(o, equal_bands(1000.0, 4)), zero(o, equal_bands(1000.0, 4));
  for (int m = 0; m < 300; ++m) {
    const bool bad = m % 50 == 20;
    const double x = std::cos(0.4 * m);
    faulty.push(bad ? (m % 100 == 20 ? std::nan("") : -INFINITY) : x);
    zero.push(bad ? 0.0 : x);
    for (std::size_t b = 0; b < 4; ++b) ASSERT_EQ(faulty.band_values()[b], zero.band_values()[b]);
  }
}

TEST(SynchrosqueezeStream, ResetIsAsNew) {
  const SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 64};
  SynchrosqueezeStream used(o, equal_bands(1000.0, 4)), fresh(o, equal_bands(1000.0, 4));
  for (int m = 0; m < 777; ++m) used.push(std::sin(1.1 * m));
  used.reset();
  for (int m = 0; m < 200; ++m) {
    ASSERT_EQ(used.push(std::cos(0.3 * m)), fresh.push(std::cos(0.3 * m)));
    ASSERT_EQ(used.centre(), fresh.centre());
    for (std::size_t b = 0; b < 4; ++b) ASSERT_EQ(used.band_values()[b], fresh.band_values()[b]);
  }
}

TEST(SynchrosqueezeStream, AllocatesNothing) {
  for (const WindowKind kind : all_kinds) {
    for (const Eigen::Index n : {512, 510, 2 * 61}) {
      SynchrosqueezeStream stream({.sample_rate_hz = 1000.0, .window_length = n, .hop = 8, .window = kind},
                                  equal_bands(1000.0, 16));
      std::vector<double> out(16 * 200);
      std::vector<double> block(1500, 0.25);
      std::vector<Complex> column(stream.lines());
      EXPECT_EQ(test::allocations([&] {
                  static_cast<void>(stream.push(block, out));
                  for (int m = 0; m < 50; ++m) {
                    if (stream.push(0.1 * m)) stream.squeezed(column);
                  }
                  stream.reset();
                }),
                0U);
    }
  }
}

TEST(Synchrosqueeze, RejectsWhatMakesNoSense) {
  const Eigen::VectorXd x = noise(100, 9);
  const auto field = [&](SynchrosqueezeOptions o) {
    return test::field_of([&] { static_cast<void>(synchrosqueeze(x, o)); });
  };
  EXPECT_EQ(field({}), "sample_rate_hz");
  EXPECT_EQ(field({.sample_rate_hz = 1.0, .window_length = 63}), "window_length");
  EXPECT_EQ(field({.sample_rate_hz = 1.0, .window_length = 6}), "window_length");
  EXPECT_EQ(field({.sample_rate_hz = 1.0, .hop = 0}), "hop");
  EXPECT_EQ(field({.sample_rate_hz = 1.0, .threshold = -1.0}), "threshold");
  EXPECT_EQ(field({.sample_rate_hz = 1.0, .window_length = 64}), "accepted");
  const SynchrosqueezeOptions o = {.sample_rate_hz = 1000.0, .window_length = 64};
  Eigen::VectorXd bad = x;
  bad(3) = std::nan("");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(synchrosqueeze(bad, o)); }), "signal");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(synchrosqueeze(Eigen::VectorXd(), o)); }), "signal");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(band_signals(x, o, Eigen::VectorXd::Zero(1))); }), "edges_hz");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(SynchrosqueezeStream(o, Eigen::Vector3d(0, 9, 9))); }), "edges_hz");
}

TEST(EqualBands, CoverHalfTheRate) {
  const Eigen::VectorXd edges = equal_bands(10240.0, 16);
  ASSERT_EQ(edges.size(), 17);
  EXPECT_EQ(edges(0), 0.0);
  EXPECT_EQ(edges(1), 320.0);
  EXPECT_EQ(edges(16), 5120.0);
}

}  // namespace synchrosqueeze_test
}  // namespace robomill::signal
