#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace robomill::simulation::detail {

/// Takes a motion and a force at fine, even steps and gives them at the output rate, band-limited: pass band to 0.44,
/// stop band from 0.56 of the output rate, so that what folds back stays above the pass band. Acceleration is the
/// second derivative of the band-limited motion.
///
/// The kernel is a sinc under Nuttall's four-term window with continuous first derivative [Nuttall1981], tabled at
/// fractions of a fine step and interpolated between them; the second derivative's kernel is its own, in closed form.
class Resampler {
 public:
  /// Before its first sample a signal counts as zero.
  /// @param rows  outputs wanted, at i / rate_hz; at least four fine steps each
  /// @param directions  2: z is zero and stays so; 3
  Resampler(double step_s, double rate_hz, Eigen::Index rows, int directions = 3);

  /// The sample at time n step_s, n = 0, 1, …: displacement there, mean force over the step that ended there.
  void push(const Eigen::Vector3d& displacement_m, const Eigen::Vector3d& force_n);
  [[nodiscard]] bool done() const { return next_ == displacement_m.rows(); }
  [[nodiscard]] Eigen::Index rows_done() const { return next_; }
  /// Fine samples needed beyond the last output.
  [[nodiscard]] std::size_t reach() const { return static_cast<std::size_t>(half_); }

  Eigen::Matrix<double, Eigen::Dynamic, 3> displacement_m, acceleration_m_per_s2, force_n;  ///< rows x 3

 private:
  struct Kernel {
    std::vector<double> rows;  ///< (fractions + 1) x taps
  };
  void emit();
  void weights(const Kernel& kernel, double fraction, std::vector<double>& out) const;
  [[nodiscard]] const double* channel(std::size_t c) const { return history_.data() + c * capacity_; }

  double step_s_, rate_hz_;
  std::size_t directions_;
  int half_ = 0;
  std::size_t taps_ = 0, fractions_ = 1, capacity_ = 0, filled_ = 0;
  long long first_ = 0;  ///< number of the fine sample that stands first in the history
  Eigen::Index next_ = 0;
  Kernel value_, second_;
  std::vector<double> history_;  ///< 6 channels x capacity
  std::vector<double> value_weights_, second_weights_, force_weights_;
};

}  // namespace robomill::simulation::detail
