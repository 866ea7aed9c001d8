#include "robomill/stability/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/stability/frequency_domain/frf_interpolation.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/vibration/motion.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability {
namespace {

using Complex = std::complex<double>;

Eigen::Matrix2cd modal_receptance(const detail::TipDynamics& tip, double omega) {
  const Complex s(0.0, omega);
  Eigen::Matrix2cd g = tip.compliance.cast<Complex>();
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const Eigen::Matrix2cd residue = tip.right.col(k) * tip.left.col(k).transpose();
    g += residue / (s - tip.pole(k)) + residue.conjugate() / (s - std::conj(tip.pole(k)));
  }
  return g;
}

/// Highest of their neighbourhood, with the width at which they have fallen to 0.7; the highest forty.
std::vector<Resonance> peaks(const detail::FrfInterpolation& frf) {
  const Eigen::VectorXd& omega = frf.frequency();
  const Eigen::VectorXd size = frf.lines().rowwise().norm();
  constexpr Eigen::Index around = 4;
  std::vector<std::pair<double, Resonance>> found;
  for (Eigen::Index i = 0; i < size.size(); ++i) {
    const Eigen::Index low = std::max<Eigen::Index>(0, i - around);
    const Eigen::Index high = std::min<Eigen::Index>(size.size() - 1, i + around);
    if (size(i) == 0.0 || size(i) < size.segment(low, high - low + 1).maxCoeff()) continue;
    Eigen::Index left = i, right = i;
    while (left > 0 && size(left) > 0.7 * size(i)) --left;
    while (right + 1 < size.size() && size(right) > 0.7 * size(i)) ++right;
    const double narrower = std::min(left > 0 ? omega(i) - omega(left) : omega(right) - omega(i),
                                     right + 1 < size.size() ? omega(right) - omega(i) : omega(i) - omega(left));
    found.push_back({size(i), {omega(i), std::max(narrower, 1e-6 * omega(i))}});
  }
  std::ranges::sort(found, [](const auto& a, const auto& b) { return a.first > b.first; });
  if (found.size() > 40) found.resize(40);
  std::vector<Resonance> out;
  out.reserve(found.size());
  for (const auto& f : found) out.push_back(f.second);
  return out;
}

int tip_point(const modal::FrfSet& frfs) {
  std::set<int> points;
  const auto in_plane = [](const modal::Dof& d) { return d.axis == modal::Axis::x || d.axis == modal::Axis::y; };
  for (const modal::Frf& frf : frfs.frfs) {
    if (in_plane(frf.name.response)) points.insert(frf.name.response.point);
    if (in_plane(frf.name.excitation)) points.insert(frf.name.excitation.point);
  }
  if (points.empty()) throw InvalidInput("frfs", "must know x or y at the tool tip", "Name them xx, yx, xy, yy");
  if (points.size() > 1 && !points.contains(0)) {
    throw InvalidInput("frfs", "name several points, none of them the tool tip", "The tip carries no number");
  }
  return *points.begin();
}

}  // namespace

struct FrequencyResponse::Part {
  std::optional<detail::TipDynamics> modes;
  std::optional<detail::FrfInterpolation> frf;
};

void FrequencyResponse::add(std::shared_ptr<const Part> part) {
  if (part->modes) {
    const detail::TipDynamics& tip = *part->modes;
    compliance_ += tip.compliance;
    for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
      first_moment_ += 2.0 * (tip.right.col(k) * tip.left.col(k).transpose()).real();
      resonances_.push_back({tip.pole(k).imag(), -tip.pole(k).real()});
      smooth_from_ = std::max(smooth_from_, 1.5 * std::abs(tip.pole(k)));
    }
  } else {
    for (const Resonance& r : peaks(*part->frf)) resonances_.push_back(r);
    low_ = std::max(low_, part->frf->low());
    high_ = std::min(high_, part->frf->high());
    first_moment_ += part->frf->first_moment();
    smooth_from_ = std::max(smooth_from_, part->frf->high());
  }
  std::ranges::sort(resonances_, {}, &Resonance::frequency_rad_per_s);
  parts_.push_back(std::move(part));
}

FrequencyResponse FrequencyResponse::of_modes(const LobesProblem& problem) {
  problem.validate();
  return of_modes(tip_modes(problem));
}

FrequencyResponse FrequencyResponse::of_modes(const modal::TipModes& modes) {
  auto part = std::make_shared<Part>();
  part->modes = detail::tip_dynamics<2>(modes);
  FrequencyResponse response;
  response.add(std::move(part));
  return response;
}

FrequencyResponse FrequencyResponse::of_frfs(const modal::FrfSet& frfs, double feed_direction_rad) {
  frfs.validate();
  require_finite("feed_direction_rad", feed_direction_rad, "rad");
  const int point = tip_point(frfs);
  const Eigen::Index n = frfs.frequency_hz.size();
  if (n < detail::FrfInterpolation::least_lines) {
    throw InvalidInput("frequency_hz", static_cast<double>(n), "lines", "must be at least 8");
  }
  detail::FrfInterpolation::Lines lines = detail::FrfInterpolation::Lines::Zero(n, 4);
  bool direct = false;
  Eigen::Index column = 0;
  for (const modal::Axis excitation : {modal::Axis::x, modal::Axis::y}) {
    for (const modal::Axis response : {modal::Axis::x, modal::Axis::y}) {
      if (const modal::Frf* frf = frfs.find({{point, response}, {point, excitation}})) {
        lines.col(column) = frf->receptance;
        direct = direct || response == excitation;
      }
      ++column;
    }
  }
  if (!direct) throw InvalidInput("frfs", "must hold xx or yy at the tool tip");
  const double c = std::cos(feed_direction_rad);
  const double s = std::sin(feed_direction_rad);
  Eigen::Matrix2d to_feed;
  to_feed << c, s, -s, c;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Matrix2cd h;
    h << lines(i, 0), lines(i, 2), lines(i, 1), lines(i, 3);
    h = (to_feed.cast<Complex>() * h * to_feed.transpose().cast<Complex>()).eval();
    lines.row(i) << h(0, 0), h(1, 0), h(0, 1), h(1, 1);
  }
  auto part = std::make_shared<Part>();
  part->frf.emplace(2.0 * std::numbers::pi * frfs.frequency_hz, std::move(lines));
  FrequencyResponse response;
  response.add(std::move(part));
  return response;
}

FrequencyResponse& FrequencyResponse::operator+=(const FrequencyResponse& other) {
  const std::vector<std::shared_ptr<const Part>> parts = other.parts_;
  for (const std::shared_ptr<const Part>& part : parts) add(part);
  return *this;
}

Eigen::Matrix2cd FrequencyResponse::at(double frequency_rad_per_s) const {
  Eigen::Matrix2cd g = Eigen::Matrix2cd::Zero();
  for (const auto& part : parts_) {
    g += part->modes ? modal_receptance(*part->modes, frequency_rad_per_s) : part->frf->at(frequency_rad_per_s);
  }
  return g;
}

bool FrequencyResponse::measured() const {
  return std::ranges::any_of(parts_, [](const auto& part) { return part->frf.has_value(); });
}

bool FrequencyResponse::covers(double frequency_rad_per_s) const {
  const double omega = std::abs(frequency_rad_per_s);
  return omega >= low_ && omega <= high_;
}

double FrequencyResponse::highest_peak() const {
  double largest = 0.0;
  for (const Resonance& r : resonances_) largest = std::max(largest, at(r.frequency_rad_per_s).norm());
  return largest;
}

MovedMode FrequencyResponse::mode_of(double frequency_rad_per_s, const Eigen::Vector2cd& force) const {
  MovedMode most;
  for (const auto& part : parts_) {
    if (!part->modes) continue;
    const MovedMode one = detail::most_moved<2>(*part->modes, Complex(0.0, frequency_rad_per_s), force);
    if (one.displacement_m > most.displacement_m) most = one;
  }
  return most;
}

}  // namespace robomill::stability
