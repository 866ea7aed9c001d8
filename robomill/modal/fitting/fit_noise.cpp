#include "robomill/modal/fitting/fit_noise.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "robomill/base/statistics.hpp"

namespace robomill::modal::detail {
namespace {

using Eigen::Index;

// Below this share of the largest, a variance says nothing: it is rounding.
constexpr double smallest_variance = 1e-20;

constexpr double median_of_exponential = 0.6931471805599453;  // of |e|² where E|e|² = 1

// The mean of the logarithm over 2 half + 1 lines; zeros count as the smallest positive value.
Eigen::VectorXd smooth_logarithm(const Eigen::VectorXd& variance, Index half) {
  const double floor = std::max(variance.maxCoeff(), 1e-300) * smallest_variance;
  const Eigen::ArrayXd logarithm = variance.array().max(floor).log();
  Eigen::VectorXd smooth(variance.size());
  for (Index i = 0; i < variance.size(); ++i) {
    const Index begin = std::max<Index>(0, i - half);
    const Index end = std::min<Index>(variance.size(), i + half + 1);
    smooth(i) = std::exp(logarithm.segment(begin, end - begin).mean());
  }
  return smooth;
}

}  // namespace

Eigen::VectorXd known_variance(const Frf& frf, Weighting weighting) {
  constexpr Index half = 2;
  if (weighting == Weighting::deviation) return smooth_logarithm(frf.deviation.cwiseAbs2(), half);
  const Eigen::ArrayXd coherence = frf.coherence.array().max(1e-6).min(1.0);
  const Eigen::VectorXd relative = smooth_logarithm(((1.0 - coherence) / coherence).max(1e-12), half);
  return relative.cwiseProduct(frf.receptance.cwiseAbs2());
}

Eigen::VectorXd scatter(const Eigen::VectorXd& omega, const Eigen::VectorXcd& values) {
  const Index n = values.size();
  Eigen::VectorXd squares(n);
  for (Index i = 1; i + 1 < n; ++i) {
    const double t = (omega(i) - omega(i - 1)) / (omega(i + 1) - omega(i - 1));
    const std::complex<double> between = (1.0 - t) * values(i - 1) + t * values(i + 1);
    squares(i) = std::norm(values(i) - between) / (1.0 + t * t + (1.0 - t) * (1.0 - t));
  }
  squares(0) = squares(1);
  squares(n - 1) = squares(n - 2);
  return squares;
}

double relative_scatter(const Eigen::VectorXd& omega, const Eigen::VectorXcd& residual,
                        const Eigen::VectorXcd& receptance) {
  const Eigen::VectorXd squares = scatter(omega, residual);
  std::vector<double> shares;
  for (Index i = 0; i < squares.size(); ++i) {
    if (receptance(i) != 0.0) shares.push_back(squares(i) / std::norm(receptance(i)));
  }
  return std::sqrt(median(shares) / median_of_exponential);
}

Eigen::VectorXd variance_of_size(const Eigen::VectorXd& squares, const Eigen::VectorXd& size2) {
  const double floor = smallest_variance * std::max(size2.maxCoeff(), 1e-300);
  double constant = 0.5 * squares.mean() + floor;
  double relative = 0.5 * squares.sum() / std::max(size2.sum(), 1e-300) + smallest_variance;
  Eigen::ArrayXd variance;
  // Each step raises the likelihood Σ -log v - squares / v: a bound below it is maximised [Zhou2019].
  for (int step = 0; step < 60; ++step) {
    variance = constant + relative * size2.array() + floor;
    const Eigen::ArrayXd inverse = variance.inverse();
    const Eigen::ArrayXd pull = squares.array() * inverse.square();
    constant *= std::sqrt(pull.sum() / inverse.sum());
    relative *= std::sqrt((pull * size2.array()).sum() / (inverse * size2.array()).sum());
  }
  return constant + relative * size2.array() + floor;
}

Eigen::VectorXd first_variance(const Eigen::VectorXd& omega, const Eigen::VectorXcd& receptance) {
  const Eigen::VectorXd squares = scatter(omega, receptance);
  const Eigen::VectorXd size2 = receptance.cwiseAbs2();
  std::vector<double> sizes(size2.begin(), size2.end());
  const double middle = median(sizes);
  std::vector<double> large;
  for (Index i = 0; i < size2.size(); ++i) {
    if (size2(i) >= middle && size2(i) > 0.0) large.push_back(squares(i) / size2(i));
  }
  const double relative = median(large) / median_of_exponential;
  const auto fifth = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 5);
  std::nth_element(sizes.begin(), fifth, sizes.end());
  std::vector<double> small;
  for (Index i = 0; i < size2.size(); ++i) {
    if (size2(i) <= *fifth) small.push_back(squares(i) - median_of_exponential * relative * size2(i));
  }
  const double constant = std::max(0.0, median(small) / median_of_exponential);
  // Never wholly trusting: no measurement is better than a ten-thousandth.
  const double floor = 1e-8 * std::max(size2.mean(), 1e-300);
  return constant + 1e-3 * floor + (relative + 1e-8) * size2.array();
}

double misfit_variance(const Eigen::VectorXd& squares, const Eigen::VectorXd& variance) {
  double misfit = squares.mean();
  for (int step = 0; step < 60; ++step) {
    const Eigen::ArrayXd inverse = (variance.array() + misfit).max(1e-300).inverse();
    misfit *= std::sqrt((squares.array() * inverse.square()).sum() / inverse.sum());
  }
  return misfit;
}

double correlation_length(const FitData& data, const Eigen::MatrixXcd& residual) {
  const Index n = data.omega.size();
  double power = 0.0;
  std::vector<Eigen::VectorXcd> weighted;
  for (std::size_t f = 0; f < data.entries.size(); ++f) {
    weighted.emplace_back(residual.col(static_cast<Index>(f)).cwiseProduct(data.entries[f].weight));
    power += weighted.back().squaredNorm();
  }
  double length = 1.0;
  const double insignificant = 2.0 / std::sqrt(static_cast<double>(n) * static_cast<double>(residual.cols()));
  for (Index lag = 1; lag < n / 10 && power > 0.0; ++lag) {
    double sum = 0.0;
    for (const Eigen::VectorXcd& r : weighted) sum += r.head(n - lag).dot(r.tail(n - lag)).real();
    if (sum / power < std::max(insignificant, 0.02)) break;
    length += 2.0 * sum / power;
  }
  return length;
}

}  // namespace robomill::modal::detail
