#pragma once
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/forces.hpp"

// Method: robomill/process/README.md, "Another turn of the flange (`turned.hpp`)"

namespace robomill::process {

/// Turn of the flange about the tool's axis at one place of the path, from where the program (as programmed) has it: as
/// GammaMap::gamma_rad.
struct GammaKnot {
  double path_m = 0.0;  ///< way of the tip, as GammaMap::path_m
  double gamma_rad = 0.0;
};

/// A program whose blocks were judged.
struct JudgedProgram {
  const ForcesResult& forces;  ///< along the program, with a cell and cuts kept
  const ProgramBlocks& blocks;
  const BlocksJudging& judging;
  /// γ of the flange where `forces` stand, from where the program as programmed has it, at its start and at each
  /// block's end; empty: as programmed.
  std::vector<double> gamma_offset_rad = {};
  std::vector<std::size_t> map_blocks = {};  ///< the columns of its map of γ; empty where it has none
};

/// A block in which the robot cannot stand.
struct LostBlock {
  std::size_t block = 0;
  std::string reason = {};  ///< "the robot cannot stand so"
};

/// A judged program with other turns of the flange.
struct TurnedProgram {
  /// As judged. Joints, deflections and condition numbers are those of the turned posture; of lost blocks the joints
  /// are NaN and there is no cut.
  ForcesResult forces;
  ProgramBlocks blocks;  ///< lost ones do not count as cutting
  std::vector<LostBlock> lost = {};
  /// Blocks into which a joint goes by more than 90° and the turn itself further than as judged: the robot comes to
  /// stand another way, such as with its wrist over.
  std::vector<std::size_t> other_way = {};
  /// Blocks that are shown over the path: the columns of the map of γ; where there is none, of the blocks that
  /// cut, 400 at most.
  std::vector<std::size_t> shown = {};
  std::vector<double> path_m = {}, gamma_rad = {};                           ///< of each that is shown, at its end
  double least_stability_margin = std::numeric_limits<double>::quiet_NaN();  ///< NaN: no block cuts
  std::vector<std::string> notes = {};
};

/// Judges the blocks of a program with the flange turned so, with the same dynamics and without scans. Engagement and
/// forces stay as they are. Where γ is the judged one everywhere the numbers are too; else blocks share an evaluation
/// within the tolerances of the map of γ.
/// @param gamma  increasing in path; straight between knots, the same beyond them
/// @throws InvalidInput naming the member of `gamma`; as judge_blocks; Interrupted
[[nodiscard]] ROBOMILL_API TurnedProgram judge_turned(const JudgedProgram& judged, const std::vector<GammaKnot>& gamma,
                                                      Progress& progress = Progress::none());

}  // namespace robomill::process
