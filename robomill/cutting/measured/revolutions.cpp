#include "robomill/cutting/measured/revolutions.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/cutting/larger.hpp"

namespace robomill::cutting::detail {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// Of each revolution and harmonic, three components: Σ x e^(-i k 2π turns n).
class Amplitudes {
 public:
  Amplitudes(const Eigen::Matrix3Xd& force_n, double turns, int harmonics)
      : harmonics_(harmonics), count_(static_cast<Eigen::Index>(static_cast<double>(force_n.cols()) * turns)) {
    values_.assign(static_cast<std::size_t>(count_ * harmonics_ * 3), Complex());
    for (Eigen::Index i = 0; i < force_n.cols(); ++i) {
      const double turn = static_cast<double>(i) * turns;
      const auto block = static_cast<Eigen::Index>(turn);
      if (block >= count_) break;
      const Complex step = std::polar(1.0, -2.0 * pi * (turn - std::floor(turn)));
      Complex at = step;
      Complex* to = &values_[static_cast<std::size_t>(block * harmonics_ * 3)];
      for (int k = 0; k < harmonics_; ++k, at *= step) {
        for (Eigen::Index axis = 0; axis < 3; ++axis) *to++ += force_n(axis, i) * at;
      }
    }
  }
  /// Energy of all harmonics at a speed that is (1 + change) of the one they were taken at.
  [[nodiscard]] double energy(double change) const {
    std::vector<Complex> sums(static_cast<std::size_t>(harmonics_) * 3);
    for (Eigen::Index block = 0; block < count_; ++block) {
      const Complex step = std::polar(1.0, -2.0 * pi * change * static_cast<double>(block));
      Complex at = step;
      const Complex* from = &values_[static_cast<std::size_t>(block * harmonics_ * 3)];
      for (std::size_t k = 0; k < sums.size(); k += 3, at *= step) {
        for (std::size_t axis = 0; axis < 3; ++axis) sums[k + axis] += *from++ * at;
      }
    }
    double out = 0.0;
    for (const Complex& sum : sums) out += std::norm(sum);
    return out;
  }

 private:
  int harmonics_;
  Eigen::Index count_;
  std::vector<Complex> values_;
};

}  // namespace

std::vector<double> variation_by_revolution(const Eigen::Matrix3Xd& force_n, double samples) {
  std::vector<double> out;
  for (double begin = 0.0; begin + samples <= static_cast<double>(force_n.cols()); begin += samples) {
    const auto part = force_n.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(samples));
    const Eigen::Vector3d mean = part.rowwise().mean();
    out.push_back(std::sqrt((part.colwise() - mean).squaredNorm() / static_cast<double>(part.cols())));
  }
  return out;
}

double strongest(const std::vector<double>& variation, Run within) {
  double out = 0.0;
  for (int b = within.begin; b + least_revolutions <= within.end; ++b) {
    out = std::max(out, *std::min_element(variation.begin() + b, variation.begin() + b + least_revolutions));
  }
  return out;
}

CutAndAir find_cut(const std::vector<double>& variation, Run within) {
  CutAndAir out;
  out.strong = strongest(variation, within);
  const int count = static_cast<int>(variation.size());
  enum class Level { air, weak, cut, jolt };
  const auto level_of = [&](int b) {
    const double share = variation[static_cast<std::size_t>(b)] / out.strong;
    return share < 0.1 ? Level::air : share <= 0.5 ? Level::weak : share < 2.0 ? Level::cut : Level::jolt;
  };
  if (!(out.strong > 0.0)) return out;
  for (int b = 0; b < count;) {
    const Level level = level_of(b);
    Run run{b, b};
    while (run.end < count && level_of(run.end) == level) ++run.end;
    b = run.end;
    if (level == Level::jolt) out.jolts += run.length();
    if (level == Level::weak) out.weak = std::max(out.weak, run.length());
    if (level == Level::cut && run.length() > out.cut.length()) out.cut = run;
    for (int i = run.begin; level == Level::air && i < run.end; ++i) out.air.push_back(i);
  }
  // Where the cut begins and ends within the record, so does the engagement of these revolutions.
  if (out.cut.begin > 0 && out.cut.length() > 1) ++out.cut.begin;
  if (out.cut.end < count && out.cut.length() > 1) --out.cut.end;
  return out;
}

double find_speed(const Eigen::Matrix3Xd& force_n, double turns, double tolerance, int harmonics) {
  const double revolutions = static_cast<double>(force_n.cols()) * turns;
  double found = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    // The second pass demodulates at the speed of the first, where its blocks lose nothing.
    const Amplitudes amplitudes(force_n, turns * (1.0 + found), harmonics);
    const double step = 1.0 / (8.0 * harmonics * revolutions);
    const double reach = pass == 0 ? tolerance : 4.0 * step;
    const int each_way = static_cast<int>(std::ceil(reach / step));
    double best = -1.0, change = 0.0;
    for (int i = -each_way; i <= each_way; ++i) {
      const double at = reach * i / std::max(each_way, 1);
      const double energy = amplitudes.energy(at);
      if (energy > best) {
        best = energy;
        change = at;
      }
    }
    found = (1.0 + found) * (1.0 + change) - 1.0;
  }
  return turns * (1.0 + found);
}

std::vector<Eigen::Matrix3Xd> revolutions_at(const Eigen::Matrix3Xd& force_n, double first, double turns,
                                             Eigen::Index steps) {
  std::vector<Eigen::Matrix3Xd> out;
  const double samples = 1.0 / turns;
  for (double begin = first; begin + samples <= static_cast<double>(force_n.cols() - 3); begin += samples) {
    Eigen::Matrix3Xd& revolution = out.emplace_back(3, steps);
    for (Eigen::Index i = 0; i < steps; ++i) {
      const double place = begin + samples * static_cast<double>(i) / static_cast<double>(steps);
      const auto at = static_cast<Eigen::Index>(place);
      const double s = place - static_cast<double>(at);
      // Lagrange through the samples at -1, 0, 1, 2.
      const double a = -s * (s - 1.0) * (s - 2.0) / 6.0, b = (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0;
      const double c = -(s + 1.0) * s * (s - 2.0) / 2.0, d = (s + 1.0) * s * (s - 1.0) / 6.0;
      revolution.col(i) =
          a * force_n.col(at - 1) + b * force_n.col(at) + c * force_n.col(at + 1) + d * force_n.col(at + 2);
    }
  }
  return out;
}

Eigen::Matrix3Xd mean_of(const std::vector<Eigen::Matrix3Xd>& revolutions) {
  Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, revolutions.front().cols());
  for (const Eigen::Matrix3Xd& revolution : revolutions) mean += revolution;
  return mean / static_cast<double>(revolutions.size());
}

Angles angles_of(const std::vector<Eigen::Matrix3Xd>& revolutions) {
  const Eigen::Matrix3Xd mean = mean_of(revolutions);
  const Eigen::Index steps = mean.cols();
  Eigen::Matrix3Xd slope(3, steps);
  for (Eigen::Index i = 0; i < steps; ++i) {
    const Eigen::Vector3d rise = mean.col((i + 1) % steps) - mean.col((i + steps - 1) % steps);
    slope.col(i) = rise * static_cast<double>(steps) / (4.0 * pi);
  }
  const double energy = slope.squaredNorm();
  const auto count = static_cast<Eigen::Index>(revolutions.size());
  Eigen::VectorXd angle(count), place(count);
  for (Eigen::Index b = 0; b < count; ++b) {
    // The mean of a revolution drifts, which is no angle.
    Eigen::Matrix3Xd rest = revolutions[static_cast<std::size_t>(b)] - mean;
    rest.colwise() -= Eigen::Vector3d(rest.rowwise().mean());
    angle(b) = energy > 0.0 ? rest.cwiseProduct(slope).sum() / energy : 0.0;
    place(b) = static_cast<double>(b) - 0.5 * static_cast<double>(count - 1);
  }
  Angles out;
  const double spread = place.squaredNorm();
  out.slope_rad = spread > 0.0 ? place.dot(angle) / spread : 0.0;
  const Eigen::VectorXd left = angle.array() - angle.mean() - out.slope_rad * place.array();
  out.scatter_rad = count > 2 ? std::sqrt(left.squaredNorm() / static_cast<double>(count - 2)) : 0.0;
  out.slope_deviation_rad = spread > 0.0 ? out.scatter_rad / std::sqrt(spread) : 0.0;
  return out;
}

Eigen::Vector3d peaks_of(const Eigen::Matrix3Xd& force_n) {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < force_n.cols(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) out(axis) = larger(out(axis), force_n(axis, i));
  }
  return out;
}

}  // namespace robomill::cutting::detail
