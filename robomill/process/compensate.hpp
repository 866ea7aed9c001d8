#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/decide_options.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/process/README.md, "Compensation (`compensate.hpp`)"

namespace robomill::process {

struct ROBOMILL_API CompensateOptions {
  PathOffsets offsets = {};
  /// >= 0; way over which an offset dies away along blocks that are not compensated; 0: the cutter's diameter.
  double blend_m = 0.0;
  double tolerance_m = 1e-6;      ///< > 0: settled where no offset changes by more than this …
  double tolerance_share = 0.02;  ///< … or than this share of it, >= 0
  int most_passes = 5;            ///< 1 to 20
  double tolerance = 1e-4;        ///< of the spectral radius, as LobesOptions::tolerance
  BlockTolerance alike = {.cut_share = 0.01};
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// What a block leaves of the surface that the program ends with. Errors are taken at the instant at which each place
/// of it is generated; > 0: material is left standing.
struct SurfaceLeft {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  enum class State {
    nothing,        ///< the block does not cut, or later blocks take away all that it leaves: roughing
    known,          ///< the errors hold
    unstable,       ///< the block leaves a surface, and chatters: it has no steady motion
    opposite_walls  ///< the errors hold; two walls that face each other want opposite offsets
  };
  State state = State::nothing;
  double width_m = 0.0;   ///< of it, across the feed, mean over the block
  double error_m = none;  ///< of greatest magnitude
  double rms_m = none;
};

/// One block of a compensated program.
struct CompensatedBlock {
  enum class State {
    untouched,       ///< no finishing pass; it may be moved a little where it leads to one (`offset_m`)
    compensated,     ///< along the whole block
    bounded,         ///< the same, cut off at max_offset_m
    unstable,        ///< a finishing pass that chatters: not compensated
    opposite_walls,  ///< a finishing pass that leaves both walls of a slot: not compensated
    lost             ///< the moved block would lose the cut: not compensated
  };
  State state = State::untouched;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< mean of those of its ends, in W
  SurfaceLeft before = {};                             ///< of the program as it was
  SurfaceLeft after = {};                              ///< predicted, against the surface that was asked for
};

/// A program whose finishing passes are moved by the deflection that is predicted where they generate the surface.
struct Compensation {
  enum class Status {
    settled,            ///< offsets and what they do to the force agree
    unsettled,          ///< offsets still change after the last pass; the errors are those of the last one
    nothing_to_do,      ///< no finishing pass that could be compensated
    left_to_controller  ///< PathOffsets::controller_compensates
  };
  Status status = Status::nothing_to_do;
  program::Program program;                   ///< with the ends of its blocks moved; all else as it was
  std::vector<CompensatedBlock> blocks = {};  ///< one a block
  int passes = 0;                             ///< offsets that were tried
  /// Over the surface that compensated blocks leave, weighed by its area; 0 where there is none.
  double rms_before_m = 0.0, rms_after_m = 0.0;
  double largest_offset_m = 0.0;
  std::vector<std::string> warnings = {}, notes = {};
};

/// Moves the path of finishing passes by what the tool is displaced at the instant at which each place of the surface
/// is generated, until the force of the moved path agrees with the offset. Joints are followed to the moved ends.
/// @param forces    along a program, with a cell and a stock
/// @param dynamics  empty: the static compliance of the cell's joints alone; nothing vibrates, nothing chatters
/// @throws InvalidInput if an option is out of range, forces lack cell or stock, dynamics do not fit a block, a moved
/// block is out of reach or takes a joint beyond its limit, naming block and line; Interrupted
[[nodiscard]] ROBOMILL_API Compensation compensate(const ForcesResult& forces, const DynamicsAt& dynamics,
                                                   const CompensateOptions& options = {},
                                                   Progress& progress = Progress::none());

/// The static compliance of the cell's joints in each posture as modes far above any cut, which follow the force.
[[nodiscard]] ROBOMILL_API DynamicsAt static_dynamics(const cell::Cell& cell);

}  // namespace robomill::process
