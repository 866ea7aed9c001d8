#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/simulation/schedule.hpp"

// Method: robomill/simulation/README.md, "Method"

namespace robomill::simulation {

/// Milling at one speed and depth, or a schedule of them, and what vibrates in it.
struct ROBOMILL_API MillingCut {
  cutting::Milling milling;
  modal::TipModes structure;             ///< of the tool against the workpiece, in the feed's frame; no modes: rigid
  double spindle_speed_rad_per_s = 0.0;  ///< Ω [rad/s], > 0; required
  double axial_depth_m = 0.0;            ///< a [m], >= 0
  Schedule schedule = {};                ///< of depth and speed in time; not with milling.speed_variation
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct ROBOMILL_API SimulationOptions {
  double seconds = 2.0;             ///< how much is simulated [s], > 0, at most 1e7
  double sample_rate_hz = 10240.0;  ///< of the output [Hz], > 0
  bool loss_of_contact = true;      ///< false: the linear cut, whose chip may have negative thickness
  /// false: chips as a rigid cutter would cut them, whatever vibrates: the forced vibration, which cannot chatter.
  bool regeneration = true;
  int steps_per_revolution = 0;  ///< 0: chosen, see robomill/simulation/README.md
  int slices = 0;                ///< along the axis; 0: chosen
  /// In (0, 1). Steps and slices are doubled, five times at most, until Simulation::error_estimate <= tolerance: the
  /// error of the displacement over the first revolutions as a share of its root mean square. Doubled only where
  /// steps_per_revolution is 0.
  double tolerance = 2e-3;
  std::uint64_t seed = 1;  ///< of the start of small vibration
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Where a small vibration about the forced one goes: the linear cut from a random start, looked at once a period.
struct SmallVibration {
  /// found: the other members hold. not_converged: the multiplier's size still moved by > 1e-7 · max(1, |μ|) when the
  /// iterations ended. not_periodic: the speed swings with a ratio that no 50 revolutions repeat. rigid: nothing can
  /// vibrate.
  enum class Status { found, not_converged, not_periodic, rigid };
  Status status = Status::rigid;
  std::complex<double> multiplier = 0.0;  ///< of one period, the largest
  double spectral_radius = 0.0;           ///< its size, extrapolated from two step sizes
  double error_estimate = 0.0;            ///< of the spectral radius: what extrapolation moved
  double period_s = 0.0;
};

/// @throws InvalidInput if the cut or an option is out of range
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API SmallVibration small_vibration(const MillingCut& cut, const SimulationOptions& options = {},
                                                          Progress& progress = Progress::none());

/// What the changes of the motion from period to period say, last quarter of the time against the one before.
enum class Verdict {
  stable,    ///< they die out: ratio < 0.7, or < 1 and below 1e-4 of the motion; or SmallVibration's radius < 1 decides
  chatter,   ///< they grow (ratio > 1.4), stay above 5 % of the motion or diverge; or that radius >= 1 decides
  undecided  ///< neither, and no small vibration was found; or depth or speed still change in the last half
};
/// "stable", "chatter", "undecided".
[[nodiscard]] ROBOMILL_API std::string_view to_string(Verdict verdict);

/// The wall that stays on the part, at the side where teeth enter (φ = 0) or leave (φ = π), over the last half of the
/// time.
struct Wall {
  double angle_rad = 0.0;  ///< 0 or π
  /// By how much the wall falls short of the commanded one, seen from the cutter's axis; > 0: material is left
  /// standing, < 0: too much was removed. Mean along the feed, scallops included; then mean, least and greatest over
  /// the heights.
  double location_error_m = 0.0, least_location_error_m = 0.0, greatest_location_error_m = 0.0;
  double ra_m = 0.0;  ///< mean distance from the mean line, along the feed; of the roughest height
  double rz_m = 0.0;  ///< highest to lowest, the same
};

struct Simulation {
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;  ///< x, y, z
  double sample_rate_hz = 0.0;
  Columns displacement_m;         ///< of the tool against the workpiece, band-limited as all three
  Columns acceleration_m_per_s2;  ///< its second derivative
  Columns force_n;                ///< on the tool
  Verdict verdict = Verdict::undecided;
  double growth_per_period =
      0.0;                ///< of what is not periodic, from the third quarter of the time to the last; 0: too short
  double period_s = 0.0;  ///< of the cut: a tooth's, or a revolution or more
  double chatter_frequency_hz = 0.0;  ///< strongest motion that is no harmonic of rotation; 0 where stable
  double chatter_amplitude_m = 0.0;   ///< of it
  SmallVibration small;
  /// Largest force on the tool over the time, entry included, of the means over the steps: that of a tool that
  /// vibrates, unlike cutting::CuttingForce::peak_force_n.
  double vibrating_peak_force_n = 0.0;
  double missed_share = 0.0;  ///< share of the time in which an edge between entry and exit touches nothing
  std::vector<Wall> walls;    ///< none for an edge that leaves none, without feed, or where there was too little time
  int steps_per_revolution = 0, slices = 1;
  double error_estimate = 0.0;  ///< of the displacement over the first revolutions, relative
  bool resolved = true;         ///< error_estimate <= tolerance
  /// |displacement| >= 1 m was reached, as by a linear cut that grows; the columns end there.
  bool diverged = false;
  double seconds = 0.0;  ///< of computing
};

/// Integrates
///   q(t) = 2 Re Σ_k R_k z_k + S F,  dz_k/dt = λ_k z_k + L_k^T F
/// with the cutting force F on every edge's slice, whose chip is the distance from the edge to the surface that all
/// earlier teeth left. Starts at rest, behind a rigid cutter's surface. Method, rules and accuracy:
/// robomill/simulation/README.md.
/// @throws InvalidInput if the cut or an option is out of range
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API Simulation simulate(const MillingCut& cut, const SimulationOptions& options = {},
                                               Progress& progress = Progress::none());

}  // namespace robomill::simulation
