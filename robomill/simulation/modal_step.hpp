#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include "robomill/modal/tip.hpp"

namespace robomill::simulation::detail {

/// D = 2: x, y; D = 3: x, y, z.
template <int D>
using Vector = Eigen::Matrix<double, D, 1>;
template <int D>
using Square = Eigen::Matrix<double, D, D>;

/// dz_k/dt = λ_k z_k + L_k^T F, q = 2 Re Σ R_k z_k, advanced exactly over a step of length h in which F runs linearly
/// from A to B: z(h) = e^{λh} z(0) + h (φ1 - φ2) L^T A + h φ2 L^T B, φ1 = (e^x - 1)/x, φ2 = (e^x - 1 - x)/x², x = λh.
/// q at its end is free_motion() + gain_start() A + gain_end() B, so that A and B may depend on it.
template <int D>
class ModalStep {
 public:
  ModalStep(const modal::TipModes& modes, double step_s);

  /// Lets the state move on by one step without force and returns its displacement [m].
  Vector<D> free_motion();
  /// Adds what the force of this step did.
  void finish(const Vector<D>& start_n, const Vector<D>& end_n);

  [[nodiscard]] const Square<D>& gain_start() const { return gain_start_; }  ///< [m/N]
  [[nodiscard]] const Square<D>& gain_end() const { return gain_end_; }      ///< [m/N]
  [[nodiscard]] Vector<D> displacement() const;
  [[nodiscard]] std::size_t size() const { return re_.size(); }
  void set(std::size_t mode, std::complex<double> value);
  [[nodiscard]] std::complex<double> get(std::size_t mode) const { return {re_[mode], im_[mode]}; }
  void scale(double factor);

 private:
  struct Mode {
    double decay_re = 0.0, decay_im = 0.0;         ///< e^{λh}
    Vector<D> right_re, right_im;                  ///< 2 Re R, -2 Im R
    Vector<D> start_re, start_im, end_re, end_im;  ///< weights times left
  };
  std::vector<Mode> modes_;
  std::vector<double> re_, im_;
  Square<D> gain_start_, gain_end_;
};

extern template class ModalStep<2>;
extern template class ModalStep<3>;

}  // namespace robomill::simulation::detail
