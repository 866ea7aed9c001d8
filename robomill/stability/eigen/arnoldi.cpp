#include "robomill/stability/eigen/arnoldi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "robomill/stability/eigen/kernels.hpp"

namespace robomill::stability::detail {
namespace {

constexpr std::size_t first_extra = 9;     // columns beyond 2n at the first look
constexpr std::size_t first_warm = 16;     // … after a warm-up
constexpr std::size_t first_guessed = 15;  // … from a guess
constexpr std::size_t most_rounds = 3;     // of warming up
constexpr double guess_is_off = 1e-6;

std::size_t first_look(const PeriodMap& map, bool guessed) {
  const std::size_t cold = map.modal_size() + first_extra;
  return guessed ? std::min(cold, std::max(first_guessed, map.modal_size() / 2)) : cold;
}

std::complex<double> upper_half(std::complex<double> value) {
  return {value.real(), std::abs(value.imag())};
}

}  // namespace

double spectral_radius(const Dominant& dominant) {
  const double modulus = std::abs(dominant.multiplier);
  return std::isfinite(modulus) && modulus < 1e100 ? modulus : 1e100;
}

/// The same vector in all lanes, or what is guessed and a little of that: what a guess lacks must not stay away.
void Arnoldi::start(std::span<const Lanes> guess) {
  if (start_.size() < size_) {
    Random random(20040101);
    start_.clear();
    for (std::size_t i = 0; i < size_; ++i) start_.push_back(random.uniform(-1.0, 1.0));
  }
  double square = 0.0;
  for (std::size_t i = 0; i < size_; ++i) square += start_[i] * start_[i];
  double scale = 1.0 / std::sqrt(square);
  if (!guess.empty()) {
    NormaliseArguments a;
    a.size = size_;
    a.from = guess.data();
    a.to = basis_.data();
    std::fill_n(basis_.data(), size_, Lanes{});
    normalise(a);
    scale *= guess_is_off;
  }
  for (std::size_t i = 0; i < size_; ++i) {
    for (double& lane : basis_[i].v) lane = (guess.empty() ? 0.0 : lane) + start_[i] * scale;
  }
  if (guess.empty()) return;
  NormaliseArguments a;
  a.size = size_;
  a.from = a.to = basis_.data();
  normalise(a);
}

/// Whether a start vector that went through many periods and few columns cost less than many columns.
bool Arnoldi::pays_to_warm_up(const PeriodMap& map, bool guessed) const {
  if (options_.full_matrix_only) return false;
  // Of many modes that fade alike the columns of a cold start may miss the one that fades least.
  if (!guessed && map.modal_size() > 2 * options_.most_cold_modes) return true;
  if (map.work() == 0.0) return false;
  const auto cost = [&](std::size_t passes, std::size_t count) {
    const double columns = static_cast<double>(count);
    return static_cast<double>(passes + count) * map.work() +
           columns * columns * (1.5 * static_cast<double>(size_) + 4.0 * columns);
  };
  const std::size_t whole = map.modal_size() + first_extra;
  const std::size_t cold = std::min({size_, whole, 2 * first_look(map, guessed)});
  return cost(passes(map, guessed), std::max(first_warm, cold / 2)) < cost(0, cold);
}

/// How many periods a column goes through: as many as cost what it costs beside. More in a later round, which has to
/// tell apart motions that fade alike.
int Arnoldi::periods(const PeriodMap& map, std::size_t round) const {
  constexpr double columns = first_warm;
  if (map.work() == 0.0) return 1;
  const double beside = columns * (1.5 * static_cast<double>(size_) + 5.0 * columns);
  return static_cast<int>(std::clamp(beside / map.work(), 1.0, 8.0)) << (3 * round);
}

std::size_t Arnoldi::passes(const PeriodMap& map, bool guessed) {
  const std::size_t all = std::max<std::size_t>(64, 4 * map.modal_size());
  return guessed ? all / 4 : all;
}

/// Takes the start vector over many periods, normed each time.
void Arnoldi::warm_up(PeriodMap& map, std::size_t passes) {
  Lanes* x = basis_.data();
  Lanes* next = basis_.data() + size_;
  for (std::size_t pass = 0; pass < passes; ++pass) {
    map.apply(x, next);
    NormaliseArguments a;  // a motion that overflows or vanishes within a period starts as it is
    a.size = size_;
    a.from = next;
    a.to = x;
    normalise(a);
  }
}

/// Starts again from what is known: the dominant Ritz vector and a little of the vector before.
void Arnoldi::start_again(std::span<const bool> done, std::span<const Dominant> out) {
  constexpr double little = 1e-2;
  for (std::size_t lane = 0; lane < out.size(); ++lane) {
    if (done[lane] && full_[lane].size() == 0) full_[lane] = vector(lane);
    if (done[lane] || !std::isfinite(out[lane].multiplier.real())) continue;
    const Eigen::VectorXcd ritz = vector(lane);
    const Eigen::VectorXd motion = ritz.real() + ritz.imag();
    for (std::size_t i = 0; i < size_; ++i) {
      double& entry = basis_[i].v[lane];
      entry = motion(static_cast<Eigen::Index>(i)) + little * entry;
    }
  }
}

/// Looks at the dominant Ritz pairs of the lanes that are not done, in the first columns of the basis.
void Arnoldi::look(PeriodMap& map, std::size_t columns, std::span<bool> done, std::span<Dominant> out) {
  std::array<bool, lane_count> fresh = {};
  for (std::size_t lane = 0; lane < out.size(); ++lane) fresh[lane] = !done[lane];
  std::array<std::complex<double>, lane_count> value = {};
  const std::array<bool, lane_count> found = ritz_values(columns, fresh, value);
  for (std::size_t lane = 0; lane < out.size(); ++lane) {
    if (done[lane]) continue;
    // What is not finite overflows within a period.
    out[lane].multiplier = found[lane] ? value[lane] : std::numeric_limits<double>::infinity();
    done[lane] = found[lane] && converged(lane, columns, out[lane]);
    fresh[lane] = done[lane];
  }
  if (periods_ > 1) confirm(map, fresh, done, out);
}

/// Eight matrices at once cost as much as two one after the other.
std::array<bool, lane_count> Arnoldi::ritz_values(std::size_t columns, const std::array<bool, lane_count>& wanted,
                                                  std::array<std::complex<double>, lane_count>& value) {
  if (std::ranges::count(wanted, true) <= 2) {
    std::array<bool, lane_count> found = {};
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      if (!wanted[lane]) continue;
      take_small(lane, columns);
      found[lane] = small_.dominant(value[lane]);
    }
    return found;
  }
  ritz_values_.resize(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const Lanes* column = hessenberg_.data() + c * (most_ + 1);
    for (std::size_t r = 0; r < std::min(columns, c + 2); ++r) ritz_values_(r, c) = column[r];
  }
  return ritz_values_.dominant(wanted, value);
}

void Arnoldi::take_small(std::size_t lane, std::size_t columns) {
  small_.resize(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const Lanes* column = hessenberg_.data() + c * (most_ + 1);
    for (std::size_t r = 0; r < std::min(columns, c + 2); ++r) small_(r, c) = column[r].v[lane];
  }
}

/// A Ritz pair of several periods: the root that its vector shows in a single one. Where two motions have the same
/// multiplier after several periods the vector is none of one period, and the lane is not done.
void Arnoldi::confirm(PeriodMap& map, const std::array<bool, lane_count>& fresh, std::span<bool> done,
                      std::span<Dominant> out) {
  constexpr double least = 1e-9;  // residual that rounding may leave
  if (std::ranges::find(fresh, true) == fresh.end()) return;
  side_.assign(4 * size_, Lanes{});
  Lanes* const real = side_.data();
  Lanes* const imaginary = real + size_;
  for (std::size_t lane = 0; lane < out.size(); ++lane) {
    if (!fresh[lane]) continue;
    full_[lane].resize(0);
    full_[lane] = vector(lane);
    for (std::size_t i = 0; i < size_; ++i) {
      real[i].v[lane] = full_[lane](static_cast<Eigen::Index>(i)).real();
      imaginary[i].v[lane] = full_[lane](static_cast<Eigen::Index>(i)).imag();
    }
  }
  Lanes* const after_real = imaginary + size_;
  Lanes* const after_imaginary = after_real + size_;
  map.apply(real, after_real);
  map.apply(imaginary, after_imaginary);
  for (std::size_t lane = 0; lane < out.size(); ++lane) {
    if (!fresh[lane]) continue;
    std::complex<double> quotient = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < size_; ++i) {
      const std::complex<double> x(real[i].v[lane], imaginary[i].v[lane]);
      quotient += std::conj(x) * std::complex<double>(after_real[i].v[lane], after_imaginary[i].v[lane]);
      square += std::norm(x);
    }
    quotient /= square;
    const double modulus = std::pow(std::abs(out[lane].multiplier), 1.0 / periods_);
    const double phase = std::arg(out[lane].multiplier) / periods_;
    const double turn = 2.0 * std::numbers::pi / periods_;
    const std::complex<double> root =
        std::polar(modulus, phase + turn * std::round((std::arg(quotient) - phase) / turn));
    double rest = 0.0;
    for (std::size_t i = 0; i < size_; ++i) {
      const std::complex<double> x(real[i].v[lane], imaginary[i].v[lane]);
      rest += std::norm(std::complex<double>(after_real[i].v[lane], after_imaginary[i].v[lane]) - root * x);
    }
    out[lane].residual = std::sqrt(rest / square);
    done[lane] = out[lane].residual <= std::max(least, 1e3 * tolerance_) * (1.0 + std::abs(root));
    if (!done[lane]) {
      full_[lane].resize(0);
      out[lane].by = Dominant::By::unsettled;
      continue;
    }
    out[lane].multiplier = upper_half(root);
    if (root.imag() < 0.0) full_[lane] = full_[lane].conjugate().eval();
  }
}

bool Arnoldi::converged(std::size_t lane, std::size_t columns, Dominant& out) {
  take_small(lane, columns);
  ritz_[lane] = small_.vector(out.multiplier);
  const double next = hessenberg_[(columns - 1) * (most_ + 1) + columns].v[lane];
  out.residual = columns == size_ ? 0.0 : next * std::abs(ritz_[lane].back());
  if (!(out.residual <= tolerance_ * (std::abs(out.multiplier) + 0.1 * small_.norm()))) return false;
  out.by = Dominant::By::arnoldi;
  return true;
}

void Arnoldi::find(PeriodMap& map, std::span<Dominant> out, std::span<const Lanes> guess, double tolerance) {
  tolerance_ = tolerance;
  size_ = map.size();
  most_ = std::min(size_, map.modal_size() + options_.extra);
  basis_.reserve((most_ + 1) * size_);
  hessenberg_.reserve((most_ + 1) * most_);
  make_room(1);
  std::ranges::fill(out, Dominant{});
  for (auto& vector : full_) vector.resize(0);
  for (auto& vector : ritz_) vector.clear();
  start(guess);
  std::array<bool, lane_count> done = {};
  const std::span<bool> undone = std::span(done).first(out.size());
  const auto is_left = [&] { return std::ranges::find(undone, false) != undone.end(); };
  const bool guessed = !guess.empty();
  const bool warm = pays_to_warm_up(map, guessed);
  const std::size_t first = warm ? first_warm : first_look(map, guessed);
  const bool again = warm && periods(map, 0) > 1;  // passes are cheap
  const std::size_t rounds = options_.full_matrix_only ? 0 : again ? most_rounds : 1;
  for (std::size_t round = 0; round < rounds && is_left(); ++round) {
    if (round > 0) start_again(undone, out);
    if (warm) warm_up(map, passes(map, guessed && round == 0));
    const bool last = round + 1 == rounds;
    periods_ = last ? 1 : periods(map, round);
    extend(map, std::min(most_, first), last ? most_ : std::min(most_, first + (1 + round) * first / 2), undone, out);
  }
  if (is_left()) full_matrix(map, out);
}

/// What was reserved is not touched before a column needs it: few of the most are.
void Arnoldi::make_room(std::size_t columns) {
  basis_.resize(std::max(basis_.size(), (columns + 1) * size_));
  hessenberg_.resize(std::max(hessenberg_.size(), columns * (most_ + 1)));
}

/// Columns up to `most`, looked at from the first look on, after half as many again up to those of a cold start.
void Arnoldi::extend(PeriodMap& map, std::size_t first, std::size_t most, std::span<bool> done,
                     std::span<Dominant> out) {
  OrthogonalArguments arguments;
  arguments.size = size_;
  std::size_t next_look = first;
  for (std::size_t k = 0; k < most && std::ranges::find(done, false) != done.end(); ++k) {
    make_room(k + 1);
    arguments.basis = basis_.data();
    Lanes* const next = basis_.data() + (k + 1) * size_;
    map.apply(basis_.data() + k * size_, next);
    for (int period = 1; period < periods_; ++period) {
      side_.assign(next, next + size_);
      map.apply(side_.data(), next);
    }
    arguments.column = k;
    arguments.coefficients = hessenberg_.data() + k * (most_ + 1);
    orthogonalise(arguments);
    if (k + 1 != next_look) continue;
    const std::size_t whole = map.modal_size() + first_extra;  // from here on every few columns
    const std::size_t few = std::max(options_.between, map.modal_size() / 8);
    const std::size_t further = next_look < whole ? std::min(next_look + next_look / 2, whole) : next_look + few;
    next_look = std::min(most, further);
    look(map, k + 1, done, out);
  }
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
    const linear_algebra::EigenPairs pairs = linear_algebra::eigen_pairs(matrix[lane]);
    if (!pairs.converged) continue;
    Eigen::Index best = 0;
    pairs.values.cwiseAbs().maxCoeff(&best);
    const std::complex<double> value = pairs.values(best);
    const Eigen::VectorXcd vector = pairs.vectors.col(best);
    full_[lane] = value.imag() < 0.0 ? vector.conjugate().eval() : vector;
    full_[lane].normalize();
    out[lane].multiplier = upper_half(value);
    out[lane].residual = (matrix[lane] * full_[lane] - out[lane].multiplier * full_[lane]).norm();
    out[lane].by = Dominant::By::full_matrix;
  }
}

/// Zero where no look found a pair.
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
