#pragma once
#include <Eigen/Core>
#include <vector>

namespace robomill::signal {

/// One-sided amplitude spectrum: a sine of amplitude A at one of the lines shows A there.
struct Spectrum {
  Eigen::VectorXd frequency_hz;  ///< length n/2 + 1, from 0, evenly spaced by sample rate / n
  Eigen::VectorXd amplitude;     ///< as long, in the signal's unit
};

/// |FFT(w (x - mean))|, w the Hann window, scaled to amplitudes. The mean is taken off so that its skirt hides no low
/// line; the line at zero shows its size.
/// @param x  length n >= 4, finite
/// @throws InvalidInput if x is shorter, not finite, or the rate is not > 0
[[nodiscard]] Spectrum amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& x, double sample_rate_hz);

struct SpectralPeak {
  double frequency_hz = 0.0;
  double amplitude = 0.0;
};

struct PeakOptions {
  int count = 10;                  ///< at most so many, the highest ones; >= 1
  double min_frequency_hz = 0.0;   ///< >= 0; a line f counts where f >= this
  double max_frequency_hz = 0.0;   ///< >= 0; a line f counts where f <= this; 0: no limit
  double relative_height = 0.05;   ///< in [0, 1]; a line counts where A >= this · the highest A in the band
  double min_separation_hz = 0.0;  ///< >= 0; of two peaks with |Δf| < this only the higher counts
  /// @throws InvalidInput naming the field
  void validate() const;
};

/// Peaks of an amplitude_spectrum, by falling amplitude. Frequency and amplitude are interpolated between the highest
/// line and the higher of its neighbours, exact for a lone sine under the Hann window: δ = (2α - 1)/(α + 1), α =
/// A_{k±1}/A_k, f = (k ± δ) Δf, A = A_k (1 - δ²) πδ / sin πδ. [Grandke1983]
/// @throws InvalidInput if the lengths differ or there are fewer than three lines
[[nodiscard]] std::vector<SpectralPeak> find_peaks(const Spectrum& spectrum, const PeakOptions& options = {});

}  // namespace robomill::signal
