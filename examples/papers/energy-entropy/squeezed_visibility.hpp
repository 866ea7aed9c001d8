#pragma once
// When chatter's line becomes visible in the synchrosqueezed spectrogram, as the source reads it from figures.
#include <Eigen/Core>
#include <array>

#include "examples/calibrate-holes/holes.hpp"
#include "robomill/monitor/calibration.hpp"

namespace robomill::examples {

/// Power in the squeezed columns of both channels, a column each millisecond.
struct SqueezedPower {
  Eigen::VectorXd time_s;        ///< of the columns' centres, in the record
  Eigen::VectorXd frequency_hz;  ///< of the lines
  Eigen::MatrixXd power;         ///< lines × columns [(m/s²)²]
};
/// Hann window of 512 samples, as the detector's.
[[nodiscard]] SqueezedPower squeezed_power(const Hole& hole);

/// Of a line's greatest amplitude: where a colour scale that is linear up to that begins to show the line depends on
/// its colours.
inline constexpr std::array<double, 4> visible_shares = {0.05, 0.1, 0.2, 0.5};

/// Times are those of a column's centre, as a figure's axis has them; NaN: not visible.
struct SqueezedVisibility {
  SqueezedVisibility() noexcept { share_s.fill(monitor::unknown_s); }
  double line_hz = monitor::unknown_s;
  double visible_s = monitor::unknown_s;                   ///< by the rule of monitor::calibrate()
  std::array<double, visible_shares.size()> share_s = {};  ///< when the line first has that share
  [[nodiscard]] double tenth_s() const noexcept { return share_s[1]; }
};
/// The rule of monitor::calibrate() on the squeezed spectrogram. Power is taken over three lines and 25 ms about a
/// column, since squeezing empties the lines beside a ridge. The line is the one whose mean power from the onset on has
/// grown most over its median from the drill's contact to the onset. It is visible from the first column on of 75 ms in
/// which it stands 6 dB above the median of the 16 lines on either side and above that median of its own.
[[nodiscard]] SqueezedVisibility squeezed_visibility(const SqueezedPower& squeezed, double onset_s);

}  // namespace robomill::examples
