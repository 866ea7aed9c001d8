#pragma once
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

/// Takes what repeats with the spindle out of one channel: r(t) = x(t) - Re Σ_k a_k exp(i k θ(t)), k = 1 … harmonics,
/// θ the spindle's angle. The amplitudes follow by stochastic gradient, block by block,
///   a_k += gain 2/n Σ_t r(t) exp(-i k θ(t)),
/// so that r is what the past did not predict. Over a revolution the harmonics are orthogonal: a gain of n/(samples a
/// revolution) takes over the last revolution whole, one of 1 - exp(-n/τ) forgets with the time constant τ and leaves a
/// notch of half width 1/(2πτ) at each harmonic. Nothing is allocated after construction.
class Comb {
 public:
  explicit Comb(std::size_t max_harmonics);

  /// How many harmonics take part from now on; new ones start from zero. At most max_harmonics.
  void set_harmonics(std::size_t count) noexcept;
  [[nodiscard]] std::size_t harmonics() const noexcept { return count_; }

  /// One block at constant speed: fills residual (as long as x). Of it, no more than `bound` a sample is learnt.
  /// @param angle  θ of the first sample [rad];  @param turn  between samples [rad]
  void run(std::span<const float> x, std::span<float> residual, double angle, double turn, double gain,
           double bound) noexcept;

  [[nodiscard]] std::complex<double> amplitude(std::size_t k) const noexcept;  ///< a_k, k from 1
  /// Of the last block: 2/n Σ r exp(-i k θ), before the gain.
  [[nodiscard]] std::complex<double> innovation(std::size_t k) const noexcept;
  /// Adds to a_k.
  void correct(std::size_t k, std::complex<double> by) noexcept;
  void reset() noexcept;

 private:
  typedef float Vector __attribute__((vector_size(32)));
  struct Group {
    Vector v = {};
  };
  static constexpr std::size_t width = 8;

  std::size_t count_ = 0, groups_ = 0, max_ = 0;
  // Of width harmonics each.
  std::vector<Group> a_re_, a_im_, w_re_, w_im_, s_re_, s_im_, g_re_, g_im_;
  double scale_ = 0.0;
};

}  // namespace robomill::monitor
