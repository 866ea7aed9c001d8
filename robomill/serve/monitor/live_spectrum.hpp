#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/monitor.hpp"

// Method: robomill/serve/README.md, "Monitor"

namespace robomill::serve {

/// Amplitude spectra of the newest samples, 0.1 s each and half a window apart, in bands: the strongest line of each
/// band, of any channel of vibration and of all spectra since they were taken last.
class LiveSpectrum {
 public:
  static constexpr std::size_t most_bands = 256, most_channels = 4;
  explicit LiveSpectrum(const monitor::MonitorOptions& options);

  /// Whole frames; a sample that is not finite counts as zero.
  void add(std::span<const float> samples);
  /// What comes has nothing to do with what was before.
  void restart() { filled_ = 0; }
  /// Peak amplitude of each band [input's unit]; empty where no spectrum was made since it was called last.
  [[nodiscard]] std::vector<float> take();
  /// Of the bands, their number and one more, rising. A band is a line wide below and wider in proportion above, so
  /// that there are at most 256 up to half the sample rate or 10 kHz.
  [[nodiscard]] const std::vector<double>& edges_hz() const { return edges_hz_; }

 private:
  void transform();
  double sample_rate_hz_;
  std::size_t channels_;
  std::vector<std::size_t> shown_;       ///< channels
  std::vector<Eigen::VectorXd> window_;  ///< of each of these
  Eigen::Index filled_ = 0;
  std::vector<Eigen::Index> first_line_;  ///< of each band, and the line behind the last
  std::vector<double> edges_hz_;
  std::vector<float> strongest_;  ///< empty: no spectrum yet
};

}  // namespace robomill::serve
