#include "examples/papers/energy-entropy/squeezed_visibility.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "robomill/base/statistics.hpp"
#include "robomill/signal/synchrosqueeze.hpp"

namespace robomill::examples {
namespace {

constexpr Eigen::Index hop = 10;            ///< samples: a millisecond
constexpr Eigen::Index half_smoothed = 12;  ///< columns on either side: 25 ms in all
constexpr Eigen::Index lasting = 77;        ///< columns: 75 ms
constexpr Eigen::Index surroundings = 16;   ///< lines on either side
constexpr double six_db = 3.981071705534973;

/// Over three lines, and over the columns of 25 ms about each.
Eigen::MatrixXd smooth(const Eigen::MatrixXd& power) {
  Eigen::MatrixXd lines = power;
  lines.topRows(power.rows() - 1) += power.bottomRows(power.rows() - 1);
  lines.bottomRows(power.rows() - 1) += power.topRows(power.rows() - 1);
  Eigen::MatrixXd out(power.rows(), power.cols());
  for (Eigen::Index m = 0; m < power.cols(); ++m) {
    const Eigen::Index first = std::max<Eigen::Index>(0, m - half_smoothed);
    const Eigen::Index last = std::min(power.cols() - 1, m + half_smoothed);
    out.col(m) = lines.middleCols(first, last + 1 - first).rowwise().mean();
  }
  return out;
}

double median_around(const Eigen::MatrixXd& power, Eigen::Index line, Eigen::Index column) {
  std::vector<double> around;
  const Eigen::Index last = std::min(power.rows() - 1, line + surroundings);
  for (Eigen::Index k = std::max<Eigen::Index>(0, line - surroundings); k <= last; ++k) {
    if (std::abs(k - line) > 1) around.push_back(power(k, column));  // its neighbours are in its own sum
  }
  return median(std::move(around));
}

}  // namespace

SqueezedPower squeezed_power(const Hole& hole) {
  SqueezedPower out;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Eigen::VectorXd x = hole.record.acceleration_m_per_s2.col(axis);
    const signal::Synchrosqueezed squeezed = signal::synchrosqueeze(
        x, {.sample_rate_hz = hole_rate_hz, .window_length = 512, .hop = hop}, signal::Keep::squeezed);
    const double scale = 1.0 / (512.0 * 512.0);  // a sine of amplitude A at a line sums to (A N g(0) / N)²
    if (axis == 0) {
      out.time_s = squeezed.time_s;
      out.frequency_hz = squeezed.frequency_hz;
      out.power = Eigen::MatrixXd::Zero(squeezed.squeezed.rows(), squeezed.squeezed.cols());
    }
    out.power += scale * squeezed.squeezed.cwiseAbs2();
  }
  return out;
}

SqueezedVisibility squeezed_visibility(const SqueezedPower& squeezed, double onset_s) {
  const Eigen::MatrixXd power = smooth(squeezed.power);
  const Eigen::Index columns = power.cols();
  const auto* times = squeezed.time_s.data();
  const Eigen::Index contact = std::lower_bound(times, times + columns, hole_contact_s) - times;
  const Eigen::Index onset = std::lower_bound(times, times + columns, onset_s) - times;
  if (onset <= contact || onset >= columns) return {};
  Eigen::Index line = 0;
  double most = 0.0, stable = 0.0;
  for (Eigen::Index k = 1; k + 1 < power.rows(); ++k) {
    const Eigen::VectorXd then = power.row(k).segment(contact, onset - contact).transpose();
    const double usual = median(std::vector<double>(then.begin(), then.end()));
    const double growth = power.row(k).tail(columns - onset).mean() - usual;
    if (growth <= most) continue;
    line = k;
    most = growth;
    stable = usual;
  }
  if (line == 0) return {};
  SqueezedVisibility out;
  out.line_hz = squeezed.frequency_hz(line);
  const double greatest = power.row(line).maxCoeff();
  Eigen::Index row = 0;
  for (Eigen::Index m = contact; m < columns; ++m) {
    const double level = power(line, m);
    for (std::size_t k = 0; k < visible_shares.size(); ++k) {
      if (!std::isfinite(out.share_s[k]) && level >= visible_shares[k] * visible_shares[k] * greatest)
        out.share_s[k] = squeezed.time_s(m);
    }
    row = level > six_db * stable && level > six_db * median_around(power, line, m) ? row + 1 : 0;
    if (row == lasting && !std::isfinite(out.visible_s)) out.visible_s = squeezed.time_s(m + 1 - lasting);
  }
  return out;
}

}  // namespace robomill::examples
