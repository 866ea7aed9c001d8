#include "robomill/signal/window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::signal {
namespace {

void require_samples(Eigen::Index n) {
  if (n < 1) throw InvalidInput("n", static_cast<double>(n), "samples", "must be at least 1");
}

}  // namespace

Eigen::VectorXd hann_window(Eigen::Index n) {
  require_samples(n);
  Eigen::VectorXd window(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    window(j) = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(n));
  }
  return window;
}

Eigen::VectorXd exponential_window(Eigen::Index n, double sample_rate_hz, double time_constant_s) {
  require_samples(n);
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  require_positive("time_constant_s", time_constant_s, "s");
  Eigen::VectorXd window(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    window(j) = std::exp(-static_cast<double>(j) / sample_rate_hz / time_constant_s);
  }
  return window;
}

Eigen::VectorXd force_window(Eigen::Index n, Eigen::Index first, Eigen::Index last, Eigen::Index taper) {
  require_samples(n);
  if (first < 0 || first > last || last >= n) {
    throw InvalidInput("force window", "must begin and end inside the record, and begin before it ends");
  }
  if (taper < 0) throw InvalidInput("taper", static_cast<double>(taper), "samples", "must be >= 0");
  Eigen::VectorXd window = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = std::max<Eigen::Index>(0, first - taper); j < std::min(n, last + taper + 1); ++j) {
    const Eigen::Index outside = std::max<Eigen::Index>({first - j, j - last, 0});
    window(j) = 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(outside) / static_cast<double>(taper + 1));
  }
  return window;
}

}  // namespace robomill::signal
