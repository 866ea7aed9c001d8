#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/modal/frf.hpp"

namespace robomill::modal::detail {

/// Instructions that the misfit is computed with; both variants give the same bits.
enum class Simd { automatic, baseline, avx2 };
/// Whether this processor has them.
[[nodiscard]] bool supports(Simd simd);

/// One conjugate pair of poles with its residues r_i, as the misfit wants them.
/// Both poles' terms together are real-coefficient fractions: with u = ω², p = ω_k² - u and d = p² + (2 ζ ω_k)² u,
/// Re H_i = (real_constant_i + real_slope_i u) / d and Im H_i = ω (imag_constant_i + imag_slope_i u) / d.
struct MisfitMode {
  double frequency_hz = 0.0;                       ///< > 0
  double damping_ratio = 0.0;                      ///< in (0, 1)
  std::span<const std::complex<double>> residues;  ///< length Misfit::frfs()
};

/// The mean over lines and FRFs of |H_fit - H| / |H|. Lines where H = 0 are left out.
class Misfit {
 public:
  /// @param frfs  what to fit, each of the length of frequency_hz
  Misfit(const Eigen::VectorXd& frequency_hz, std::span<const Frf* const> frfs, Simd simd = Simd::automatic);

  [[nodiscard]] std::size_t frfs() const { return targets_.size(); }
  /// How many pairs of line and FRF count.
  [[nodiscard]] std::size_t terms() const { return terms_; }
  /// May be called from many threads at once.
  [[nodiscard]] double operator()(std::span<const MisfitMode> modes) const;

 private:
  /// Lines in the order of the axis, filled up to whole vectors with lines of no weight.
  struct Target {
    std::vector<double> real, imag, inverse_square;  ///< H and 1 / |H|²
  };
  std::vector<double> omega_, omega_squared_;  ///< in units of scale_
  std::vector<Target> targets_;
  double scale_ = 1.0;  ///< rad/s, so that all numbers are near one
  std::size_t terms_ = 0;
  bool avx2_ = false;
};

}  // namespace robomill::modal::detail
