#include "robomill/simulation/modal_step.hpp"

#include <cmath>
#include <complex>

namespace robomill::simulation::detail {
namespace {

using Complex = std::complex<double>;

/// φ1 = (e^x - 1)/x and φ2 = (e^x - 1 - x)/x²; by their series where the quotients would cancel.
struct Weights {
  Complex one, two;
};

Weights weights(Complex x) {
  if (std::abs(x) < 0.5) {
    Complex term = 1.0;  // x^k / k!
    Complex one = 0.0, two = 0.0;
    for (int k = 0; k < 20; ++k) {
      one += term / (k + 1.0);
      two += term / ((k + 1.0) * (k + 2.0));
      term *= x / (k + 1.0);
    }
    return {one, two};
  }
  const Complex one = (std::exp(x) - 1.0) / x;
  return {one, (one - 1.0) / x};
}

}  // namespace

template <int D>
ModalStep<D>::ModalStep(const modal::TipModes& modes, double step_s) {
  const Eigen::Index n = modes.pole.size();
  modes_.resize(static_cast<std::size_t>(n));
  re_.assign(modes_.size(), 0.0);
  im_.assign(modes_.size(), 0.0);
  gain_start_.setZero();
  gain_end_.setZero();
  for (Eigen::Index k = 0; k < n; ++k) {
    Mode& mode = modes_[static_cast<std::size_t>(k)];
    const Complex x = modes.pole(k) * step_s;
    const Weights w = weights(x);
    const Complex decay = std::exp(x);
    mode.decay_re = decay.real();
    mode.decay_im = decay.imag();
    const Eigen::Matrix<Complex, D, 1> right = 2.0 * modes.right.col(k).template head<D>();
    const Eigen::Matrix<Complex, D, 1> left = modes.left.col(k).template head<D>();
    const Eigen::Matrix<Complex, D, 1> start = left * (step_s * (w.one - w.two));
    const Eigen::Matrix<Complex, D, 1> end = left * (step_s * w.two);
    mode.right_re = right.real();
    mode.right_im = -right.imag();
    mode.start_re = start.real();
    mode.start_im = start.imag();
    mode.end_re = end.real();
    mode.end_im = end.imag();
    gain_start_ += (right * start.transpose()).real();
    gain_end_ += (right * end.transpose()).real();
  }
}

template <int D>
Vector<D> ModalStep<D>::free_motion() {
  Vector<D> q = Vector<D>::Zero();
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    const Mode& mode = modes_[k];
    const double re = mode.decay_re * re_[k] - mode.decay_im * im_[k];
    const double im = mode.decay_re * im_[k] + mode.decay_im * re_[k];
    re_[k] = re;
    im_[k] = im;
    q += mode.right_re * re + mode.right_im * im;
  }
  return q;
}

template <int D>
void ModalStep<D>::finish(const Vector<D>& start_n, const Vector<D>& end_n) {
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    const Mode& mode = modes_[k];
    re_[k] += mode.start_re.dot(start_n) + mode.end_re.dot(end_n);
    im_[k] += mode.start_im.dot(start_n) + mode.end_im.dot(end_n);
  }
}

template <int D>
Vector<D> ModalStep<D>::displacement() const {
  Vector<D> q = Vector<D>::Zero();
  for (std::size_t k = 0; k < modes_.size(); ++k) q += modes_[k].right_re * re_[k] + modes_[k].right_im * im_[k];
  return q;
}

template <int D>
void ModalStep<D>::set(std::size_t mode, Complex value) {
  re_[mode] = value.real();
  im_[mode] = value.imag();
}

template <int D>
void ModalStep<D>::scale(double factor) {
  for (double& x : re_) x *= factor;
  for (double& x : im_) x *= factor;
}

template class ModalStep<2>;
template class ModalStep<3>;

}  // namespace robomill::simulation::detail
