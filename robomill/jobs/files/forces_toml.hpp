#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/jobs/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::jobs {

/// For which of the verb's two jobs the file is read: what the other one needs may be missing.
enum class ForcesJob {
  revolution,  ///< one revolution of one cut: needs depths, feed, speed and direction, and the posture of a robot
  program      ///< block by block along a program: speed, feed and engagement come from program and workpiece
};

/// forces.toml.
struct ForcesFile {
  std::filesystem::path path;
  cutting::Cutter cutter;
  cutting::Cut cut;  ///< along a program the engagement comes from the workpiece, and this one has no part
  cutting::MillingCoefficients coefficients;
  cutting::CutMotion motion;  ///< along a program only its speed counts, 0: the program's own
  cutting::ForceOptions force;
  int slices = 0;                                             ///< rings of the engagement; 0: chosen
  bool on_workpiece = false;                                  ///< forces are reported as they act on the workpiece
  std::filesystem::path cell = {};                            ///< robot.cell, resolved; empty where absent
  std::vector<double> joints_rad = {};                        ///< robot.joints_deg: the posture of a single cut
  Eigen::Vector3d feed_direction = Eigen::Vector3d::UnitX();  ///< of a single cut, in W
  bool robot_vibrates = false;      ///< robot.vibration: its joints and masses take part in the vibration
  double feed_direction_rad = 0.0;  ///< in the axes of the structures
  modal::ModalModel dynamics = {}, workpiece_dynamics = {};  ///< what vibrates; no modes where absent
  std::optional<cutting::Stock> stock = {};                  ///< none: a box around the program
  bool neighbours = false;  ///< stock.kind: no stock, but the neighbouring pass of each block
  double dexel_m = 0.25e-3;
  std::vector<Assumption> assumed = {};  ///< of its structure
  double power_time_s = 0.1;            ///< forces.power_time_s: over which a program's power is a mean for the spindle
  std::vector<std::string> notes = {};  ///< sentences for the user, of a material that it names
  /// Calls f; an InvalidInput about a member that this file gave comes out in its words.
  template <class F>
  auto located(F&& f) const {
    try {
      return f();
    } catch (const InvalidInput& error) {
      throw in_its_words(error);
    }
  }
  [[nodiscard]] ROBOMILL_API InvalidInput in_its_words(const InvalidInput& error) const;
  ForcesJob job = ForcesJob::revolution;              ///< that it was read for
  std::shared_ptr<const io::TomlFile> document = {};  ///< for errors in its words; empty where built in memory
};

/// The files of modes and coefficients that it names are read too.
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API ForcesFile read_forces(const io::TomlSource& source, ForcesJob job = ForcesJob::revolution);

}  // namespace robomill::jobs
