#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"

/// Work frame W: the program's own, fixed in the part; docs/frames.md.
// Method: robomill/program/README.md, "Method"
namespace robomill::program {

/// Where the tool stands, in W.
struct Pose {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit vector from the tip to the spindle
};

/// How the spindle turns, seen from the spindle towards the tip.
enum class Spindle {
  not_given,        ///< the program has not said yet
  off,              ///< M5, M19, SPINDL/OFF
  clockwise,        ///< M3, SPINDL: a right-hand cutter cuts
  counterclockwise  ///< M4, SPINDL with CCLW: a left-hand cutter cuts
};

/// Whether a machine waits for its operator where a dwell stands.
enum class OperatorStop {
  none,     ///< goes on by itself
  always,   ///< M0, STOP: waits until the operator starts it again
  optional  ///< M1, OPSTOP: waits where the machine's switch for it is on
};

/// Coolants that are on.
struct Coolant {
  bool mist = false;          ///< M7
  bool flood = false;         ///< M8
  bool through_tool = false;  ///< M88
  friend bool operator==(const Coolant&, const Coolant&) = default;
};

/// One straight move; the tip runs along a line, the axis along a great circle, both evenly in time. A dwell stands
/// still where the block before it ends.
///
/// Spindle and coolant are the states that hold during the block. Where one differs from the block before it, the
/// change is commanded before the block begins. The states before the first block are those of its members' defaults.
struct Block {
  enum class Kind {
    rapid,  ///< G0, RAPID: as fast as the machine can; not meant to cut
    feed,   ///< G1, chords of G2 and G3, GOTO, a row of CSV: takes duration_s; cuts
    dwell   ///< G4, DELAY or a stop for the operator: stands still for duration_s
  };
  Kind kind = Kind::feed;
  std::size_t line = 0;  ///< in the program's file, from 1
  Pose end;
  double duration_s = 0.0;               ///< of a feed move or a dwell; 0 for a rapid: as fast as the machine can
  double spindle_speed_rad_per_s = 0.0;  ///< as commanded; 0 where the program has not said
  Spindle spindle = Spindle::not_given;  ///< not_given where the program has not said
  Coolant coolant = {};
  OperatorStop operator_stop = OperatorStop::none;  ///< of a dwell, which may last 0 s then
  /// By how much tip and axis of this straight move may leave the curve that it stands for, at the same time: of an
  /// arc, or of rotary axes that turn evenly. >= 0, 0 where the program says a straight move.
  double tip_deviation_m = 0.0, axis_deviation_rad = 0.0;
};

/// What a reader left out.
struct Skipped {
  std::size_t line = 0;
  std::string what;
};

/// What a reader left out, corrected or took for granted.
struct Remarks {
  std::vector<Skipped> skipped = {};    ///< in the order of the program; a reader may keep the first ones alone …
  std::size_t skipped_count = 0;        ///< … of so many
  std::vector<std::string> notes = {};  ///< sentences for the user: what was corrected
  std::vector<Assumption> assumed = {};
};

/// An NC program as data.
struct ROBOMILL_API Program {
  Pose start;                 ///< where the first block begins
  std::vector<Block> blocks;  ///< no block without motion but dwells
  std::vector<Skipped> skipped = {};
  std::vector<std::string> notes = {};  ///< sentences for the user: what was corrected
  std::vector<Assumption> assumed = {};
  /// Where block i begins.
  [[nodiscard]] const Pose& begin_of(std::size_t block) const { return block == 0 ? start : blocks[block - 1].end; }
};

/// A program that comes block by block, in memory that does not grow with it.
class ROBOMILL_API Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  Source(Source&&) = delete;
  Source& operator=(Source&&) = delete;
  virtual ~Source() = default;
  /// Where the first block begins.
  [[nodiscard]] virtual const Pose& start() const = 0;
  /// The next block into `out`; false at the end.
  /// @throws InvalidInput what the program's reader throws
  virtual bool next(Block& out) = 0;
  /// Begins anew with the first block.
  virtual void rewind() = 0;
  /// Of what was read so far, in whichever pass came farthest.
  [[nodiscard]] virtual Remarks remarks() const { return {}; }
};

/// A program in memory as a source.
class ROBOMILL_API ProgramSource final : public Source {
 public:
  /// @param program  outlives the source
  explicit ProgramSource(const Program& program) : program_(program) {}
  [[nodiscard]] const Pose& start() const override { return program_.start; }
  bool next(Block& out) override;
  void rewind() override { next_ = 0; }
  /// Of the whole program.
  [[nodiscard]] Remarks remarks() const override;

 private:
  const Program& program_;
  std::size_t next_ = 0;
};

/// Between two poses, share in [0, 1]: line of the tip, great circle of the axis.
[[nodiscard]] ROBOMILL_API Pose between(const Pose& from, const Pose& to, double share);

/// Angle between two unit vectors [rad], in [0, π], accurate at both ends.
[[nodiscard]] ROBOMILL_API double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace robomill::program
