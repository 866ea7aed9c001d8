#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robomill/path/options.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// A stretch of the path on which X = (tip [m], axis before norm, γ [rad], 0) is one polynomial in u.
struct Polynomial {
  double begin_m = 0.0, length_m = 0.0;                                            ///< of u
  Eigen::Matrix<double, 8, 5> coefficients = Eigen::Matrix<double, 8, 5>::Zero();  ///< by powers of u − begin_m
  double max_rate_m_per_s = 1e300;                                                 ///< of u: the programmed feed
  double max_tip_m_per_s = 1e300;                                                  ///< … and what it is of the tip
  std::size_t block = 0, line = 0;
  bool stop = false;  ///< the tool stops at its end
  double dwell_s = 0.0;

  /// Pose and derivatives by u at u − begin_m = x_m.
  [[nodiscard]] robot::ToolJet jet(double x_m) const noexcept;
  [[nodiscard]] robot::ToolPose pose(double x_m) const noexcept;
};

/// A program as one curve without corners, over a parameter u [m] that is about the way of the tip.
///
/// Every block becomes pieces on which the pose X = (tip, axis, γ) runs evenly in u, a train of rectangular pulses of
/// dX/du. FIR filters take the corners: at corner k, where dX/du steps by Δ_k, the step passes through moving averages
/// of its own total width 2 h_k, so that exactly, however many corners overlap,
///     X(u) = X_polyline(u) + Σ_k Δ_k e_{h_k}(u − u_k),    e_h(x) = (|x| < h) the filtered ramp less the ramp
/// and with two filters X is a piecewise cubic with continuous second derivative, e_h(0) = h / 6. The axis is X's axis
/// part made a unit vector: its pieces are chords of at most max_chord_rad, which lie on the great circles then.
/// Widths are the largest that keep the tip and the axis within a share of their tolerances, found from the sum of all
/// corners and not corner by corner.
///
/// Blocks come in at the end and go out at the front; memory is that of the blocks held. Nothing is allocated while
/// no more than `capacity` nodes are held.
class Blend {
 public:
  using Point = Eigen::Matrix<double, 8, 1>;  ///< tip (3) [m], axis before norm (3), γ [rad], 0

  /// @param capacity  nodes to hold
  Blend(const SmoothingOptions& options, std::size_t capacity);

  enum class Added { moved, nothing, antipodal, full };
  /// Where the path begins; forgets all.
  void begin(const program::Pose& pose, double gamma_rad) noexcept;
  /// Adds a block; `nothing` where it does not move. Widths of corners near the end are not yet known.
  /// @param tolerance  in (0, 1]: the share of the tolerances that corners at the block may use, its own deviation
  /// included
  Added add(const program::Block& block, std::size_t index, double gamma_rad, double tolerance = 1.0) noexcept;
  /// The tool stops at the end of what was added, for dwell_s [s].
  void stop(double dwell_s) noexcept;

  /// Nodes are counted from the beginning of the program; node i ends piece i − 1 and begins piece i.
  [[nodiscard]] std::size_t first() const noexcept { return first_; }
  [[nodiscard]] std::size_t end() const noexcept { return first_ + nodes_.size(); }
  /// Pieces below this one will not change any more.
  [[nodiscard]] std::size_t ready() const noexcept { return ready_; }
  [[nodiscard]] std::size_t room() const noexcept { return capacity_ - nodes_.size(); }
  /// Finds the widths of corners that lie far enough from the end, and of all before the last stop.
  void find_widths() noexcept;
  /// Forgets pieces before this one.
  void forget(std::size_t before) noexcept;

  struct Node {
    double u_m = 0.0;
    Point at = Point::Zero();
    Point rate = Point::Zero();  ///< dX/du of the piece that begins here
    Point step = Point::Zero();  ///< Δ; 0 at a stop
    double half_width_m = 0.0;
    double tolerance = 1.0;           ///< the least share of the blocks that meet here
    double max_rate_m_per_s = 1e300;  ///< of u: the programmed feed, of the piece
    double max_tip_m_per_s = 1e300;   ///< … and what it is of the tip
    double dwell_s = 0.0;
    std::size_t block = 0;  ///< of the piece
    std::size_t line = 0;
    std::size_t reach_first = 0, reach_last = 0;  ///< corners whose filters reach into the piece: [first, last)
    bool stop = false;
  };
  [[nodiscard]] const Node& node(std::size_t index) const noexcept { return nodes_[index - first_]; }

  /// A ready piece as polynomials, in order.
  /// @param out  room for max_polynomials
  /// @return     their number
  std::size_t polynomials(std::size_t piece, Polynomial* out) const noexcept;
  static constexpr std::size_t max_polynomials = 160;

  /// How far a corner's filters may reach at most: pieces to each side, and way.
  static constexpr std::size_t max_reach = 16;
  [[nodiscard]] double max_half_width_m() const noexcept { return max_half_width_m_; }

 private:
  [[nodiscard]] Node& at(std::size_t index) noexcept { return nodes_[index - first_]; }
  [[nodiscard]] Point error(double u_m, std::size_t near, double common_half_width_m) const noexcept;
  [[nodiscard]] double excess_in_piece(std::size_t piece, double u_m) const noexcept;
  [[nodiscard]] double excess_at_node(std::size_t index, double common_half_width_m) const noexcept;
  void begin_width(std::size_t index) noexcept;
  [[nodiscard]] bool narrow(double u_m, double ratio) noexcept;
  [[nodiscard]] bool narrow_all(std::size_t from, std::size_t to) noexcept;
  void find_reach(std::size_t piece) noexcept;
  void expand(std::size_t piece, double middle_m, Polynomial& out) const noexcept;

  SmoothingOptions options_;
  std::size_t capacity_;
  double per_angle_m_ = 0.0;  ///< u for a radian of the axis
  double max_half_width_m_ = 0.0;
  std::vector<Node> nodes_;
  std::size_t first_ = 0, final_widths_ = 0, ready_ = 0, last_stop_ = 0;
};

}  // namespace robomill::path
