#include "robomill/stability/frequency_domain/crossings.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// An eigenvalue is real by symmetry where its imaginary part is at most this share of it.
constexpr double real_enough = 1e-6;

/// The eigenvalues of greatest modulus, by Arnoldi's iteration from a fixed start vector, twice orthogonalised; a Ritz
/// value counts when its residual is below 1e-9 of the norm of the small matrix. The whole spectrum where that does
/// not come soon. Source: [Saad2011].
class LargestEigenvalues {
 public:
  /// Those above `least`, in any order.
  void find(const Eigen::MatrixXcd& a, double least, std::vector<Complex>& out) {
    const Eigen::Index n = a.rows();
    for (Eigen::Index columns = 10; 2 * columns <= n; columns += 6) {
      iterate(a, columns);
      if (converged(columns, least, out)) return;
    }
    built_ = 0;
    keep(linear_algebra::eigenvalues(a), least, out);
    built_ = 0;
  }

 private:
  static void keep(const Eigen::VectorXcd& values, double least, std::vector<Complex>& out) {
    out.clear();
    for (const Complex value : values) {
      if (std::abs(value) > least) out.push_back(value);
    }
  }
  void iterate(const Eigen::MatrixXcd& a, Eigen::Index columns) {
    const Eigen::Index n = a.rows();
    if (columns == 10 || basis_.rows() != n) {
      basis_.resize(n, n + 1);
      small_.setZero(n + 1, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        basis_(i, 0) =
            Complex(1.0 + 0.3 * std::sin(1.7 * static_cast<double>(i)), 0.2 * std::cos(2.3 * static_cast<double>(i)));
      }
      basis_.col(0).normalize();
      built_ = 0;
    }
    for (; built_ < columns; ++built_) {
      next_.noalias() = a * basis_.col(built_);
      for (int pass = 0; pass < 2; ++pass) {
        share_.noalias() = basis_.leftCols(built_ + 1).adjoint() * next_;
        next_.noalias() -= basis_.leftCols(built_ + 1) * share_;
        small_.col(built_).head(built_ + 1) += share_;
      }
      const double left = next_.norm();
      small_(built_ + 1, built_) = left;
      if (left > 0.0) basis_.col(built_ + 1) = next_ / left;
    }
  }
  bool converged(Eigen::Index columns, double least, std::vector<Complex>& out) {
    const Eigen::MatrixXcd h = small_.topLeftCorner(columns, columns);
    const linear_algebra::EigenPairs pairs = linear_algebra::eigen_pairs(h);
    if (!pairs.converged) return false;
    const double rest = std::abs(small_(columns, columns - 1));
    const double allowed = 1e-9 * h.norm();
    for (Eigen::Index i = 0; i < columns; ++i) {
      if (std::abs(pairs.values(i)) < least) continue;
      if (rest * std::abs(pairs.vectors(columns - 1, i)) > allowed) return false;
    }
    keep(pairs.values, least, out);
    return true;
  }

  Eigen::Index built_ = 0;
  Eigen::MatrixXcd basis_, small_;
  Eigen::VectorXcd next_, share_;
};

struct Sample {
  double frequency = 0.0;
  std::vector<Complex> values = {};  ///< those that could count within a neighbouring interval
};

Complex nearest(const std::vector<Complex>& values, Complex to) {
  Complex best = 0.0;  // Eigenvalues too small to count are left out of a sample.
  double least = std::abs(to);
  for (const Complex value : values) {
    const double distance = std::abs(value - to);
    if (distance < least) {
      least = distance;
      best = value;
    }
  }
  return best;
}

class Tracer {
 public:
  Tracer(const MatrixAt& matrix, const Sweep& sweep)
      : matrix_(matrix), sweep_(sweep), floor_(0.7 / sweep.largest_gain) {}

  std::vector<GainCrossing> run() {
    std::vector<double> nodes = sweep_.nodes;
    nodes.push_back(sweep_.from);
    nodes.push_back(sweep_.to);
    std::erase_if(nodes, [&](double f) { return f < sweep_.from || f > sweep_.to; });
    std::ranges::sort(nodes);
    const double apart = 1e-9 * (sweep_.to - sweep_.from);
    const auto close = [apart](double a, double b) { return b - a < apart; };
    nodes.erase(std::unique(nodes.begin(), nodes.end(), close), nodes.end());
    nodes.back() = sweep_.to;
    Sample left = sample(nodes.front());
    const Sample first = left;
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      Sample right = sample(nodes[i]);
      interval(left, right, 0);
      left = right;
    }
    if (sweep_.real_from) ends(first, GainCrossing::At::from);
    if (sweep_.real_to) ends(left, GainCrossing::At::to);
    std::ranges::sort(found_, {}, &GainCrossing::gain);
    return found_;
  }

 private:
  Sample sample(double frequency) {
    matrix_(frequency, work_);
    Sample s{.frequency = frequency};
    if (work_.size() == 0 || work_.norm() < 0.3 * floor_) return s;
    eigenvalues_.find(work_, 0.3 * floor_, s.values);
    return s;
  }

  void ends(const Sample& s, GainCrossing::At at) {
    for (const Complex value : s.values) {
      if (value.real() * sweep_.largest_gain < 1.0 || std::abs(value.imag()) > real_enough * value.real()) continue;
      if (std::abs(nearest(s.values, std::conj(value)) - value) > 0.5 * std::abs(value.imag())) continue;  // a pair
      const double step = (sweep_.to - sweep_.from) * (at == GainCrossing::At::from ? 1e-4 : -1e-4);
      const Sample beside = sample(s.frequency + step);
      const double slope = (nearest(beside.values, value).imag() - value.imag()) / step;
      found_.push_back({s.frequency, 1.0 / value.real(), slope < 0.0, at});
    }
  }

  /// Whether all that counts moves smoothly from left over middle to right.
  [[nodiscard]] bool smooth(const Sample& left, const Sample& middle, const Sample& right) const {
    for (const Complex value : middle.values) {
      if (std::abs(value) < floor_) continue;
      const Complex before = nearest(left.values, value);
      const Complex after = nearest(right.values, value);
      if (std::abs(value - 0.5 * (before + after)) > 0.06 * std::abs(value)) return false;
      if (std::abs(after - before) > 0.7 * std::abs(value)) return false;
    }
    for (const Sample* end : {&left, &right}) {
      for (const Complex value : end->values) {
        if (std::abs(value) >= floor_ && std::abs(nearest(middle.values, value) - value) > 0.5 * std::abs(value)) {
          return false;
        }
      }
    }
    return true;
  }

  void interval(const Sample& left, const Sample& right, int depth) {
    const Sample middle = sample(0.5 * (left.frequency + right.frequency));
    if (depth < 36 && !smooth(left, middle, right)) {
      interval(left, middle, depth + 1);
      interval(middle, right, depth + 1);
      return;
    }
    for (const Complex value : middle.values) {
      if (std::abs(value) < 0.5 * floor_) continue;
      track(left.frequency, right.frequency, {nearest(left.values, value), value, nearest(right.values, value)});
    }
  }

  /// Roots of the parabola through the imaginary parts show where to look.
  void track(double left, double right, const std::array<Complex, 3>& values) {
    if (std::ranges::all_of(values, [](Complex v) { return v.real() <= 0.0; })) return;
    const double middle = 0.5 * (left + right);
    const auto crosses = [](Complex a, Complex b) { return (a.imag() > 0.0) != (b.imag() > 0.0); };
    if (crosses(values[0], values[1])) root(left, values[0], middle, values[1]);
    if (crosses(values[1], values[2])) root(middle, values[1], right, values[2]);
    if (crosses(values[0], values[1]) || crosses(values[1], values[2])) return;
    // No change of sign: perhaps two roots on either side of the parabola's vertex.
    const double bend = 0.5 * (values[0].imag() + values[2].imag()) - values[1].imag();
    const double tilt = 0.5 * (values[2].imag() - values[0].imag());
    if (bend == 0.0 || std::abs(tilt) >= 2.0 * std::abs(bend)) return;
    const double t = -tilt / (2.0 * bend);
    const double height = values[1].imag() - tilt * tilt / (4.0 * bend);
    const double size = std::max({std::abs(values[0].imag()), std::abs(values[1].imag()), std::abs(values[2].imag())});
    if ((height > 0.0) == (values[1].imag() > 0.0) && std::abs(height) > 0.1 * size) return;
    const double vertex = middle + t * 0.5 * (right - left);
    const Complex guess =
        values[1] + 0.5 * t * (values[2] - values[0]) + t * t * (0.5 * (values[0] + values[2]) - values[1]);
    const Complex value = nearest(sample(vertex).values, guess);
    if (!crosses(value, values[1])) return;
    root(left, values[0], vertex, value);
    root(vertex, value, right, values[2]);
  }

  void root(double low, Complex at_low, double high, Complex at_high) {
    double y_low = at_low.imag();
    double y_high = at_high.imag();
    const bool opens = y_low > 0.0;
    double frequency = low;
    Complex value = at_low;
    for (int step = 0; step < 60; ++step) {
      const double t = y_low / (y_low - y_high);
      frequency = low + t * (high - low);
      const double share = std::clamp((frequency - low) / (high - low), 0.0, 1.0);
      value = nearest(sample(frequency).values, at_low + share * (at_high - at_low));
      if (std::abs(value.imag()) <= 1e-12 * std::abs(value) || high - low <= 1e-15 * high) break;
      const bool below = (value.imag() > 0.0) == opens;
      (below ? low : high) = frequency;
      (below ? at_low : at_high) = value;
      const bool again = step > 0 && below == last_below_;
      (below ? y_low : y_high) = value.imag();
      if (again) (below ? y_high : y_low) *= 0.5;  // Illinois
      last_below_ = below;
    }
    keep(frequency, value, opens);
  }

  void keep(double frequency, Complex value, bool opens) {
    if (!(value.real() * sweep_.largest_gain >= 1.0) || std::abs(value.imag()) > 1e-6 * value.real()) return;
    const double range = sweep_.to - sweep_.from;
    if (sweep_.real_from && frequency - sweep_.from < 1e-7 * range) return;
    if (sweep_.real_to && sweep_.to - frequency < 1e-7 * range) return;
    const double gain = 1.0 / value.real();
    for (const GainCrossing& c : found_) {
      if (std::abs(c.frequency - frequency) < 1e-9 * range && std::abs(c.gain - gain) < 1e-7 * gain) return;
    }
    found_.push_back({frequency, gain, opens, GainCrossing::At::inside});
  }

  const MatrixAt& matrix_;
  const Sweep& sweep_;
  double floor_;
  bool last_below_ = false;
  Eigen::MatrixXcd work_;
  LargestEigenvalues eigenvalues_;
  std::vector<GainCrossing> found_;
};

}  // namespace

std::vector<GainCrossing> find_crossings(const MatrixAt& matrix, const Sweep& sweep) {
  return Tracer(matrix, sweep).run();
}

Complex nearest_eigenvalue(const Eigen::MatrixXcd& matrix, Complex guess, Eigen::VectorXcd& vector) {
  const Eigen::Index n = matrix.rows();
  if (vector.size() != n) vector = Eigen::VectorXcd::Constant(n, Complex(1.0, 0.1));
  vector.normalize();
  const double size = matrix.norm();
  Complex value = guess;
  for (int factored = 0; factored < 4; ++factored) {
    // A shift beside the eigenvalue, so that what is solved is not singular.
    const Complex shift = value + Complex(1e-7, 1.3e-7) * std::abs(guess);
    const Eigen::PartialPivLU<Eigen::MatrixXcd> solver(matrix - shift * Eigen::MatrixXcd::Identity(n, n));
    for (int step = 0; step < 8; ++step) {
      const Eigen::VectorXcd next = solver.solve(vector);
      vector = next.normalized();
      const Eigen::VectorXcd image = matrix * vector;
      value = vector.dot(image);
      if ((image - value * vector).norm() <= 1e-14 * size) return value;
    }
  }
  return value;
}

GainCrossing follow(const MatrixAt& matrix, const GainCrossing& from) {
  Eigen::MatrixXcd work;
  Eigen::VectorXcd vector;
  Complex guess = 1.0 / from.gain;
  const auto value_at = [&](double frequency) {
    matrix(frequency, work);
    guess = nearest_eigenvalue(work, guess, vector);
    return guess;
  };
  GainCrossing out = from;
  Complex value = value_at(from.frequency);
  if (from.at == GainCrossing::At::inside) {
    double before = from.frequency;
    Complex value_before = value;
    double step = 1e-6 * from.frequency;
    for (int i = 0; i < 30 && std::abs(value.imag()) > 1e-13 * std::abs(value); ++i) {
      out.frequency = before + step;
      value = value_at(out.frequency);
      const double change = value.imag() - value_before.imag();
      if (change == 0.0) break;
      const double next = -value.imag() * (out.frequency - before) / change;
      before = out.frequency;
      value_before = value;
      if (std::abs(next) < 1e-14 * out.frequency) break;
      step = std::clamp(next, -0.02 * from.frequency, 0.02 * from.frequency);
    }
  }
  const double allowed = from.at == GainCrossing::At::inside ? 1e-6 : real_enough;
  const bool found = value.real() > 0.0 && std::abs(value.imag()) <= allowed * value.real();
  out.gain = found ? 1.0 / value.real() : 0.0;
  return out;
}

}  // namespace robomill::stability::detail
