#include "robomill/stability/collocation/steady_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "robomill/stability/collocation/mesh/contacts.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;
constexpr double same_place_rad = 1e-9;  // borders closer than that are one

/// e^{ihθ}, h = -2 … 2.
std::array<Complex, 5> turns(double angle_rad) {
  const Complex once = std::polar(1.0, angle_rad);
  const Complex twice = once * once;
  return {std::conj(twice), std::conj(once), 1.0, once, twice};
}

Eigen::ArrayXcd weighted(const Eigen::ArrayXXcd& answer, const std::array<Complex, 5>& turn) {
  Eigen::ArrayXcd sum = answer.col(0) * turn[0];
  for (Eigen::Index h = 1; h < 5; ++h) sum += answer.col(h) * turn[static_cast<std::size_t>(h)];
  return sum;
}

void add(const ForceStretch& from, double sign, ForceStretch& to) {
  to.mean += sign * from.mean;
  to.first += sign * from.first;
  to.second += sign * from.second;
}

}  // namespace

SteadyMotion::SteadyMotion(const TipDynamicsIn<3>& tip, const SteadyForce& force, double spindle_speed_rad_per_s)
    : pole_per_rad_(tip.pole.array() / spindle_speed_rad_per_s),
      right_(tip.right),
      compliance_(tip.compliance),
      speed_rad_per_s_(spindle_speed_rad_per_s),
      period_rad_(force.period_rad) {
  divide(force);
  for (Segment& segment : segments_) answer(tip, segment);
  make_periodic();
}

/// The period at the stretches' ends.
void SteadyMotion::divide(const SteadyForce& force) {
  struct Border {
    double angle_rad = 0.0, sign = 0.0;
    const ForceStretch* stretch = nullptr;
  };
  std::vector<Border> borders;
  for (const ForceStretch& stretch : force.stretches) {
    // Where one edge leaves as another enters both are in the cut.
    borders.push_back({std::max(stretch.from_rad - same_place_rad, 0.0), 1.0, &stretch});
    borders.push_back({std::min(stretch.to_rad + same_place_rad, period_rad_), -1.0, &stretch});
  }
  std::ranges::stable_sort(borders, {}, &Border::angle_rad);
  segments_.push_back({});
  for (const Border& border : borders) {
    Segment& last = segments_.back();
    if (border.angle_rad > last.from_rad + 0.5 * same_place_rad && border.angle_rad < period_rad_) {
      last.to_rad = border.angle_rad;
      Segment next;
      next.from_rad = border.angle_rad;
      next.force = last.force;
      segments_.push_back(next);
    }
    if (border.sign > 0.0 || border.angle_rad < period_rad_) add(*border.stretch, border.sign, segments_.back().force);
  }
  segments_.back().to_rad = period_rad_;
}

/// dz/dθ = p z + L^T F / Ω: of e^{ihθ} it is L^T F_h / (Ω (ih - p)).
void SteadyMotion::answer(const TipDynamicsIn<3>& tip, Segment& segment) const {
  const ForceStretch& f = segment.force;
  segment.answer.resize(pole_per_rad_.size(), 5);
  segment.answer.col(0) = 0.5 * (tip.left.transpose() * f.second.conjugate()).array();
  segment.answer.col(1) = 0.5 * (tip.left.transpose() * f.first.conjugate()).array();
  segment.answer.col(2) = (tip.left.transpose() * f.mean.cast<Complex>()).array();
  segment.answer.col(3) = 0.5 * (tip.left.transpose() * f.first).array();
  segment.answer.col(4) = 0.5 * (tip.left.transpose() * f.second).array();
  for (Eigen::Index h = 0; h < 5; ++h) {
    segment.answer.col(h) /= speed_rad_per_s_ * (Complex(0.0, static_cast<double>(h - 2)) - pole_per_rad_);
  }
}

void SteadyMotion::make_periodic() {
  // From rest; then what the period's end must be taken back to.
  Eigen::ArrayXcd z = Eigen::ArrayXcd::Zero(pole_per_rad_.size());
  for (Segment& segment : segments_) {
    segment.decays = z - weighted(segment.answer, turns(segment.from_rad));
    z = segment.decays * (pole_per_rad_ * (segment.to_rad - segment.from_rad)).exp() +
        weighted(segment.answer, turns(segment.to_rad));
  }
  const Eigen::ArrayXcd start = z / (1.0 - (pole_per_rad_ * period_rad_).exp());
  for (Segment& segment : segments_) segment.decays += start * (pole_per_rad_ * segment.from_rad).exp();
}

Eigen::Vector3d SteadyMotion::at(double rotation_rad) const {
  const double angle = wrap(rotation_rad, period_rad_);
  const auto after = std::ranges::upper_bound(segments_, angle, {}, &Segment::from_rad);
  const Segment& segment = after == segments_.begin() ? segments_.front() : *std::prev(after);
  const std::array<Complex, 5> turn = turns(angle);
  const Eigen::ArrayXcd z =
      segment.decays * (pole_per_rad_ * (angle - segment.from_rad)).exp() + weighted(segment.answer, turn);
  const Eigen::Vector3d force =
      segment.force.mean + (segment.force.first * turn[3] + segment.force.second * turn[4]).real();
  return 2.0 * (right_ * z.matrix()).real() + compliance_ * force;
}

}  // namespace robomill::stability::detail
