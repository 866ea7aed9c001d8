#include "robomill/modal/impact/hits_decay.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/statistics.hpp"
#include "robomill/signal/fft.hpp"
#include "robomill/signal/window.hpp"

namespace robomill::modal {
namespace {

using Eigen::Index;

Eigen::VectorXd power(const Eigen::VectorXd& x, const Eigen::VectorXd& window) {
  const Eigen::VectorXd windowed = (x.array() - x.mean()).matrix().cwiseProduct(window);
  return signal::real_fft(windowed).cwiseAbs2() / window.squaredNorm();
}

double median_around(const Eigen::VectorXd& x, Index k) {
  constexpr Index reach = 32;
  const Index begin = std::max<Index>(1, k - reach);
  const Index end = std::min(x.size(), k + reach + 1);
  return median(x.segment(begin, end - begin));
}

}  // namespace

Tail look_at_tail(const Eigen::VectorXd& response, double sample_rate_hz, double max_frequency_hz) {
  const Index quarter = response.size() / 4;
  const Eigen::VectorXd window = signal::hann_window(quarter);
  const Eigen::VectorXd begin = power(response.head(quarter), window);
  Tail tail;
  tail.noise_density = power(response.tail(quarter), window);
  tail.spacing_hz = sample_rate_hz / static_cast<double>(quarter);
  const Eigen::VectorXd& end = tail.noise_density;
  const Index last = std::min<Index>(end.size() - 1, static_cast<Index>(max_frequency_hz / tail.spacing_hz));
  // Drift of the sensor's zero fills the lowest lines.
  for (Index k = 4; k < last; ++k) {
    const bool peak = end(k) > end(k - 1) && end(k) >= end(k + 1);
    if (!peak || end(k) > 0.8 * begin(k) || end(k) < 40.0 * median_around(end, k)) continue;
    // The quarters' middles lie three quarters of the record apart.
    const double remaining = std::pow(end(k) / begin(k), 0.5 / 0.75);
    if (remaining > tail.remaining) {
      tail.remaining = remaining;
      tail.remaining_hz = static_cast<double>(k) * tail.spacing_hz;
    }
  }
  return tail;
}

}  // namespace robomill::modal
