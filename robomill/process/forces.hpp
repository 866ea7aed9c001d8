#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/cutting/default_stock.hpp"
#include "robomill/cutting/program_forces.hpp"
#include "robomill/cutting/static_deflection.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/process/cut.hpp"
#include "robomill/process/measured.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/redundancy.hpp"
#include "robomill/simulation/simulation.hpp"

// Method: robomill/process/README.md, "Forces (`forces.hpp`)"

namespace robomill::process {

/// A robot in the posture of one cut.
struct CutPosture {
  Eigen::Matrix3d compliance_m_per_n = Eigen::Matrix3d::Zero();  ///< of the tip, in F
  Eigen::Matrix3d base_from_feed = Eigen::Matrix3d::Identity();  ///< P_B = R P_F
  robot::ToolPose pose;                                          ///< in W
  double condition_number = 0.0;
};

/// Forces over one revolution.
struct RevolutionForces {
  cutting::StaticDeflection deflected;
  std::optional<cutting::ForceSummary> rigid = {};  ///< with a robot: as if it did not deflect
  std::optional<CutPosture> posture = {};
  std::optional<robot::Redundancy> spindle_rotation = {};  ///< with a robot: what turning it about the tool does
  std::optional<simulation::Simulation> vibration = {};    ///< with dynamics
  Eigen::Matrix3Xd vibrating_force_n = {};                 ///< of its last revolution, at the steps of the static one
};

/// One block of a program with the robot that runs it.
struct BlockResult {
  cutting::BlockForce force;
  Eigen::VectorXd joints = {};                             ///< at the block's end; empty without a robot
  Eigen::Vector3d deflection_m = Eigen::Vector3d::Zero();  ///< of the tip under the mean force while cutting, in W
  /// Under that mean force of a revolution which bends the robot most.
  Eigen::Vector3d peak_deflection_m = Eigen::Vector3d::Zero();
  double condition_number = 0.0;
  /// Where the engagement feels the deflection (ProgramForces::deflected).
  enum class Settled {
    found,      ///< the deflection is that of the force which the deflected tool feels
    unsettled,  ///< it still changes after the last pass: force and deflection drive each other
    lost        ///< the tool is pushed out of the cut that the program asks for
  };
  Settled settled = Settled::found;
};

/// What a program starts from.
struct ProgramStock {
  cutting::Stock stock;
  std::optional<cutting::DefaultStock> assumed = {};  ///< where none is given
};

struct ProgramForces {
  std::filesystem::path path = {};  ///< of its file
  program::Program program;
  std::vector<BlockResult> blocks = {};
  std::optional<ProgramStock> stock = {};  ///< none: each block beside its neighbouring pass
  double seconds = 0.0;
  double removed_volume_m3 = 0.0;
  bool deflected = false;  ///< the tool cuts where the robot bends to; else where the program has it
  /// Where each block has most of the cutter in the material; empty engagement: it does not cut. Only where asked for.
  std::vector<cutting::PoseEngagement> cuts = {};
  /// Blocks in which teeth were found in the material: the one meaning of "cuts" in summary, documents and page.
  [[nodiscard]] ROBOMILL_API std::size_t cutting_blocks() const;
};

struct ForcesResult {
  Cut cut;
  std::optional<cell::Cell> cell = {};
  std::optional<RevolutionForces> revolution = {};
  std::optional<MeasuredRevolution> measured = {};  ///< beside the revolution
  std::optional<ProgramForces> program = {};
  std::optional<decision::SpindleCapacity> spindle = {};  ///< what it has along the program, where that is known
  std::vector<std::string> warnings = {}, notes = {};
  std::vector<Assumption> assumed = {};
};

/// Forces over one revolution, and what they do to the robot, if it has one.
/// @throws InvalidInput with the cut's file and key, or naming a member of the cut; Interrupted
[[nodiscard]] ROBOMILL_API ForcesResult forces_of_revolution(Cut cut, std::optional<cell::Cell> cell,
                                                             Progress& progress = Progress::none());

/// How a program is run.
struct ProgramRun {
  std::vector<robot::Position6> joints = {};  ///< at the end of each block; none: found here
  bool keep_cuts = false;                     ///< ProgramForces::cuts
  bool deflect = false;  ///< the engagement feels the deflection, with a cell and a stock; else it does not
};

/// Forces along a program, and the robot under them, if there is one.
/// @param path  of the program's file, for messages
/// @throws InvalidInput with file and line, also where a block is out of the robot's reach, or naming a member of the
/// cut; Interrupted
[[nodiscard]] ROBOMILL_API ForcesResult forces_along(Cut cut, program::Program program,
                                                     const std::filesystem::path& path, std::optional<cell::Cell> cell,
                                                     const ProgramRun& run, Progress& progress = Progress::none());

/// What the spindle must give at one place.
struct SpindleLoad {
  std::size_t line = 0;  ///< of the program; 0 for one revolution
  double spindle_speed_rad_per_s = 0.0;
  double torque_n_m = 0.0;  ///< largest mean over one revolution
  double power_w = 0.0;     ///< largest mean over forces.power_time_s
};
/// Of one revolution, or of every block that cuts.
[[nodiscard]] ROBOMILL_API std::vector<SpindleLoad> spindle_loads(const ForcesResult& result);

/// The stock in words, of one that was assumed with where its height comes from; empty for one beside neighbouring
/// passes.
[[nodiscard]] ROBOMILL_API std::string stock_text(const ProgramForces& program);

/// Gets a text piece by piece.
using TakeText = std::function<void(std::string_view piece)>;
/// A row a step of rotation, or a row a block; along a program the text is never held whole.
/// @throws what `take` throws; Interrupted
ROBOMILL_API void write_forces_csv(const ForcesResult& result, const TakeText& take,
                                   Progress& progress = Progress::none());
ROBOMILL_API void write_forces_json(const ForcesResult& result, const TakeText& take,
                                    Progress& progress = Progress::none());
/// The same in one text.
[[nodiscard]] ROBOMILL_API std::string forces_csv(const ForcesResult& result);
[[nodiscard]] ROBOMILL_API std::string forces_json(const ForcesResult& result);

}  // namespace robomill::process
