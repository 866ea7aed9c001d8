#include "robomill/stability/contact_basis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::stability::detail {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;
constexpr std::size_t tail_powers = 11;

/// P_0(x) … P_{count-1}(x), scaled to mean square 1 over (-1, 1).
Eigen::VectorXd legendre(Eigen::Index count, double x) {
  Eigen::VectorXd p(count);
  double before = 0.0;
  double now = 1.0;
  for (Eigen::Index m = 0; m < count; ++m) {
    const double degree = static_cast<double>(m);
    p(m) = std::sqrt(2.0 * degree + 1.0) * now;
    const double next = ((2.0 * degree + 1.0) * x * now - degree * before) / (degree + 1.0);
    before = now;
    now = next;
  }
  return p;
}

Complex power_of_minus_i(Eigen::Index m) {
  constexpr std::array<Complex, 4> powers = {Complex(1.0, 0.0), Complex(0.0, -1.0), Complex(-1.0, 0.0),
                                             Complex(0.0, 1.0)};
  return powers[static_cast<std::size_t>(m % 4)];
}

}  // namespace

void gauss_legendre(Eigen::Index count, Eigen::VectorXd& nodes, Eigen::VectorXd& weights) {
  nodes.resize(count);
  weights.resize(count);
  const double n = static_cast<double>(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    double x = std::cos(pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 20; ++step) {
      double before = 0.0;
      double now = 1.0;
      for (Eigen::Index m = 0; m < count; ++m) {
        const double degree = static_cast<double>(m);
        const double next = ((2.0 * degree + 1.0) * x * now - degree * before) / (degree + 1.0);
        before = now;
        now = next;
      }
      slope = n * (before - x * now) / (1.0 - x * x);
      const double change = now / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    nodes(i) = x;
    weights(i) = 2.0 / ((1.0 - x * x) * slope * slope);
  }
}

void spherical_bessel(double z, Eigen::Ref<Eigen::VectorXd> out) {
  const Eigen::Index count = out.size();
  if (z < 0.0) {
    spherical_bessel(-z, out);
    for (Eigen::Index m = 1; m < count; m += 2) out(m) = -out(m);
    return;
  }
  if (z < 1e-8) {
    out.setZero();
    out(0) = 1.0;
    if (count > 1) out(1) = z / 3.0;
    return;
  }
  const double first = std::sin(z) / z;
  const double second = (first - std::cos(z)) / z;
  if (z > static_cast<double>(count)) {
    // Upwards, which is stable while the order is below z.
    out(0) = first;
    if (count > 1) out(1) = second;
    for (Eigen::Index m = 1; m + 1 < count; ++m) {
      out(m + 1) = (2.0 * static_cast<double>(m) + 1.0) / z * out(m) - out(m - 1);
    }
    return;
  }
  // Downwards from where nothing is left, then scaled by the greater of the two that are known [Olver2010, 10.74].
  const Eigen::Index start = count + 20 + static_cast<Eigen::Index>(z);
  double above = 0.0;
  double now = 1e-280;
  for (Eigen::Index m = start; m >= 0; --m) {
    if (m < count) out(m) = now;
    const double below = (2.0 * static_cast<double>(m) + 1.0) / z * now - above;
    above = now;
    now = below;
    if (std::abs(now) > 1e200) {
      now *= 1e-200;
      above *= 1e-200;
      for (Eigen::Index k = m; k < count; ++k) out(k) *= 1e-200;
    }
  }
  const bool by_first = count < 2 || std::abs(first) >= std::abs(second);
  out *= by_first ? first / out(0) : second / out(1);
}

std::vector<double> contact_angles(const cutting::Milling& milling, double axial_depth_m, double period_rad) {
  std::vector<double> angles;
  const auto add = [&](double angle) {
    double folded = std::fmod(angle, period_rad);
    if (folded < 0.0) folded += period_rad;
    angles.push_back(period_rad - folded < 1e-10 ? 0.0 : folded);
  };
  for (int j = 0; j < milling.tool.teeth; ++j) {
    const double lag = milling.tool.lag_rad_per_m(j) * axial_depth_m;
    for (const double edge : {milling.immersion.entry_rad, milling.immersion.exit_rad}) {
      add(edge - milling.tool.standing_angle(j));
      add(edge - milling.tool.standing_angle(j) + lag);
    }
  }
  std::ranges::sort(angles);
  const auto same = std::ranges::unique(angles, [](double a, double b) { return b - a < 1e-10; });
  angles.erase(same.begin(), same.end());
  return angles;
}

void require_frequency_domain(const cutting::Milling& milling) {
  milling.validate();
  const char* const instead = "Semi-discretization or collocation knows it";
  if (!milling.tool.has_equal_helix()) {
    throw InvalidInput("tooth_helix_rad", "must be one angle in the frequency domain: delays change with the height",
                       instead);
  }
  if (milling.tool.runout_m > 0.0) {
    throw InvalidInput("runout_m", milling.tool.runout_m, "m", "must be 0 in the frequency domain", instead);
  }
  if (milling.speed_variation.active()) {
    throw InvalidInput("amplitude_ratio", milling.speed_variation.amplitude_ratio, "",
                       "must be 0 in the frequency domain: delays change with time", instead);
  }
}

ContactBasis::ContactBasis(const cutting::Milling& milling, const FrequencyResponse& response,
                           double spindle_speed_rad_per_s, double axial_depth_m, const Size& size)
    : response_(response), speed_(spindle_speed_rad_per_s) {
  const bool equal = milling.tool.has_equal_pitch();
  period_rad_ = equal ? 2.0 * pi / milling.tool.teeth : 2.0 * pi;
  period_frequency_ = 2.0 * pi / period_rad_ * speed_;
  // Below near_ each harmonic has its own receptance, beyond it the series stands for all.
  near_ = std::max<Eigen::Index>(
      4, static_cast<Eigen::Index>(std::ceil(response.series_from_rad_per_s() / period_frequency_)) + 1);
  far_ = std::max<Eigen::Index>(near_ + 1, size.harmonics);
  find_arcs(milling, axial_depth_m, 1.0 / speed_, size);
  find_transforms();
  find_stiffness(milling, speed_, axial_depth_m);
  find_tails();
}

void ContactBasis::find_arcs(const cutting::Milling& milling, double axial_depth_m, double time_per_rad,
                             const Size& size) {
  const std::vector<double> angles = contact_angles(milling, axial_depth_m, period_rad_);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double to = i + 1 < angles.size() ? angles[i + 1] : angles.front() + period_rad_;
    const double middle = 0.5 * (angles[i] + to);
    bool cuts = false;
    for (int j = 0; j < milling.tool.teeth; ++j) {
      cuts = cuts || !cutting::cutting_stiffness(milling, j, middle, axial_depth_m).isZero(0.0);
    }
    if (!cuts) continue;
    const double half = 0.5 * (to - angles[i]);
    const auto degree = static_cast<Eigen::Index>(std::ceil(size.highest_rad_per_s * half * time_per_rad + half));
    arcs_.push_back({angles[i], to, count_, degree + size.extra});
    count_ += arcs_.back().count;
  }
}

void ContactBasis::find_transforms() {
  transform_.resize(2 * far_ + 1, count_);
  const double turns = 2.0 * pi / period_rad_;
  for (const Arc& arc : arcs_) {
    const double middle = 0.5 * (arc.from + arc.to);
    const double half = 0.5 * (arc.to - arc.from);
    const double scale = std::sqrt(2.0 * half / period_rad_);
    Eigen::VectorXd bessel(arc.count);
    for (Eigen::Index n = 0; n <= far_; ++n) {
      const double turn = turns * static_cast<double>(n);
      spherical_bessel(turn * half, bessel);
      const Complex phase = std::polar(scale, -turn * middle);
      for (Eigen::Index m = 0; m < arc.count; ++m) {
        const Complex value = phase * power_of_minus_i(m) * (std::sqrt(2.0 * static_cast<double>(m) + 1.0) * bessel(m));
        transform_(far_ + n, arc.first + m) = value;
        transform_(far_ - n, arc.first + m) = std::conj(value);
      }
    }
  }
}

void ContactBasis::find_stiffness(const cutting::Milling& milling, double spindle_speed, double axial_depth_m) {
  const bool equal = milling.tool.has_equal_pitch();
  const int teeth = milling.tool.teeth;
  std::vector<int> term_of(static_cast<std::size_t>(teeth), 0);
  for (int j = 0; j < teeth; ++j) {
    const double pitch = equal ? period_rad_ : milling.tool.pitch(j);
    std::size_t t = 0;
    while (t < terms_.size() && std::abs(terms_[t].delay_angle - pitch) > 1e-9) ++t;
    if (t == terms_.size()) terms_.push_back({.delay_angle = pitch, .stiffness = {}, .tail = {}, .delayed_tail = {}});
    term_of[static_cast<std::size_t>(j)] = static_cast<int>(t);
  }
  const bool damped = milling.process_damping.active();
  if (damped) terms_.push_back({.damping = true, .stiffness = {}, .tail = {}, .delayed_tail = {}});
  for (Term& term : terms_) {
    for (auto& row : term.stiffness) {
      for (Eigen::MatrixXd& entry : row) entry = Eigen::MatrixXd::Zero(count_, count_);
    }
  }
  Eigen::VectorXd nodes, weights;
  for (const Arc& arc : arcs_) {
    // The stiffness itself is smooth on the arc; eight more nodes than the product of two polynomials needs.
    gauss_legendre(arc.count + 8, nodes, weights);
    for (Eigen::Index q = 0; q < nodes.size(); ++q) {
      const double angle = 0.5 * (arc.from + arc.to) + 0.5 * (arc.to - arc.from) * nodes(q);
      const Eigen::VectorXd p = legendre(arc.count, nodes(q));
      const auto add = [&](Term& term, const Eigen::Matrix2d& value) {
        if (value.isZero(0.0)) return;
        for (int i = 0; i < 2; ++i) {
          for (int j = 0; j < 2; ++j) {
            term.stiffness[i][j].block(arc.first, arc.first, arc.count, arc.count) +=
                (0.5 * weights(q) * value(i, j)) * p * p.transpose();
          }
        }
      };
      for (int j = 0; j < teeth; ++j) {
        add(terms_[static_cast<std::size_t>(term_of[static_cast<std::size_t>(j)])],
            cutting::cutting_stiffness(milling, j, angle, axial_depth_m) / axial_depth_m);
        if (damped) {
          add(terms_.back(),
              cutting::cutting_damping(milling, j, angle, 0.0, axial_depth_m, spindle_speed) / axial_depth_m);
        }
      }
    }
  }
}

void ContactBasis::find_tails() {
  const bool needed = std::ranges::any_of(response_.series(), [](const Eigen::Matrix2d& c) { return !c.isZero(0.0); });
  if (!needed) return;
  const Eigen::Index tail = far_ - near_;
  const Eigen::MatrixXcd high = transform_.bottomRows(tail);
  // Coefficients of -n are the conjugates of those of n, so that both halves of the sum are conjugate but for (±in)^p.
  const auto sums = [&](double angle) {
    std::vector<Eigen::MatrixXcd> out;
    for (std::size_t p = 0; p < tail_powers; ++p) {
      Eigen::VectorXcd factor(tail);
      for (Eigen::Index i = 0; i < tail; ++i) {
        const double n = static_cast<double>(near_ + 1 + i);
        factor(i) = std::polar(1.0, -n * angle) / std::pow(Complex(0.0, n), static_cast<double>(p));
      }
      const Eigen::MatrixXcd half = high.adjoint() * factor.asDiagonal() * high;
      out.emplace_back(half + half.conjugate());
    }
    return out;
  };
  const std::vector<Eigen::MatrixXcd> plain = sums(0.0);
  const auto middle = transform_.middleRows(far_ - near_, 2 * near_ + 1);
  for (Term& term : terms_) {
    term.tail = plain;
    // All harmonics together are the identity.
    term.tail[0] = Eigen::MatrixXcd::Identity(count_, count_) - middle.adjoint() * middle;
    if (term.damping) continue;
    const bool whole = std::abs(term.delay_angle - period_rad_) < 1e-12;
    term.delayed_tail = whole ? term.tail : sums(term.delay_angle * 2.0 * pi / period_rad_);
  }
}

void ContactBasis::add_tail(const Term& term, double omega, Complex delay_factor, Eigen::MatrixXcd (&sum)[2][2]) const {
  if (term.tail.empty()) return;
  // 1 / (u + v)^k = Σ_r (-1)^r C(k + r - 1, r) v^r / u^(k + r), u = i n ω_P, v = iω.
  const auto& series = response_.series();
  const std::size_t shift = term.damping ? 1 : 0;
  std::array<Eigen::Matrix2cd, tail_powers> gain;
  gain.fill(Eigen::Matrix2cd::Zero());
  for (std::size_t k = 0; k + shift < series.size(); ++k) {
    Complex factor = 1.0;
    for (std::size_t r = 0; k + r < tail_powers; ++r) {
      gain[k + r] += series[k + shift].cast<Complex>() * factor;
      if (k == 0) break;
      factor *= -Complex(0.0, omega) * (static_cast<double>(k + r) / static_cast<double>(r + 1));
    }
  }
  double unit = 1.0;
  for (std::size_t p = 0; p < tail_powers; ++p) {
    if (!gain[p].isZero(0.0)) {
      Eigen::MatrixXcd shape = term.tail[p];
      if (!term.damping) shape -= delay_factor * term.delayed_tail[p];
      for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) sum[i][j] += (gain[p](i, j) * unit) * shape;
      }
    }
    unit /= period_frequency_;
  }
}

void ContactBasis::matrix(double frequency_rad_per_s, Eigen::MatrixXcd& out, bool covered_only) const {
  const double omega = frequency_rad_per_s;
  const Eigen::Index rows = 2 * near_ + 1;
  const auto middle = transform_.middleRows(far_ - near_, rows);
  std::array<Eigen::VectorXcd, 4> receptance;
  for (Eigen::VectorXcd& r : receptance) r.resize(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double at = omega + static_cast<double>(row - near_) * period_frequency_;
    const bool left_out = covered_only && !response_.covers(at);
    const Eigen::Matrix2cd g = left_out ? Eigen::Matrix2cd(Eigen::Matrix2cd::Zero()) : response_.at(at);
    for (Eigen::Index e = 0; e < 4; ++e) receptance[static_cast<std::size_t>(e)](row) = g(e % 2, e / 2);
  }
  out.setZero(2 * count_, 2 * count_);
  for (const Term& term : terms_) {
    const Complex delay_factor = std::polar(1.0, -omega * term.delay_angle / speed_);
    const double turns = 2.0 * pi / period_rad_;
    Eigen::VectorXcd factor(rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const double n = static_cast<double>(row - near_);
      factor(row) = term.damping ? Complex(0.0, omega + n * period_frequency_)
                                 : 1.0 - delay_factor * std::polar(1.0, -n * turns * term.delay_angle);
    }
    Eigen::MatrixXcd sum[2][2];
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        const Eigen::VectorXcd gain = factor.cwiseProduct(receptance[static_cast<std::size_t>(i + 2 * j)]);
        const Eigen::MatrixXcd weighted = gain.asDiagonal() * middle;
        sum[i][j].noalias() = middle.adjoint() * weighted;
      }
    }
    if (!covered_only) add_tail(term, omega, delay_factor, sum);
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        for (int k = 0; k < 2; ++k) {
          out.block(i * count_, j * count_, count_, count_) += term.stiffness[i][k].cast<Complex>() * sum[k][j];
        }
      }
    }
  }
}

Eigen::Vector2cd ContactBasis::harmonic(const Eigen::VectorXcd& coefficients, int n) const {
  const auto row = transform_.row(far_ + n);
  return {(row * coefficients.head(count_)).value(), (row * coefficients.tail(count_)).value()};
}

}  // namespace robomill::stability::detail
