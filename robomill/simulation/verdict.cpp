#include "robomill/simulation/verdict.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/signal/spectrum.hpp"

namespace robomill::simulation::detail {

std::complex<double> dominant_multiplier(const Eigen::MatrixXd& snapshots) {
  const Eigen::Index n = snapshots.cols() - 1;
  const double size = snapshots.norm();
  if (n < 2 || !(size > 0.0)) return 0.0;
  const linear_algebra::ThinSvd svd = linear_algebra::thin_svd(Eigen::MatrixXd(snapshots.leftCols(n) / size));
  // Directions below this share of the greatest are rounding and would give multipliers of their own.
  constexpr double least = 1e-9;
  const Eigen::VectorXd& sigma = svd.values;
  Eigen::Index rank = 0;
  while (rank < sigma.size() && sigma(rank) > least * sigma(0)) ++rank;
  if (rank == 0) return 0.0;
  const Eigen::MatrixXd small = svd.u.leftCols(rank).transpose() * (snapshots.rightCols(n) / size) *
                                svd.v.leftCols(rank) * sigma.head(rank).cwiseInverse().asDiagonal();
  const Eigen::VectorXcd multipliers = linear_algebra::eigenvalues(small);
  Eigen::Index best = 0;
  multipliers.cwiseAbs().maxCoeff(&best);
  return {multipliers(best).real(), std::abs(multipliers(best).imag())};
}

Judgement judge(const Eigen::MatrixXd& samples, const SmallVibration& small) {
  const bool known = small.status == SmallVibration::Status::found;
  const auto by_small = [&] {
    if (!known) return Verdict::undecided;
    return small.spectral_radius < 1.0 ? Verdict::stable : Verdict::chatter;
  };
  if (small.status == SmallVibration::Status::rigid) return {Verdict::stable, 0.0};
  const Eigen::Index periods = samples.cols() - 1;
  if (periods < 8) return {by_small(), 0.0};
  const Eigen::Index quarter = periods / 4;
  const Eigen::MatrixXd change = samples.rightCols(periods) - samples.leftCols(periods);
  const double earlier = change.middleCols(periods - 2 * quarter, quarter).norm();
  const double last = change.rightCols(quarter).norm();
  const double motion = samples.rightCols(quarter).norm();
  // The remainder of a motion that has died out is rounding.
  if (last <= 1e-8 * motion) return {Verdict::stable, 0.0};
  const double ratio = last / std::max(earlier, 1e-300);
  const double growth = std::pow(ratio, 1.0 / static_cast<double>(quarter));
  if (ratio > 1.4) return {Verdict::chatter, growth};
  if (ratio < 0.7 || (ratio < 1.0 && last < 1e-4 * motion)) return {Verdict::stable, growth};
  // Neither dies nor grows: a slow end of a stable start, chatter that has reached its size, or too close to say.
  const bool small_dies = known && small.spectral_radius < 1.0;
  if (last > 0.05 * motion && !(small_dies && ratio < 0.9)) return {Verdict::chatter, growth};
  return {by_small(), growth};
}

namespace {

/// The greatest length up to n, >= 1, without prime factors above 5: quick to transform.
Eigen::Index quick_length(Eigen::Index n) {
  Eigen::Index best = 1;
  for (Eigen::Index two = 1; two <= n; two *= 2) {
    for (Eigen::Index three = two; three <= n; three *= 3) {
      Eigen::Index five = three;
      while (five <= n / 5) five *= 5;
      best = std::max(best, five);
    }
  }
  return best;
}

}  // namespace

SpectralLine strongest_line(const Eigen::MatrixXd& motion, Eigen::Index period, double sample_rate_hz) {
  SpectralLine line;
  const Eigen::Index turns = period > 0 ? motion.rows() / period : 0;
  if (turns < 4) return line;
  const Eigen::Index length = turns * period;
  for (Eigen::Index c = 0; c < motion.cols(); ++c) {
    Eigen::VectorXd rest = motion.col(c).tail(length);
    if (!(rest.cwiseAbs().maxCoeff() > 0.0)) continue;
    Eigen::Map<Eigen::MatrixXd> folded(rest.data(), period, turns);
    const Eigen::VectorXd repeated = folded.rowwise().mean();
    folded.colwise() -= repeated;
    const auto peaks =
        signal::find_peaks(signal::amplitude_spectrum(rest.tail(quick_length(length)), sample_rate_hz), {.count = 1});
    if (!peaks.empty() && peaks.front().amplitude > line.amplitude_m) {
      line = {peaks.front().frequency_hz, peaks.front().amplitude};
    }
  }
  return line;
}

}  // namespace robomill::simulation::detail
