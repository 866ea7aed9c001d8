#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "robomill/stability/eigen/hessenberg.hpp"
#include "robomill/stability/eigen/hessenberg_lanes.hpp"
#include "robomill/stability/eigen/period_map.hpp"

namespace robomill::stability::detail {

/// The multiplier of greatest modulus.
struct Dominant {
  std::complex<double> multiplier = 0.0;  ///< imaginary part >= 0; infinite where the motion overflows within a period
  double residual = 0.0;                  ///< ‖Φ x - μ x‖ with ‖x‖ = 1
  enum class By { arnoldi, full_matrix, unsettled } by = By::unsettled;
};

/// |multiplier|; where the motion overflows in a single period, 1e100.
double spectral_radius(const Dominant& dominant);

struct ArnoldiOptions {
  double tolerance = 1e-12;  ///< converged where the residual is at most this times (|μ| + 0.1 ‖H‖)
  std::size_t between = 4;   ///< vectors from look to look, at least
  /// More modes than this are warmed up whatever it costs: what fades quicker than the dominant motion is gone before
  /// the first vector.
  std::size_t most_cold_modes = 10;
  std::size_t extra = 72;             ///< vectors beyond 2n before the matrix is formed
  std::size_t largest_matrix = 1200;  ///< beyond this the matrix is not formed
  bool full_matrix_only = false;      ///< for tests
};

/// Arnoldi's iteration from one start vector for the eight lanes of a PeriodMap at once. A lane is done when the
/// residual of its dominant Ritz pair is small enough, and then keeps what it has while others go on. Where that does
/// not happen the matrix is formed and solved whole. Where that costs less, by the work that the map states, the start
/// vector first goes through many periods and a vector of the basis through several, so that few find what is left; a
/// guess of the dominant motion stands in for most of it. Method: robomill/stability/README.md, "Dominant multiplier".
class Arnoldi {
 public:
  explicit Arnoldi(const ArnoldiOptions& options = {}) : options_(options) {}
  /// Of the first out.size() lanes.
  void find(PeriodMap& map, std::span<Dominant> out) { find(map, out, {}, options_.tolerance); }
  /// @param guess      of the motion that fades least, length size() of the map, or empty; a lane of zeros has none
  /// @param tolerance  in the place of that of the options
  void find(PeriodMap& map, std::span<Dominant> out, std::span<const Lanes> guess, double tolerance);
  /// Eigenvector of a lane of the last find, ‖x‖ = 1; length size().
  [[nodiscard]] Eigen::VectorXcd vector(std::size_t lane);

 private:
  void start(std::span<const Lanes> guess);
  [[nodiscard]] bool pays_to_warm_up(const PeriodMap& map, bool guessed) const;
  [[nodiscard]] static std::size_t passes(const PeriodMap& map, bool guessed);
  void warm_up(PeriodMap& map, std::size_t passes);
  void make_room(std::size_t columns);
  void start_again(std::span<const bool> done, std::span<const Dominant> out);
  void extend(PeriodMap& map, std::size_t first, std::size_t most, std::span<bool> done, std::span<Dominant> out);
  [[nodiscard]] int periods(const PeriodMap& map, std::size_t round) const;
  void confirm(PeriodMap& map, const std::array<bool, lane_count>& fresh, std::span<bool> done,
               std::span<Dominant> out);
  void look(PeriodMap& map, std::size_t columns, std::span<bool> done, std::span<Dominant> out);
  std::array<bool, lane_count> ritz_values(std::size_t columns, const std::array<bool, lane_count>& wanted,
                                           std::array<std::complex<double>, lane_count>& value);
  void take_small(std::size_t lane, std::size_t columns);
  bool converged(std::size_t lane, std::size_t columns, Dominant& out);
  void full_matrix(PeriodMap& map, std::span<Dominant> out);

  ArnoldiOptions options_;
  double tolerance_ = 0.0;
  int periods_ = 1;  ///< that a column goes through
  std::size_t size_ = 0, most_ = 0;
  std::vector<double> start_;
  std::vector<Lanes> basis_, hessenberg_, side_;
  HessenbergLanes ritz_values_;
  Hessenberg small_;
  std::array<std::vector<std::complex<double>>, lane_count> ritz_;  ///< in the basis
  std::array<Eigen::VectorXcd, lane_count> full_;                   ///< of the matrix, where that was needed
};

}  // namespace robomill::stability::detail
