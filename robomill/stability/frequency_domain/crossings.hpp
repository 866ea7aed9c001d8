#pragma once
#include <Eigen/Core>
#include <complex>
#include <functional>
#include <vector>

namespace robomill::stability::detail {

/// Fills a square matrix A(ω).
using MatrixAt = std::function<void(double frequency, Eigen::MatrixXcd& out)>;

/// Where an eigenvalue of A(ω) is real and positive: det(I - a A(ω)) = 0 at a = 1 / eigenvalue.
struct GainCrossing {
  double frequency = 0.0;
  double gain = 0.0;   ///< a
  bool opens = false;  ///< one more root s = iω has a real part > 0 above a than below
  enum class At { inside, from, to } at = At::inside;
};

/// The part of the frequency axis to look at.
struct Sweep {
  double from = 0.0, to = 0.0;
  std::vector<double> nodes = {};           ///< where to begin to look, between them, in any order
  double largest_gain = 0.0;                ///< eigenvalues whose inverse is beyond it do not count
  bool real_from = false, real_to = false;  ///< A has conjugate eigenvalues at that end: real ones cross there
};

/// All crossings, by gain. The eigenvalues are followed from node to node; an interval is halved until each eigenvalue
/// that counts moves in it nearly along a parabola, so that none crosses unseen but two that cross and come back within
/// a fraction of the interval's motion. Crossings are found by regula falsi.
[[nodiscard]] std::vector<GainCrossing> find_crossings(const MatrixAt& matrix, const Sweep& sweep);

/// The crossing that continues one of a slightly different matrix; gain 0 where there is none near it.
[[nodiscard]] GainCrossing follow(const MatrixAt& matrix, const GainCrossing& from);

/// Eigenvalue nearest to guess and its vector, ‖x‖ = 1.
std::complex<double> nearest_eigenvalue(const Eigen::MatrixXcd& matrix, std::complex<double> guess,
                                        Eigen::VectorXcd& vector);

}  // namespace robomill::stability::detail
