#include "robomill/signal/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/signal/fft.hpp"
#include "robomill/signal/window.hpp"

namespace robomill::signal {
namespace {

SpectralPeak interpolate(const Spectrum& spectrum, Eigen::Index k) {
  const Eigen::VectorXd& a = spectrum.amplitude;
  const bool up = a(k + 1) >= a(k - 1);
  const double ratio = (up ? a(k + 1) : a(k - 1)) / a(k);
  const double delta = std::clamp((2.0 * ratio - 1.0) / (ratio + 1.0), 0.0, 0.5);
  const double angle = std::numbers::pi * delta;
  const double scallop = delta > 0.0 ? (1.0 - delta * delta) * angle / std::sin(angle) : 1.0;
  const double spacing_hz = spectrum.frequency_hz(1) - spectrum.frequency_hz(0);
  return {.frequency_hz = spectrum.frequency_hz(k) + (up ? delta : -delta) * spacing_hz, .amplitude = a(k) * scallop};
}

}  // namespace

Spectrum amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& x, double sample_rate_hz) {
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  const Eigen::Index n = x.size();
  if (n < 4) throw InvalidInput("signal", static_cast<double>(n), "samples", "must have at least 4");
  if (!x.allFinite()) throw InvalidInput("signal", "holds a value that is not finite");
  const double mean = x.mean();
  const Eigen::VectorXd window = hann_window(n);
  const Eigen::VectorXd windowed = (x.array() - mean).matrix().cwiseProduct(window);
  Spectrum spectrum;
  spectrum.amplitude = real_fft(windowed).cwiseAbs() * (2.0 / window.sum());
  spectrum.amplitude(0) = std::abs(mean);
  if (n % 2 == 0) spectrum.amplitude(n / 2) *= 0.5;
  const double spacing_hz = sample_rate_hz / static_cast<double>(n);
  const Eigen::Index last = n / 2;
  spectrum.frequency_hz = Eigen::VectorXd::LinSpaced(last + 1, 0.0, static_cast<double>(last) * spacing_hz);
  return spectrum;
}

void PeakOptions::validate() const {
  if (count < 1) throw InvalidInput("count", static_cast<double>(count), "peaks", "must be at least 1");
  require_non_negative("min_frequency_hz", min_frequency_hz, "Hz");
  require_non_negative("max_frequency_hz", max_frequency_hz, "Hz");
  require_non_negative("min_separation_hz", min_separation_hz, "Hz");
  if (!(relative_height >= 0.0 && relative_height <= 1.0)) {
    throw InvalidInput("relative_height", relative_height, "", "must lie between 0 and 1");
  }
}

std::vector<SpectralPeak> find_peaks(const Spectrum& spectrum, const PeakOptions& options) {
  options.validate();
  const Eigen::VectorXd& a = spectrum.amplitude;
  if (a.size() < 3 || a.size() != spectrum.frequency_hz.size()) {
    throw InvalidInput("spectrum", "needs at least three lines and one frequency for each");
  }
  const auto inside = [&](Eigen::Index k) {
    const double f = spectrum.frequency_hz(k);
    return f >= options.min_frequency_hz && (options.max_frequency_hz == 0.0 || f <= options.max_frequency_hz);
  };
  double highest = 0.0;
  for (Eigen::Index k = 1; k < a.size() - 1; ++k) highest = inside(k) ? std::max(highest, a(k)) : highest;

  std::vector<SpectralPeak> found;
  for (Eigen::Index k = 1; k < a.size() - 1; ++k) {
    const bool peak = a(k) > a(k - 1) && a(k) >= a(k + 1);
    if (peak && inside(k) && a(k) >= options.relative_height * highest) found.push_back(interpolate(spectrum, k));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const SpectralPeak& p, const SpectralPeak& q) { return p.amplitude > q.amplitude; });

  std::vector<SpectralPeak> kept;
  for (const SpectralPeak& peak : found) {
    if (kept.size() == static_cast<std::size_t>(options.count)) break;
    const bool crowded = std::any_of(kept.begin(), kept.end(), [&](const SpectralPeak& other) {
      return std::abs(other.frequency_hz - peak.frequency_hz) < options.min_separation_hz;
    });
    if (!crowded) kept.push_back(peak);
  }
  return kept;
}

}  // namespace robomill::signal
