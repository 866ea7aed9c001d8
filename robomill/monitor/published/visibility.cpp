#include "robomill/monitor/published/visibility.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "robomill/base/statistics.hpp"
#include "robomill/signal/fft.hpp"
#include "robomill/signal/window.hpp"

namespace robomill::monitor {
namespace {

constexpr double six_db = 3.981071705534973;  ///< 10^0.6
constexpr Eigen::Index surroundings = 16;     ///< lines on either side
constexpr int columns_in_a_row = 3;

struct Spectrogram {
  Eigen::MatrixXd power;        // lines × columns, over all channels
  std::vector<double> first_s;  // first and last sample of a column
  std::vector<double> last_s;
};

Spectrogram spectrogram(const Recording& recording, const MonitorOptions& o) {
  const auto window = static_cast<Eigen::Index>(o.window_samples()), hop = static_cast<Eigen::Index>(o.hop_samples());
  const Eigen::Index channels = o.channels;
  const Eigen::Index frames = static_cast<Eigen::Index>(recording.samples.size()) / channels;
  const Eigen::Map<const Eigen::MatrixXf> samples(recording.samples.data(), channels, frames);
  const Eigen::VectorXd g = signal::hann_window(window);
  const Eigen::Index columns = (frames - window) / hop + 1;
  Spectrogram out = {Eigen::MatrixXd::Zero(window / 2 + 1, columns), {}, {}};
  for (Eigen::Index m = 0; m < columns; ++m) {
    out.first_s.push_back(static_cast<double>(m * hop) / o.sample_rate_hz);
    out.last_s.push_back(static_cast<double>(m * hop + window - 1) / o.sample_rate_hz);
    for (Eigen::Index c = 0; c < channels; ++c) {
      if (c == o.tachometer_channel) continue;
      const Eigen::VectorXd part = samples.row(c).segment(m * hop, window).transpose().cast<double>();
      out.power.col(m) += signal::real_fft(g.cwiseProduct(part)).cwiseAbs2();
    }
  }
  return out;
}

bool stands_out(const Eigen::MatrixXd& power, Eigen::Index line, Eigen::Index column, double stable) {
  std::vector<double> around;
  for (Eigen::Index k = std::max<Eigen::Index>(0, line - surroundings);
       k <= std::min(power.rows() - 1, line + surroundings); ++k) {
    if (k != line) around.push_back(power(k, column));
  }
  return power(line, column) > six_db * median(around) && power(line, column) > six_db * stable;
}

}  // namespace

Visibility visibility(const Recording& recording, const MonitorOptions& options) {
  if (!recording.chatter || !std::isfinite(recording.onset_s)) return {};
  const Spectrogram s = spectrogram(recording, options);
  const auto before = std::lower_bound(s.last_s.begin(), s.last_s.end(), recording.onset_s) - s.last_s.begin();
  const auto from = std::lower_bound(s.first_s.begin(), s.first_s.end(), recording.onset_s) - s.first_s.begin();
  if (before < columns_in_a_row || from >= s.power.cols()) return {};
  Eigen::Index line = 0;
  double most = 0.0, stable_of_line = 0.0;
  for (Eigen::Index k = 1; k + 1 < s.power.rows(); ++k) {
    const Eigen::VectorXd then = s.power.row(k).head(before).transpose();
    const double stable = median(std::vector<double>(then.begin(), then.end()));
    const double growth = s.power.row(k).tail(s.power.cols() - from).mean() - stable;
    if (growth > most) {
      line = k;
      most = growth;
      stable_of_line = stable;
    }
  }
  if (line == 0) return {};
  Visibility out = {static_cast<double>(line) * options.sample_rate_hz / static_cast<double>(options.window_samples()),
                    unknown_s};
  int row = 0;
  for (Eigen::Index m = before; m < s.power.cols(); ++m) {
    row = stands_out(s.power, line, m, stable_of_line) ? row + 1 : 0;
    if (row < columns_in_a_row) continue;
    out.visible_s = s.last_s[static_cast<std::size_t>(m)];
    return out;
  }
  return {};
}

}  // namespace robomill::monitor
