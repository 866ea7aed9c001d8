#include "robomill/stability/frequency_domain/contact_basis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;
constexpr int chebyshev_points = 8;

/// In (0, 1).
double chebyshev(int k) {
  return 0.5 - 0.5 * std::cos(pi * (k + 0.5) / chebyshev_points);
}

/// What each point's value counts for in the polynomial through all of them at x.
std::array<double, chebyshev_points> chebyshev_shares(double x) {
  std::array<double, chebyshev_points> share{};
  double sum = 0.0;
  for (int k = 0; k < chebyshev_points; ++k) {
    const double away = x - chebyshev(k);
    if (away == 0.0) {
      share.fill(0.0);
      share[static_cast<std::size_t>(k)] = 1.0;
      return share;
    }
    const double weight = (k % 2 == 0 ? 1.0 : -1.0) * std::sin(pi * (k + 0.5) / chebyshev_points) / away;
    share[static_cast<std::size_t>(k)] = weight;
    sum += weight;
  }
  for (double& s : share) s /= sum;
  return share;
}

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
  const auto close = [](double a, double b) { return b - a < 1e-10; };
  angles.erase(std::unique(angles.begin(), angles.end(), close), angles.end());
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
    : response_(response), speed_(spindle_speed_rad_per_s), interpolated_(size.interpolated) {
  period_rad_ = milling.tool.has_equal_pitch() ? 2.0 * pi / milling.tool.teeth : 2.0 * pi;
  period_frequency_ = 2.0 * pi / period_rad_ * speed_;
  near_ = std::max<Eigen::Index>(
      2, static_cast<Eigen::Index>(std::ceil(response.smooth_from_rad_per_s() / period_frequency_)) + 1);
  far_ = std::max<Eigen::Index>(near_ + 1, size.harmonics);
  find_arcs(milling, axial_depth_m, size);
  find_stiffness(milling, axial_depth_m);
  if (interpolated_) find_tails();
}

void ContactBasis::find_arcs(const cutting::Milling& milling, double axial_depth_m, const Size& size) {
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
    const auto degree = static_cast<Eigen::Index>(std::ceil((size.highest_rad_per_s / speed_ + 1.0) * half));
    arcs_.push_back({angles[i], to, count_, degree + size.extra});
    count_ += arcs_.back().count;
  }
}

void ContactBasis::transform(double turns, Eigen::Ref<Eigen::RowVectorXcd> out) const {
  Eigen::VectorXd bessel(count_);
  for (const Arc& arc : arcs_) {
    const double turn = turns * 2.0 * pi / period_rad_;
    const double half = 0.5 * (arc.to - arc.from);
    const Complex phase = std::polar(std::sqrt(2.0 * half / period_rad_), -0.5 * turn * (arc.from + arc.to));
    auto values = bessel.head(arc.count);
    spherical_bessel(turn * half, values);
    for (Eigen::Index m = 0; m < arc.count; ++m) {
      out(arc.first + m) = phase * power_of_minus_i(m) * (std::sqrt(2.0 * static_cast<double>(m) + 1.0) * values(m));
    }
  }
}

void ContactBasis::find_stiffness(const cutting::Milling& milling, double axial_depth_m) {
  const bool equal = milling.tool.has_equal_pitch();
  const int teeth = milling.tool.teeth;
  std::vector<std::size_t> term_of(static_cast<std::size_t>(teeth), 0);
  for (int j = 0; j < teeth; ++j) {
    const double pitch = equal ? period_rad_ : milling.tool.pitch(j);
    std::size_t t = 0;
    while (t < terms_.size() && std::abs(terms_[t].delay_angle - pitch) > 1e-9) ++t;
    if (t == terms_.size()) terms_.push_back({.delay_angle = pitch});
    term_of[static_cast<std::size_t>(j)] = t;
  }
  const bool damped = milling.process_damping.active();
  if (damped) terms_.push_back({.damping = true});
  for (Term& term : terms_) {
    // Over whole periods the delay's factor is one number, so that the limit counts for it too.
    const bool whole = !term.damping && std::abs(term.delay_angle - period_rad_) < 1e-12;
    const Eigen::Matrix2d& limit = term.damping ? response_.first_moment() : response_.compliance();
    term.limit = {limit, whole ? limit : Eigen::Matrix2d::Zero()};
    for (auto& entry : term.stiffness) {
      for (const Arc& arc : arcs_) entry.push_back(Eigen::MatrixXd::Zero(arc.count, arc.count));
    }
  }
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    const Arc& arc = arcs_[a];
    // The stiffness itself is smooth on the arc; eight more nodes than the product of two polynomials needs.
    const GaussRule rule = make_gauss_rule(static_cast<int>(arc.count) + 8);
    for (std::size_t q = 0; q < rule.node.size(); ++q) {
      const double angle = arc.from + (arc.to - arc.from) * rule.node[q];
      const Eigen::VectorXd p = legendre(arc.count, 2.0 * rule.node[q] - 1.0);
      const auto add = [&](Term& term, const Eigen::Matrix2d& value) {
        for (Eigen::Index e = 0; e < 4; ++e) {
          if (value(e) == 0.0) continue;
          term.stiffness[static_cast<std::size_t>(e)][a] += (rule.weight[q] * value(e)) * p * p.transpose();
        }
      };
      for (int j = 0; j < teeth; ++j) {
        add(terms_[term_of[static_cast<std::size_t>(j)]],
            cutting::cutting_stiffness(milling, j, angle, axial_depth_m) / axial_depth_m);
        if (damped) {
          add(terms_.back(), cutting::cutting_damping(milling, j, angle, 0.0, axial_depth_m, speed_) / axial_depth_m);
        }
      }
    }
  }
}

/// c(s) G(s) less what it tends to.
Eigen::Matrix2cd ContactBasis::gain(const Term& term, double frequency, const Eigen::Matrix2cd& receptance) const {
  if (term.damping) {
    const Complex s(0.0, frequency);
    return s * (receptance - response_.compliance().cast<Complex>()) - term.limit[0].cast<Complex>();
  }
  const Complex delayed = std::polar(1.0, -frequency * term.delay_angle / speed_);
  return (1.0 - delayed) * receptance - term.limit[0].cast<Complex>() + delayed * term.limit[1].cast<Complex>();
}

bool ContactBasis::acts(const Term& term, std::size_t arc) const {
  return std::ranges::any_of(term.stiffness, [arc](const auto& entry) { return !entry[arc].isZero(0.0); });
}

/// Harmonics of from <= |n| <= to, for each term in the rows of the arcs where it acts.
void ContactBasis::add_rows(double frequency, Eigen::Index from, Eigen::Index to, bool covered_only,
                            std::vector<Blocks>& sums) const {
  const Eigen::Index negative = from == 0 ? to : to - from + 1;
  const Eigen::Index rows = negative + to - from + 1;
  Eigen::MatrixXcd psi(rows, count_);
  Eigen::RowVectorXcd values(count_);
  std::vector<double> omega;
  std::vector<Eigen::Matrix2cd> receptance;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Eigen::Index n = row < negative ? row - to : from + row - negative;
    omega.push_back(frequency + static_cast<double>(n) * period_frequency_);
    transform(omega.back() / period_frequency_, values);
    psi.row(row) = values;
    receptance.push_back(response_.at(omega.back()));
  }
  Eigen::VectorXcd gains(rows);
  Eigen::MatrixXcd weighted;
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    for (Eigen::Index e = 0; e < 4; ++e) {
      for (Eigen::Index row = 0; row < rows; ++row) {
        const auto r = static_cast<std::size_t>(row);
        gains(row) = covered_only && !response_.covers(omega[r]) ? 0.0 : gain(terms_[t], omega[r], receptance[r])(e);
      }
      if (gains.isZero(0.0)) continue;
      weighted.noalias() = gains.asDiagonal() * psi;
      for (std::size_t a = 0; a < arcs_.size(); ++a) {
        if (!acts(terms_[t], a)) continue;
        sums[t][static_cast<std::size_t>(e)].middleRows(arcs_[a].first, arcs_[a].count).noalias() +=
            psi.middleCols(arcs_[a].first, arcs_[a].count).adjoint() * weighted;
      }
    }
  }
}

void ContactBasis::find_tails() {
  for (int k = 0; k < chebyshev_points; ++k) {
    std::vector<Blocks> sums(terms_.size());
    for (Blocks& sum : sums) sum.fill(Eigen::MatrixXcd::Zero(count_, count_));
    add_rows(chebyshev(k) * 0.5 * period_frequency_, near_ + 1, far_, false, sums);
    for (std::size_t t = 0; t < terms_.size(); ++t) terms_[t].tail.push_back(std::move(sums[t]));
  }
}

void ContactBasis::matrix(double frequency_rad_per_s, Eigen::MatrixXcd& out, bool covered_only) const {
  const std::array<double, chebyshev_points> share = chebyshev_shares(2.0 * frequency_rad_per_s / period_frequency_);
  std::vector<Blocks> sums(terms_.size());
  for (Blocks& sum : sums) sum.fill(Eigen::MatrixXcd::Zero(count_, count_));
  add_rows(frequency_rad_per_s, 0, interpolated_ ? near_ : far_, covered_only, sums);
  out.setZero(2 * count_, 2 * count_);
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    const Term& term = terms_[t];
    Blocks& sum = sums[t];
    if (!covered_only) {
      const Complex delayed = std::polar(1.0, -frequency_rad_per_s * term.delay_angle / speed_);
      for (std::size_t e = 0; e < 4; ++e) {
        for (std::size_t k = 0; k < term.tail.size(); ++k) sum[e] += share[k] * term.tail[k][e];
        const auto entry = static_cast<Eigen::Index>(e);
        sum[e].diagonal().array() += term.limit[0](entry) - delayed * term.limit[1](entry);
      }
    }
    for (std::size_t a = 0; a < arcs_.size(); ++a) {
      if (acts(term, a)) multiply(term, a, sum, out);
    }
  }
}

/// Adds 𝒦_d of one arc times what stands in its rows.
void ContactBasis::multiply(const Term& term, std::size_t arc, const Blocks& sum, Eigen::MatrixXcd& out) const {
  const Eigen::Index first = arcs_[arc].first;
  const Eigen::Index count = arcs_[arc].count;
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (Eigen::Index j = 0; j < 2; ++j) {
      auto block = out.block(i * count_ + first, j * count_, count, count_);
      for (Eigen::Index k = 0; k < 2; ++k) {
        const auto rows = sum[static_cast<std::size_t>(k + 2 * j)].middleRows(first, count);
        const Eigen::MatrixXd& stiffness = term.stiffness[static_cast<std::size_t>(i + 2 * k)][arc];
        const Eigen::MatrixXd real = stiffness * rows.real();
        const Eigen::MatrixXd imaginary = stiffness * rows.imag();
        block.real() += real;
        block.imag() += imaginary;
      }
    }
  }
}

Eigen::Vector2cd ContactBasis::harmonic(const Eigen::VectorXcd& coefficients, double frequency_rad_per_s, int n) const {
  Eigen::RowVectorXcd psi(count_);
  transform(frequency_rad_per_s / period_frequency_ + n, psi);
  return {(psi * coefficients.head(count_)).value(), (psi * coefficients.tail(count_)).value()};
}

}  // namespace robomill::stability::detail
