#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "robomill/signal/window_shape.hpp"

/// Synchrosqueezed short-time Fourier transform [ThakurWu2011], [OberlinMeignenPerrier2014].
///
/// Column m stands at the sample m, window g over the samples m - N/2 … m + N/2 - 1, phases relative to m, signal zero
/// outside the record:
///   V_g(m, k) = Σ_d x_{m+d} g(d) e^{-2πikd/N},  k = 0 … N/2,
///   ω̂(m, k) = k f_s/N - Im(V_g'/V_g)/(2π),  g' = dg/dt [1/s]                                      [Auger2013]
/// Each coefficient, times its one-sided weight (1 at k = 0 and N/2, 2 between), is added to the line nearest to ω̂; one
/// that is not above the threshold, or whose ω̂ is not in 0 … f_s/2, stays at its own, so that nothing is lost:
///   x_m = Re Σ_k squeezed(m, k) / (N g(0)),
/// exactly, and a sum over part of the lines is that band's share of the signal.
namespace robomill::signal {

struct SynchrosqueezeOptions {
  double sample_rate_hz = 0.0;       ///< > 0; required
  Eigen::Index window_length = 512;  ///< N [samples], even, 8 … 65536
  Eigen::Index hop = 1;              ///< between columns [samples], >= 1; they stand at its multiples
  WindowKind window = WindowKind::hann;
  double threshold = 0.0;  ///< a coefficient of |V_g| <= threshold Σg/2 stays: of a sine of that amplitude. >= 0
  /// @throws InvalidInput naming the field
  void validate() const;
  [[nodiscard]] Eigen::Index lines() const { return window_length / 2 + 1; }
};

/// `count` bands of one width from 0 to half the rate: their count + 1 edges [Hz].
/// @throws InvalidInput if count < 1 or the rate is not > 0
[[nodiscard]] Eigen::VectorXd equal_bands(double sample_rate_hz, Eigen::Index count);

struct Synchrosqueezed {
  Eigen::VectorXd frequency_hz;  ///< of the lines, N/2 + 1
  Eigen::VectorXd time_s;        ///< of the columns, multiples of hop from 0
  Eigen::MatrixXcd transform;    ///< V_g, lines × columns; empty with Keep::squeezed
  Eigen::MatrixXcd squeezed;     ///< lines × columns, with the one-sided weight
};

/// What is kept of a record: 8 N bytes a column each.
enum class Keep {
  both,     ///< V_g and the squeezed columns
  squeezed  ///< the squeezed columns alone, which sum to the signal: half the memory
};

/// The whole of a record, on the threads of parallel_for; columns at 0, hop, 2 hop … below its length.
/// @param x  length >= 1, finite
/// @throws InvalidInput if x or an option makes no sense
[[nodiscard]] Synchrosqueezed synchrosqueeze(const Eigen::Ref<const Eigen::VectorXd>& x,
                                             const SynchrosqueezeOptions& options, Keep keep = Keep::both);

/// The bands' shares of x at the columns, bands × columns: the sum over the lines with edges_hz(b) <= f < edges_hz(b +
/// 1); the last band has its upper edge too. Bands that cover 0 … f_s/2 sum to x.
/// @param edges_hz  length bands + 1, rising, 1 to 255 bands
/// @throws InvalidInput if x, an option or the edges make no sense
[[nodiscard]] Eigen::MatrixXd band_signals(const Eigen::Ref<const Eigen::VectorXd>& x,
                                           const SynchrosqueezeOptions& options,
                                           const Eigen::Ref<const Eigen::VectorXd>& edges_hz);

class SynchrosqueezeEngine;

/// The same transform of a signal that comes sample by sample, zero before the first: each column is computed once, as
/// soon as its last sample, N/2 - 1 after its centre, is there. Memory near 100 N bytes. Everything but construction is
/// noexcept and allocates nothing; a sample that is not finite counts as zero. How the samples are split into calls
/// changes no bit.
class SynchrosqueezeStream {
 public:
  /// @param edges_hz  of the bands, as band_signals; empty: none
  /// @throws InvalidInput if an option or the edges make no sense
  explicit SynchrosqueezeStream(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz = {});
  ~SynchrosqueezeStream();
  SynchrosqueezeStream(SynchrosqueezeStream&& other) noexcept;
  SynchrosqueezeStream& operator=(SynchrosqueezeStream&& other) noexcept;

  /// True: a column is ready, and the getters show it until the next push.
  bool push(double sample) noexcept;

  struct Progress {
    std::size_t samples = 0;  ///< taken from the input
    std::size_t columns = 0;  ///< written to the output
  };
  /// Takes samples until none is left or `band_signals`, of `bands()` values a column, has no room for the next one.
  Progress push(std::span<const double> samples, std::span<double> band_signals) noexcept;

  /// The sample at which the newest column stands, counted from the first pushed as 0.
  [[nodiscard]] std::uint64_t centre() const noexcept;
  /// The bands' shares of the signal there.
  [[nodiscard]] std::span<const double> band_values() const noexcept;
  /// The squeezed column, N/2 + 1 lines.
  void squeezed(std::span<std::complex<double>> out) const noexcept;
  [[nodiscard]] std::size_t bands() const noexcept;
  [[nodiscard]] std::size_t lines() const noexcept;
  /// As after construction.
  void reset() noexcept;

 private:
  std::unique_ptr<SynchrosqueezeEngine> engine_;
};

}  // namespace robomill::signal
