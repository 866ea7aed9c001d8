#include "robomill/stability/eigen/arnoldi.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/random.hpp"
#include "robomill/stability/eigen/kernels.hpp"

namespace robomill::stability::detail {
namespace {

constexpr std::size_t first_extra = 9;  // columns beyond 2n at the first look
constexpr std::size_t first_warm = 16;  // columns at the first look after a warm-up

std::complex<double> upper_half(std::complex<double> value) {
  return {value.real(), std::abs(value.imag())};
}

}  // namespace

double spectral_radius(const Dominant& dominant) {
  const double modulus = std::abs(dominant.multiplier);
  return std::isfinite(modulus) && modulus < 1e100 ? modulus : 1e100;
}

void Arnoldi::start(std::size_t size) {
  if (start_.size() < size) {
    Random random(20040101);
    start_.clear();
    for (std::size_t i = 0; i < size; ++i) start_.push_back(random.uniform(-1.0, 1.0));
  }
  double square = 0.0;
  for (std::size_t i = 0; i < size; ++i) square += start_[i] * start_[i];
  const double scale = 1.0 / std::sqrt(square);
  for (std::size_t i = 0; i < size; ++i) {
    for (double& lane : basis_[i].v) lane = start_[i] * scale;
  }
}

/// Takes the start vector over three periods for each entry of the modes, normed each time.
void Arnoldi::warm_up(PeriodMap& map) {
  Lanes* x = basis_.data();
  Lanes* next = basis_.data() + size_;
  for (std::size_t pass = 0; pass < 3 * map.modal_size(); ++pass) {
    map.apply(x, next);
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      double square = 0.0;
      for (std::size_t i = 0; i < size_; ++i) square += next[i].v[lane] * next[i].v[lane];
      // A motion that overflows or vanishes within a period starts as it is.
      const double scale = std::isfinite(square) && square > 0.0 ? 1.0 / std::sqrt(square) : 0.0;
      if (scale == 0.0) continue;
      for (std::size_t i = 0; i < size_; ++i) x[i].v[lane] = next[i].v[lane] * scale;
    }
  }
}

bool Arnoldi::converged(std::size_t lane, std::size_t columns, bool whole_space, Dominant& out) {
  small_.resize(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const Lanes* column = hessenberg_.data() + c * (most_ + 1);
    for (std::size_t r = 0; r < std::min(columns, c + 2); ++r) small_(r, c) = column[r].v[lane];
  }
  if (!small_.dominant(out.multiplier)) {
    out.multiplier = std::numeric_limits<double>::infinity();  // the motion overflows within a period
    return false;
  }
  ritz_[lane] = small_.vector(out.multiplier);
  const double next = hessenberg_[(columns - 1) * (most_ + 1) + columns].v[lane];
  out.residual = whole_space ? 0.0 : next * std::abs(ritz_[lane].back());
  out.iterations = static_cast<int>(columns);
  if (!(out.residual <= options_.tolerance * (std::abs(out.multiplier) + 0.1 * small_.norm()))) return false;
  out.by = Dominant::By::arnoldi;
  return true;
}

void Arnoldi::find(PeriodMap& map, std::span<Dominant> out) {
  size_ = map.size();
  most_ = std::min(size_, map.modal_size() + options_.extra);
  basis_.resize((most_ + 1) * size_);
  hessenberg_.resize((most_ + 1) * most_);
  std::ranges::fill(out, Dominant{});
  for (auto& vector : full_) vector.resize(0);
  start(size_);
  std::array<bool, lane_count> done = {};
  std::size_t left = out.size();
  const bool warm = map.modal_size() > 2 * options_.most_cold_modes && !options_.full_matrix_only;
  if (warm) warm_up(map);
  const std::size_t first = warm ? first_warm : map.modal_size() + first_extra;
  std::size_t look = options_.full_matrix_only ? most_ + 1 : std::min(most_, first);
  OrthogonalArguments arguments;
  arguments.size = size_;
  arguments.basis = basis_.data();
  for (std::size_t k = 0; k < most_ && left > 0 && !options_.full_matrix_only; ++k) {
    map.apply(basis_.data() + k * size_, basis_.data() + (k + 1) * size_);
    arguments.column = k;
    arguments.coefficients = hessenberg_.data() + k * (most_ + 1);
    orthogonalise(arguments);
    if (k + 1 != look) continue;
    look = std::min(most_, look + (warm ? look / 2 : options_.between));
    for (std::size_t lane = 0; lane < out.size(); ++lane) {
      if (done[lane]) continue;
      done[lane] = converged(lane, k + 1, k + 1 == size_, out[lane]);
      if (done[lane]) --left;
    }
  }
  if (left > 0) full_matrix(map, out);
}

void Arnoldi::full_matrix(PeriodMap& map, std::span<Dominant> out) {
  if (size_ > options_.largest_matrix) return;
  const Eigen::Index n = static_cast<Eigen::Index>(size_);
  std::array<Eigen::MatrixXd, lane_count> matrix;
  std::vector<Lanes> in(size_, Lanes{}), column(size_);
  for (std::size_t j = 0; j < size_; ++j) {
    for (double& lane : in[j].v) lane = 1.0;
    map.apply(in.data(), column.data());
    in[j] = Lanes{};
    for (std::size_t lane = 0; lane < out.size(); ++lane) {
      if (out[lane].by == Dominant::By::arnoldi) continue;
      matrix[lane].resize(n, n);
      for (std::size_t i = 0; i < size_; ++i) {
        matrix[lane](static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = column[i].v[lane];
      }
    }
  }
  for (std::size_t lane = 0; lane < out.size(); ++lane) {
    if (out[lane].by == Dominant::By::arnoldi) continue;
    if (!matrix[lane].allFinite()) continue;
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix[lane], true);
    if (solver.info() != Eigen::Success) continue;
    Eigen::Index best = 0;
    solver.eigenvalues().cwiseAbs().maxCoeff(&best);
    const std::complex<double> value = solver.eigenvalues()(best);
    const Eigen::VectorXcd vector = solver.eigenvectors().col(best);
    full_[lane] = value.imag() < 0.0 ? vector.conjugate().eval() : vector;
    full_[lane].normalize();
    out[lane].multiplier = upper_half(value);
    out[lane].residual = (matrix[lane] * full_[lane] - out[lane].multiplier * full_[lane]).norm();
    out[lane].iterations += static_cast<int>(size_);
    out[lane].by = Dominant::By::full_matrix;
  }
}

Eigen::VectorXcd Arnoldi::vector(std::size_t lane) {
  if (full_[lane].size() > 0) return full_[lane];
  Eigen::VectorXcd x = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(size_));
  for (std::size_t j = 0; j < ritz_[lane].size(); ++j) {
    const Lanes* v = basis_.data() + j * size_;
    for (std::size_t i = 0; i < size_; ++i) x(static_cast<Eigen::Index>(i)) += ritz_[lane][j] * v[i].v[lane];
  }
  return x;
}

}  // namespace robomill::stability::detail
