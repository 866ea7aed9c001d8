#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/base/lanes.hpp"
#include "robomill/modal/posture/flexible_arm.hpp"

namespace robomill::modal::detail {

/// The entries xx, yx, zx, yy, zy, zz of a symmetric 3 x 3 matrix at eight s.
struct SymmetricLanes {
  std::array<Lanes, 6> re, im;
  [[nodiscard]] std::complex<double> at(std::size_t entry, std::size_t lane) const {
    return {re[entry].v[lane], im[entry].v[lane]};
  }
};

/// Smoothed receptances of one posture, up to eight at a time: H(s), or 2 H(s) − H(s + Re s) where Re s > 0, and their
/// derivatives by every parameter.
///
/// K + sC + s²M = L D Lᵀ without pivots: over s its real part σM + C + σ/|s|² K is positive definite (right of the
/// imaginary axis and on it), and so is that of every pivot.
class FlexibleArm::ReceptanceLines {
 public:
  /// @param arm, system  outlive it
  ReceptanceLines(const FlexibleArm& arm, const System& system, bool derivatives);

  /// @param s  1 to 8, Re s >= 0, s != 0; what is in further lanes does not count
  void evaluate(std::span<const std::complex<double>> s);
  [[nodiscard]] const SymmetricLanes& value() const { return value_; }
  /// Of each parameter; empty without derivatives.
  [[nodiscard]] const std::vector<SymmetricLanes>& derivative() const { return derivative_; }

  /// What a parameter changes.
  enum class Change { spring, compliance, rotor, pivot, tool_mass, body_center, body_inertia, body_mass };
  struct Term {
    Change change = Change::spring;
    std::size_t first = 0, count = 0;            ///< coordinates
    std::size_t index = 0;                       ///< of the body or tool
    double factor = 0.0;                         ///< of the rotor
    std::array<double, 9> one = {}, other = {};  ///< spring: stiffness, damping; else a matrix; row by row
  };
  struct Work;  ///< what the kernel works on

 private:
  [[nodiscard]] Term term_of(const FlexibleArm& arm, std::size_t p) const;
  void evaluate(const Lanes& re, const Lanes& im, SymmetricLanes& value, std::vector<SymmetricLanes>& derivative);

  const System& system_;
  std::vector<Term> terms_;
  std::array<double, 6> compliance_ = {};
  std::size_t bracket_row_ = 0;
  std::vector<Lanes> lower_, solution_, bodies_, tools_;
  SymmetricLanes value_ = {}, farther_ = {};
  std::vector<SymmetricLanes> derivative_, farther_derivative_;
};

}  // namespace robomill::modal::detail
