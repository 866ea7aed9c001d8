#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robomill/path/options.hpp"
#include "robomill/path/published/fir_profile.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// Time constants of one block and when it runs.
struct FirBlock {
  Boxes tip, axis;         ///< pulse, then filters; those of tip and axis differ only as printed. Empty: no motion
  double start_s = 0.0;    ///< when its pulse begins
  double end_s = 0.0;      ///< when it has left the filters, or its dwell is over
  double overlap_s = 0.0;  ///< with the next one, T_c
};

/// Blocks that overlap in time. Tip: their displacements add up. Axis: each block turns it about the normal of its
/// great circle, the earlier one first, a = … R_{n+1} R_n a_begin.
class FirTrajectory {
 public:
  FirTrajectory() = default;
  /// @param program    copied as far as needed
  /// @param blocks     one for each of the program's, in order of their start
  /// @param gamma_rad  empty (0 everywhere), one for all, or one at the start and one at each block's end
  FirTrajectory(const program::Program& program, std::vector<FirBlock> blocks, const std::vector<double>& gamma_rad);

  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] const std::vector<FirBlock>& blocks() const { return blocks_; }
  /// The tool at a time, with its derivatives by time [1/s …]. At rest before the start and after the end.
  [[nodiscard]] robot::ToolJet at(double time_s) const;
  /// The block that a time belongs to; an overlap is halved.
  [[nodiscard]] std::size_t block_at(double time_s) const;

 private:
  struct Move {
    Eigen::Vector3d tip_begin_m, tip_way_m, axis_begin, normal;
    double angle_rad = 0.0, gamma_begin_rad = 0.0, gamma_way_rad = 0.0;
  };
  std::vector<FirBlock> blocks_;
  std::vector<Move> moves_;
  std::vector<double> name_from_s_;        // from when a sample names a block; not decreasing
  std::vector<std::size_t> first_active_;  // when a block starts, all those before this one are done
  robot::ToolJet end_;
  double duration_s_ = 0.0;
};

/// A program planned by one of the FIR methods.
struct FirPlan {
  FirTrajectory trajectory;
  double duration_s = 0.0;
  double sum_t2_s = 0.0;  ///< of the tip's constants
  double largest_overlap_s = 0.0;
};

/// The published FIR interpolation of a program: options.method is paper, paper_as_printed or no_joint_jerk.
///
/// Per block a pulse of the tip's speed v and the axis' ω, T1 = max(L/v, θ/ω), behind moving averages
/// T2 = max(v/a, ω/α), T3 = max(a/j, α/j_ω) (and T3/2 with three filters), shared by tip and axis. Then for every
/// joint, from q', q'', q''' by the block's share at points along it:
///   velocity      T1 ≥ |q'| / q̇max
///   acceleration  T2 ≥ |q'| / (T1 (q̈max − |q''|/T1²)); paper: q'' counts only where it adds to q' s̈, at the beginning
///                 of a block with s̈ > 0 and at its end with s̈ < 0
///   jerk          (paper) T3 ≥ |q'| / (T1 T2 (q⃛max/2 − |q'''|/T1³ − 3|q''|/(T1² T2)))
/// where no T2 or T3 can do it, T1 or T2 are stretched first. Neighbours overlap by the largest T_c ≤ T2 + T3 with
/// V P(T_c/2) ≤ tolerance for tip and axis, V the change of velocity at the corner and P the way that the shorter
/// filters leave at unit speed. As printed: V² = v² + v'² − v v' cos, tip and axis with constants of their own and T1
/// alone stretched to the same total, the joints' steps by the tip's constants, signs in the jerk's step and absolute
/// values in the denominators of acceleration's and jerk's, and the angle arccos |O·O'|. Neither tolerance nor limit
/// is certain where more than two blocks overlap.
///
/// @param posture  start: the position to begin near
/// @throws InvalidInput if an option is invalid, posture.gamma_rad has another length, a block cannot be reached
///         (block, line, joint, by how much), or an axis turns by half a circle
/// Sources: [FirFiveAxis], [Tajima2018], [TajimaSencer2019]; docs/theory/fir-smoothing.md, docs/errata.md.
[[nodiscard]] FirPlan plan_fir(const program::Program& program, const robot::Kinematics& kinematics,
                               const Posture& posture, const SmoothingOptions& options);

/// Sends out a plan, a sample a period, from rest to rest.
/// @return how many samples
/// @throws InvalidInput where the machine cannot follow: block, joint, by how much
std::size_t sample_fir(const FirPlan& plan, const program::Program& program, const robot::Kinematics& kinematics,
                       const Posture& posture, double sample_period_s, const SampleSink& sink);

}  // namespace robomill::path
