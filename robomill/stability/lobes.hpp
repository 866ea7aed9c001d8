#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/stability/spatial.hpp"

// Method: robomill/stability/README.md, "Method"

namespace robomill::stability {

/// A structure that vibrates and the cut that excites it.
struct ROBOMILL_API LobesProblem {
  cutting::Milling milling;  ///< a cylindrical cutter, upright, in x and y
  /// In place of milling, at most one of them; in x, y and z. By collocation alone.
  std::optional<SpatialMilling> spatial = {};
  std::optional<cutting::Drill> drilling = {};
  [[nodiscard]] bool in_three_directions() const { return spatial.has_value() || drilling.has_value(); }
  /// @param what  that cannot be done otherwise, as "the surface"
  /// @throws InvalidInput unless the cut is `milling`
  void require_plane(const char* what) const;
  /// Modes at the tool tip in fixed axes x, y and, for a cut in three directions, z; others are ignored, and a
  /// direction that is not there is rigid. The stiffness residuals (real parts) act as a static compliance, the mass
  /// residuals are left out.
  modal::ModalModel dynamics;
  std::vector<int> keep_modes = {};  ///< numbers of the modes that take part, from 1; empty: all
  double feed_direction_rad = 0.0;   ///< of the feed in the x-y plane, counter-clockwise from x [rad]
  /// Of the part and its fixture where the tool cuts, in the same axes; no modes: it stands still.
  /// keep_modes does not count for it.
  modal::ModalModel workpiece_dynamics = {};
  /// Measured FRFs of tool and workpiece in place of their modes: for the frequency-domain methods, without a fit.
  modal::FrfSet measured = {}, workpiece_measured = {};
  [[nodiscard]] bool has_measured() const { return !measured.frfs.empty() || !workpiece_measured.frfs.empty(); }
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The structure at the tool's tip in the feed's frame: the tool's modes that take part, then the workpiece's.
/// @throws InvalidInput if a model has no x or y at a tip, or several points that could be the tip
[[nodiscard]] ROBOMILL_API modal::TipModes tip_modes(const LobesProblem& problem);

/// zeroth_order, multi_frequency: in the frequency domain, limits alone; from modes or measured FRFs. The others need
/// modes and know the spectral radius.
enum class Method {
  collocation,                      ///< force as polynomials between entries and exits; refined to the tolerance
  semi_discretization,              ///< [Insperger2004], order zero: delayed displacement held over a step
  semi_discretization_first_order,  ///< [Insperger2008]: delayed displacement linear over a step; equal pitch
  full_discretization,              ///< [Ding2010]: present displacement linear too; equal pitch
  zeroth_order,                     ///< [Altintas1995]: mean cutting stiffness; misses flips and effects of helix
  multi_frequency                   ///< [Merdol2004], [Budak1998]: all harmonics, to convergence
};
inline constexpr Name<Method> method_names[] = {
    {"collocation", Method::collocation},
    {"semi-discretization", Method::semi_discretization},
    {"semi-discretization-first-order", Method::semi_discretization_first_order},
    {"full-discretization", Method::full_discretization},
    {"zeroth-order", Method::zeroth_order},
    {"multi-frequency", Method::multi_frequency}};
/// What a chart holds beside limits and points.
enum class Output {
  boundary,  ///< curves on which the spectral radius is 1; the grid only shows where to look
  map,       ///< the spectral radius at every node of the grid
  both,      ///< the map and the boundary
  limits     ///< neither: the limits of the grid's speeds alone, as limit_depths; points without their gain margin
};
/// Which time a multiplier, and so the spectral radius, is of.
enum class Period {
  tooth,      ///< from a tooth to the next: equal teeth
  revolution  ///< of the spindle: teeth that differ (unequal pitch, runout, …), or a speed that swings
};
/// How stability is lost: where the multiplier μ leaves the unit circle.
enum class BifurcationType {
  hopf,  ///< a complex pair: a chatter frequency unrelated to tooth passing
  flip,  ///< at -1, period doubling: odd multiples of half the frequency of the period
  fold   ///< at +1: multiples of the frequency of the period
};

/// "semi-discretization", "tooth", "hopf", …: as the files write them.
[[nodiscard]] ROBOMILL_API std::string_view to_string(Method method);
[[nodiscard]] ROBOMILL_API std::string_view to_string(Period period);
[[nodiscard]] ROBOMILL_API std::string_view to_string(BifurcationType kind);

/// One point of the stability chart.
struct OperatingPoint {
  double spindle_speed_rad_per_s = 0.0;  ///< Ω [rad/s], > 0
  double axial_depth_m = 0.0;            ///< a [m], >= 0
  double gain = 1.0;                     ///< factor on the cutting stiffness, > 0; for collocation
};

struct ROBOMILL_API LobesOptions {
  std::array<double, 2> spindle_speed_rad_per_s = {0.0, 0.0};  ///< lowest and highest [rad/s], 0 < low < high; required
  std::array<double, 2> axial_depth_m = {0.0, 0.0};  ///< least and greatest [m], 0 <= least < greatest; required
  std::array<int, 2> grid = {200, 200};              ///< speeds and depths, each at least 2
  Method method = Method::collocation;
  int intervals = 40;  ///< m of semi-discretization: time steps in a mean tooth period, at least 4
  /// In [1e-10, 0.1]. Collocation is refined until its spectral radii are that accurate (a share of them above 1):
  /// |Δradius| <= tolerance · max(1, radius). Boundary and limit end where |spectral radius - 1| <= tolerance; those of
  /// multi_frequency where |Δlimit| <= tolerance · limit.
  double tolerance = 1e-6;
  /// > 0: limits at single speeds (limit_depths, uncertain_limits) are looked for among depths this far apart at most
  /// [m] and taken from a straight line between two of them, without an estimate: for a picture. Not in the frequency
  /// domain.
  double limit_step_m = 0.0;
  Output output = Output::boundary;
  std::vector<OperatingPoint> points = {};  ///< evaluated beside the grid; may lie outside its range
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// What happens at one point of the chart.
struct PointResult {
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;
  /// Greatest |multiplier| of the period; 1e100 where the motion overflows; NaN for a method that does not know it.
  double spectral_radius = 0.0;
  std::complex<double> multiplier = 0.0;  ///< the one with it, imaginary part >= 0
  bool stable = false;                    ///< spectral radius < 1; in the frequency domain depth < limit
  double error_estimate = 0.0;            ///< of the spectral radius: from a second, finer run; or NaN as it
  double chatter_frequency_hz = 0.0;      ///< at which this multiplier's motion is greatest [Hz]; 0 where it overflows
  BifurcationType kind = BifurcationType::hopf;
  modal::ModeId mode = {};  ///< that moves most in it; unknown where it overflows
  /// Of a cut in three directions in a chart or a sweep: smallest factor on its stiffness at which the spectral radius
  /// is 1 (GainMargin in sweep.hpp); infinity: none up to 1,000; 0.001: unstable there already.
  /// NaN: not looked for.
  double gain_margin = std::numeric_limits<double>::quiet_NaN();
  /// Lowest unstable depth at its speed, in a chart [m]; infinity: none in its range. NaN: not looked for.
  double limit_depth_m = std::numeric_limits<double>::quiet_NaN();
};

/// A point where the spectral radius is 1.
struct BoundaryPoint {
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;
  double chatter_frequency_hz = 0.0;
  BifurcationType kind = BifurcationType::hopf;
  modal::ModeId mode = {};
  double error_estimate =
      0.0;        ///< of the spectral radius there; in the frequency domain of the depth, as a share of it
  int curve = 0;  ///< which curve of the boundary it is on, from 1; 0: points of each speed alone
};

/// The lowest unstable depth at one speed.
struct Limit {
  /// found: the other members hold. stable_in_range: no depth of the grid is unstable; they are 0.
  enum class Status { found, stable_in_range };
  double spindle_speed_rad_per_s = 0.0;
  Status status = Status::stable_in_range;
  double axial_depth_m = 0.0;
  double chatter_frequency_hz = 0.0;
  BifurcationType kind = BifurcationType::hopf;
  modal::ModeId mode = {};      ///< unknown for measured FRFs
  double error_estimate = 0.0;  ///< as of a boundary point
};

struct LobesResult {
  Eigen::VectorXd spindle_speed_rad_per_s;  ///< length grid[0]
  Eigen::VectorXd axial_depth_m;            ///< length grid[1]
  Eigen::MatrixXd spectral_radius;          ///< grid[1] x grid[0]: a row a depth; empty for Output::boundary, limits
  std::vector<BoundaryPoint> boundary;      ///< curve by curve, along each; empty for Output::map, limits
  std::vector<Limit> limit;                 ///< one a grid speed
  std::vector<PointResult> points;          ///< one for each of LobesOptions::points
  Method method = Method::collocation;
  Period period = Period::tooth;  ///< of the spectral radius
  long long evaluations = 0;      ///< spectral radii found
  long long unsettled = 0;        ///< of these, in how many the eigenvalue did not converge; 0 unless the cut is absurd
  /// Nodes of the map and points of boundary, limit and points with error_estimate > tolerance · max(1, radius); of
  /// multi_frequency the limits that did not converge. 0 for discretizations, which are not refined.
  long long uncertain = 0;
  double seconds = 0.0;
};

/// The stability chart of milling with regenerative chip thickness,
///   q(t) = 2 Re Σ_k R_k z_k + S F,  dz_k/dt = λ_k z_k + L_k^T F,  F = Σ_j K_j(t) (q(t) - q(t - τ_j)),
/// by the method that the options name. Method, accuracy and cost: robomill/stability/README.md. Sources:
/// [Altintas1995], [Insperger2004].
/// @throws InvalidInput if the problem or an option is out of range
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API LobesResult compute_lobes(const LobesProblem& problem, const LobesOptions& options,
                                                     Progress& progress = Progress::none());

/// One point of that chart. Of the options only method, intervals and tolerance count.
/// @throws InvalidInput if the problem, the point or an option is out of range
[[nodiscard]] ROBOMILL_API PointResult evaluate_point(const LobesProblem& problem, const LobesOptions& options,
                                                      const OperatingPoint& point);

/// The lowest unstable depth at each of these speeds; depths are searched on the grid of options.axial_depth_m and
/// refined to options.tolerance, or to options.limit_step_m where that is given. Of the options the speeds do not
/// count.
/// @throws InvalidInput if the problem, a speed or an option is out of range
[[nodiscard]] ROBOMILL_API std::vector<Limit> limit_depths(const LobesProblem& problem, const LobesOptions& options,
                                                           const std::vector<double>& spindle_speeds_rad_per_s,
                                                           Progress& progress = Progress::none());

}  // namespace robomill::stability
