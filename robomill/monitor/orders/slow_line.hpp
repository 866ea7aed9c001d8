#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// Finds the strongest low line beside the orders of a slow spindle, in a window of eight turns. Nothing is allocated
/// after construction.
class SlowLine {
 public:
  /// @param like  the spectra with the most lines
  SlowLine(const Spectrum& like, double highest_hz);
  /// A hop. @param power  |X|², of all channels, line by line
  void step(std::span<const float> power, const Spectrum& like, double rotation_hz) noexcept;
  void reset() noexcept { frequency_hz_ = 0.0; }

  [[nodiscard]] double frequency_hz() const noexcept { return frequency_hz_; }  ///< 0: none

  static constexpr double highest_line_hz = 250.0;

 private:
  double highest_hz_;
  std::vector<float> rest_;  // of each line, above the skirts
  double frequency_hz_ = 0.0;
};

}  // namespace robomill::monitor
