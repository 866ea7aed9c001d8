#pragma once
#include <Eigen/Core>
#include <complex>
#include <limits>
#include <vector>

#include "robomill/modal/frf.hpp"

// Method: robomill/modal/README.md, "FRFs to modes (`fit.hpp`)"

namespace robomill::modal {

/// One pair of conjugate poles λ = -ζ ω + iω sqrt(1 - ζ²) of a structure that need not be symmetric.
///
/// Only the residue matrix right * left^T is physical; of the freedom left -> c left, right -> right/c we take ‖left‖ =
/// ‖right‖ and left's largest component real and positive.
struct Mode {
  double frequency_hz = 0.0;   ///< ω / 2π, undamped natural frequency [Hz], > 0
  double damping_ratio = 0.0;  ///< ζ, in (0, 1)
  Eigen::VectorXcd left;       ///< length of ModalModel::excitations [sqrt(s/kg)]
  Eigen::VectorXcd right;      ///< length of ModalModel::responses [sqrt(s/kg)]
  /// Standard deviations, from a fit or a posture model; NaN where unknown.
  double frequency_std_hz = std::numeric_limits<double>::quiet_NaN();
  double damping_ratio_std = std::numeric_limits<double>::quiet_NaN();
  double residue_std_ratio = std::numeric_limits<double>::quiet_NaN();  ///< of the residue matrix's size, relative
  /// Its share of the FRF lies within the FRF's scatter: no warning, advice or name of a vibration rests on it. See
  /// weak_modes.hpp.
  bool weak = false;
};

/// What the modes outside the band leave in it: mass / (-ω²) + stiffness.
struct Residual {
  FrfName name;
  std::complex<double> mass = 0.0;       ///< [1/kg]
  std::complex<double> stiffness = 0.0;  ///< [m/N]
};

/// H_ij(ω) = Σ_k R_ik L_jk / (iω - λ_k) + conj(R_ik L_jk) / (iω - conj λ_k) + residuals.
struct ModalModel {
  std::vector<Dof> excitations;  ///< what the entries of Mode::left belong to
  std::vector<Dof> responses;    ///< what the entries of Mode::right belong to
  std::vector<Mode> modes;
  std::vector<Residual> residuals = {};  ///< empty, or at most one an FRF

  /// @throws InvalidInput naming "modes[k].member" if a shape, frequency, damping ratio or value is wrong (k from 1)
  ROBOMILL_API void validate() const;
};

/// A mode of one direction by its modal mass: x / F = 1 / (m (ω_n² - ω² + 2iζω_nω)).
struct MassMode {
  double frequency_hz = 0.0;   ///< ω_n / 2π [Hz], > 0; required
  double damping_ratio = 0.0;  ///< ζ, in (0, 1); required
  double modal_mass_kg = 0.0;  ///< m [kg], > 0; required
};

/// As entry `axis` of vectors with `axes` entries; its residue 1 / (2i m ω_n sqrt(1 - ζ²)) is shared evenly by both.
[[nodiscard]] ROBOMILL_API Mode mode_from_mass(const MassMode& mode, Eigen::Index axis, Eigen::Index axes);

/// Modes that each move in one direction of the tip. A direction x or y without modes is rigid; the model has z only
/// where that has modes.
/// @throws InvalidInput naming "x[k].member" (k from 1) if a number is out of its range
[[nodiscard]] ROBOMILL_API ModalModel modes_from_mass(const std::vector<MassMode>& x, const std::vector<MassMode>& y,
                                                      const std::vector<MassMode>& z = {});

/// λ = -ζ ω + iω sqrt(1 - ζ²) [rad/s].
[[nodiscard]] ROBOMILL_API std::complex<double> pole(const Mode& mode);

/// Fixes the freedom left -> c left, right -> right / c without changing right * left^T: ‖left‖ = ‖right‖ and left's
/// largest component (the first of equals) real and positive. A mode whose residue is zero gets zero vectors.
/// @throws InvalidInput if a vector is empty or holds a value that is not finite
ROBOMILL_API void normalise(Mode& mode);

/// FRFs of every response and excitation of the model, excitation by excitation (xx, yx, xy, yy), residuals included:
/// H_ij(ω) = Σ_k R_ik L_jk / (iω - λ_k) + conj(R_ik L_jk) / (iω - conj λ_k) - mass_ij / ω² + stiffness_ij.
/// @param frequency_hz  length n, strictly increasing, >= 0 [Hz]; > 0 where a residual has a mass
/// @throws InvalidInput if the model or the frequencies are not valid
[[nodiscard]] ROBOMILL_API FrfSet synthesize(const ModalModel& model, const Eigen::VectorXd& frequency_hz);

}  // namespace robomill::modal
