#pragma once
// What tests of machines with derivatives share.
#include <array>
#include <cmath>

#include "robomill/base/random.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/taylor.hpp"

namespace robomill::robot::testing {

/// A smooth random way of a tool: tip, axis and gamma are sums of sines of u about a middle.
class RandomWay {
 public:
  RandomWay(Random& random, const ToolPose& middle, double tip_m, double axis_rad, double gamma_rad)
      : middle_(middle), size_{tip_m, tip_m, tip_m, axis_rad, axis_rad, axis_rad, gamma_rad} {
    for (auto& wave : waves_) {
      for (Sine& sine : wave) sine = {random.uniform(-1.0, 1.0), random.uniform(0.5, 2.0), random.uniform(0.0, 6.3)};
    }
  }

  [[nodiscard]] ToolJet jet(double u) const {
    ToolJet out;
    for (int i = 0; i < 3; ++i) out.tip_m.row(i) = wave(i, u);
    out.tip_m.col(0) += middle_.tip_m;
    out.gamma_rad = wave(6, u);
    out.gamma_rad(0) += middle_.gamma_rad;
    std::array<Taylor, 3> axis;
    for (int i = 0; i < 3; ++i) axis[static_cast<std::size_t>(i)] = Taylor::of(wave(3 + i, u)) + middle_.axis(i);
    const Taylor length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 4; ++k) out.axis(i, k) = (axis[static_cast<std::size_t>(i)] / length).derivative(k);
    }
    return out;
  }
  [[nodiscard]] ToolPose pose(double u) const {
    const ToolJet at = jet(u);
    return {.tip_m = at.tip_m.col(0), .axis = at.axis.col(0), .gamma_rad = at.gamma_rad(0)};
  }

 private:
  struct Sine {
    double size = 0.0, rate = 0.0, phase = 0.0;
  };
  [[nodiscard]] Eigen::RowVector4d wave(int channel, double u) const {
    Eigen::RowVector4d out = Eigen::RowVector4d::Zero();
    for (const Sine& sine : waves_[static_cast<std::size_t>(channel)]) {
      const double at = sine.rate * u + sine.phase, a = size_[static_cast<std::size_t>(channel)] * sine.size;
      out += a * Eigen::RowVector4d(std::sin(at), sine.rate * std::cos(at), -sine.rate * sine.rate * std::sin(at),
                                    -sine.rate * sine.rate * sine.rate * std::cos(at));
    }
    return out;
  }

  ToolPose middle_;
  std::array<double, 7> size_;
  std::array<std::array<Sine, 3>, 7> waves_ = {};
};

/// Derivatives 1 to 3 of f at u by central differences of eighth order, columns as in JointJet; f gives a Position6.
template <class F>
JointJet differences(F&& f, double u, double step) {
  // Of f(u + k step) for k = 1 … 5; Fornberg's weights.
  constexpr std::array<double, 5> first = {5.0 / 6.0, -5.0 / 21.0, 5.0 / 84.0, -5.0 / 504.0, 1.0 / 1260.0};
  constexpr std::array<double, 5> second = {5.0 / 3.0, -5.0 / 21.0, 5.0 / 126.0, -5.0 / 1008.0, 1.0 / 3150.0};
  constexpr std::array<double, 5> third = {-1669.0 / 720.0, 4369.0 / 2520.0, -541.0 / 1120.0, 1261.0 / 15120.0,
                                           -41.0 / 6048.0};
  JointJet out = JointJet::Zero();
  out.col(0) = f(u);
  for (int k = 1; k <= 5; ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const Position6 above = f(u + k * step), below = f(u - k * step);
    out.col(1) += first[i] / step * (above - below);
    out.col(2) += second[i] / (step * step) * ((above - out.col(0)) + (below - out.col(0)));
    out.col(3) += third[i] / (step * step * step) * (above - below);
  }
  return out;
}

/// The largest difference of two jets, each derivative by the size of its column.
inline double jet_error(const JointJet& a, const JointJet& b, int order) {
  return (a.col(order) - b.col(order)).norm() / (1e-3 + b.col(order).norm());
}

}  // namespace robomill::robot::testing
