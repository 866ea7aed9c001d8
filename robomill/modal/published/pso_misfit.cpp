#include "robomill/modal/published/pso_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <numbers>

namespace robomill::modal::detail {
namespace {

constexpr std::size_t lanes = 4;
// Four doubles that the compiler maps to what the processor has; arithmetic lane by lane rounds the same in both
// variants.
using Lanes __attribute__((vector_size(lanes * sizeof(double)))) = double;

constexpr std::size_t block_lines = 256;  // one block's squares stay in the first-level cache
static_assert(block_lines % lanes == 0);

/// What one pass needs of a mode, for up to two FRFs.
struct ModeFraction {
  double stiffness, damping_squared;  // ω_k², (2 ζ ω_k)²
  double real_constant[2], real_slope[2], imag_constant[2], imag_slope[2];
};

/// Pointers to the lines of one block.
struct FrfLines {
  const double* omega;
  const double* omega_squared;
  const double* real[2];
  const double* imag[2];
  const double* inverse_square[2];
};

// Copies, since neither the arrays nor the blocks of lines are aligned to whole vectors; the compiler makes a load of
// them.
inline __attribute__((always_inline)) void load(Lanes& to, const double* from) {
  std::memcpy(&to, from, sizeof(Lanes));
}
inline __attribute__((always_inline)) void store(double* to, const Lanes& from) {
  std::memcpy(to, &from, sizeof(Lanes));
}

/// squares[f][i] = |H_fit - H|² / |H|² for `frfs` FRFs and lines [0, count), count a multiple of `lanes`.
template <std::size_t frfs>
inline __attribute__((always_inline)) void relative_squares(std::span<const ModeFraction> modes, const FrfLines& lines,
                                                            std::size_t count, double* const* squares) {
  for (std::size_t i = 0; i < count; i += lanes) {
    Lanes u;
    load(u, lines.omega_squared + i);
    Lanes real[frfs] = {};
    Lanes imag[frfs] = {};
    for (const ModeFraction& mode : modes) {
      const Lanes p = mode.stiffness - u;
      const Lanes inverse = 1.0 / (p * p + mode.damping_squared * u);
      for (std::size_t f = 0; f < frfs; ++f) {
        real[f] += (mode.real_constant[f] + mode.real_slope[f] * u) * inverse;
        imag[f] += (mode.imag_constant[f] + mode.imag_slope[f] * u) * inverse;
      }
    }
    Lanes omega;
    load(omega, lines.omega + i);
    for (std::size_t f = 0; f < frfs; ++f) {
      Lanes real_target;
      Lanes imag_target;
      Lanes inverse_square;
      load(real_target, lines.real[f] + i);
      load(imag_target, lines.imag[f] + i);
      load(inverse_square, lines.inverse_square[f] + i);
      const Lanes real_error = real[f] - real_target;
      const Lanes imag_error = omega * imag[f] - imag_target;
      const Lanes square = (real_error * real_error + imag_error * imag_error) * inverse_square;
      store(squares[f] + i, square);
    }
  }
}

template <std::size_t frfs>
void relative_squares_baseline(std::span<const ModeFraction> modes, const FrfLines& lines, std::size_t count,
                               double* const* squares) {
  relative_squares<frfs>(modes, lines, count, squares);
}

template <std::size_t frfs>
__attribute__((target("avx2"))) void relative_squares_avx2(std::span<const ModeFraction> modes, const FrfLines& lines,
                                                           std::size_t count, double* const* squares) {
  relative_squares<frfs>(modes, lines, count, squares);
}

std::size_t whole_vectors(std::size_t lines) {
  return (lines + lanes - 1) / lanes * lanes;
}

}  // namespace

bool supports(Simd simd) {
  return simd != Simd::avx2 || __builtin_cpu_supports("avx2") != 0;
}

Misfit::Misfit(const Eigen::VectorXd& frequency_hz, std::span<const Frf* const> frfs, Simd simd)
    : avx2_(simd != Simd::baseline && supports(Simd::avx2)) {
  const std::size_t lines = static_cast<std::size_t>(frequency_hz.size());
  const std::size_t padded = whole_vectors(lines);
  scale_ = 2.0 * std::numbers::pi * frequency_hz(frequency_hz.size() - 1);
  omega_.assign(padded, 1.0);
  omega_squared_.assign(padded, 1.0);
  for (std::size_t i = 0; i < lines; ++i) {
    omega_[i] = 2.0 * std::numbers::pi * frequency_hz(static_cast<Eigen::Index>(i)) / scale_;
    omega_squared_[i] = omega_[i] * omega_[i];
  }
  for (const Frf* frf : frfs) {
    Target target{.real = std::vector<double>(padded, 0.0),
                  .imag = std::vector<double>(padded, 0.0),
                  .inverse_square = std::vector<double>(padded, 0.0)};
    for (std::size_t i = 0; i < lines; ++i) {
      const std::complex<double> value = frf->receptance(static_cast<Eigen::Index>(i));
      target.real[i] = value.real();
      target.imag[i] = value.imag();
      const double inverse_square = 1.0 / std::norm(value);
      if (!std::isfinite(inverse_square)) continue;
      target.inverse_square[i] = inverse_square;
      ++terms_;
    }
    targets_.push_back(std::move(target));
  }
}

double Misfit::operator()(std::span<const MisfitMode> modes) const {
  std::vector<ModeFraction> fractions(modes.size());
  double sum = 0.0;
  for (std::size_t first = 0; first < targets_.size(); first += 2) {
    const std::size_t count = std::min<std::size_t>(2, targets_.size() - first);
    for (std::size_t k = 0; k < modes.size(); ++k) {
      const double omega = 2.0 * std::numbers::pi * modes[k].frequency_hz / scale_;
      const double decay = modes[k].damping_ratio * omega;
      const std::complex<double> lambda(-decay, std::sqrt(std::max(0.0, omega * omega - decay * decay)));
      ModeFraction& fraction = fractions[k];
      fraction.stiffness = omega * omega;
      fraction.damping_squared = 4.0 * decay * decay;
      for (std::size_t f = 0; f < count; ++f) {
        // (a + iω b) / (p + 2 i decay ω), both poles' terms on one denominator, times its conjugate.
        const std::complex<double> residue = modes[k].residues[first + f] / scale_;
        const double a = -2.0 * (residue * std::conj(lambda)).real();
        const double b = 2.0 * residue.real();
        fraction.real_constant[f] = a * fraction.stiffness;
        fraction.real_slope[f] = 2.0 * b * decay - a;
        fraction.imag_constant[f] = b * fraction.stiffness - 2.0 * a * decay;
        fraction.imag_slope[f] = -b;
      }
    }
    double squares[2][block_lines];
    double* const rows[2] = {squares[0], squares[1]};
    for (std::size_t start = 0; start < omega_.size(); start += block_lines) {
      const std::size_t length = std::min(block_lines, omega_.size() - start);
      FrfLines lines{.omega = omega_.data() + start,
                     .omega_squared = omega_squared_.data() + start,
                     .real = {},
                     .imag = {},
                     .inverse_square = {}};
      for (std::size_t f = 0; f < count; ++f) {
        lines.real[f] = targets_[first + f].real.data() + start;
        lines.imag[f] = targets_[first + f].imag.data() + start;
        lines.inverse_square[f] = targets_[first + f].inverse_square.data() + start;
      }
      if (count == 2) {
        (avx2_ ? relative_squares_avx2<2> : relative_squares_baseline<2>)(fractions, lines, length, rows);
      } else {
        (avx2_ ? relative_squares_avx2<1> : relative_squares_baseline<1>)(fractions, lines, length, rows);
      }
      for (std::size_t f = 0; f < count; ++f) {
        sum += Eigen::Map<const Eigen::ArrayXd>(squares[f], static_cast<Eigen::Index>(length)).sqrt().sum();
      }
    }
  }
  return terms_ == 0 ? 0.0 : sum / static_cast<double>(terms_);
}

}  // namespace robomill::modal::detail
