#include "robomill/modal/posture/tool_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::modal::detail {

std::vector<FlexibleArm::Tool> tool_peaks(const robot::Cell& cell, const std::vector<PostureData>& data,
                                          double highest_hz) {
  constexpr double share = 0.02;
  constexpr int lines = 400;
  constexpr double lowest_hz = 60.0;
  std::vector<std::complex<double>> s;
  Eigen::VectorXd loss;  // −Im (H_xx + H_yy) of the flange's axes, mean of the postures' logarithms
  for (const PostureData& posture : data) {
    const SmoothedFrf frf = posture.smoothed(share, lines);
    const Eigen::Matrix3d axes = robot::forward(cell.arm, posture.joints()).linear();
    Eigen::VectorXd of(static_cast<Eigen::Index>(frf.s.size()));
    for (Eigen::Index i = 0; i < of.size(); ++i) {
      const Eigen::Matrix3cd h = Eigen::Map<const Eigen::Matrix3cd>(frf.value.col(i).data());
      const Eigen::Matrix3cd turned = axes.transpose() * h * axes;
      of(i) = std::log(std::max(-(turned(0, 0) + turned(1, 1)).imag(), 1e-15));
    }
    if (s.empty()) {
      s = frf.s;
      loss = Eigen::VectorXd::Zero(of.size());
    }
    if (of.size() == loss.size()) loss += of / static_cast<double>(data.size());
  }
  std::vector<std::pair<double, FlexibleArm::Tool>> peaks;
  for (Eigen::Index i = 1; i + 1 < loss.size(); ++i) {
    const double rate = s[static_cast<std::size_t>(i)].imag();
    const double f = rate / (2.0 * std::numbers::pi);
    if (f < lowest_hz || f > highest_hz || !(loss(i) > loss(i - 1) && loss(i) >= loss(i + 1))) continue;
    // A mode of mass m with ζ of 2 % peaks at 1 / (2 m ω (ζ ω + σ)) right of the axis.
    const double sigma = s[static_cast<std::size_t>(i)].real(), decay = 0.02 * rate;
    const double peak = 2.0 / (decay + sigma) - 1.0 / (decay + 2.0 * sigma);
    const double mass = std::clamp(peak / (std::exp(loss(i)) * 2.0 * rate), 0.02, 200.0);
    peaks.push_back({std::exp(loss(i)) * rate, {.frequency_hz = f, .mass_kg = mass}});
  }
  std::ranges::sort(peaks, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<FlexibleArm::Tool> out;
  constexpr std::size_t most = 3;
  for (const auto& [height, tool] : peaks) {
    if (out.size() < most) out.push_back(tool);
  }
  return out;
}

}  // namespace robomill::modal::detail
