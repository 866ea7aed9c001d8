#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/holder.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/toml_source.hpp"

// Method: robomill/coupling/README.md, "Files"

namespace robomill::coupling {

/// assembly.toml, with the measured holder that it names.
struct AssemblyFile {
  std::filesystem::path path = {};
  Assembly assembly = {};
  /// Lines to give: those of [frequency]; with a measured holder those of its axis within frequency.range_hz. Empty
  /// where the joint is sought, whose FRF brings its own.
  Eigen::VectorXd frequency_hz = {};
  double low_hz = 0.0;  ///< frequency.range_hz; all where absent
  double high_hz = std::numeric_limits<double>::infinity();
  JointFitOptions search = {};              ///< bounds and sizes of [search]; the defaults where absent
  std::filesystem::path receptances = {};   ///< holder.receptances, resolved; empty where absent
  std::optional<HolderResult> holder = {};  ///< where rotations were completed or an artefact taken off
  std::vector<std::string> notes = {};      ///< sentences for the user
  std::vector<Assumption> assumed = {};
  /// Where the joint is that of AssemblyReading::joint: that it is, and what of it is not to be relied on.
  std::vector<std::string> joint_notes = {}, joint_warnings = {};
  /// Where AssemblyReading::cuts took it off the tip: what [accelerometer] describes, and a sentence that it is off.
  Accelerometer removed_accelerometer = {};
  std::string cutting_note = {};
};

struct AssemblyReading {
  /// The joint is what is looked for: its stiffness and damping may be left out and are not used (any valid values
  /// stand there), and no frequencies are needed.
  bool joint_sought = false;
  /// joint.json, whose four values stand in place of those of [joint], which may be missing there, and so may the
  /// table. The cross stiffness stays the assembly's. Empty: none.
  std::filesystem::path joint = {};
  /// The tool is to cut: a tool that hangs free is rejected, and the accelerometer is taken off.
  bool cuts = false;
};

/// Reads the assembly, its holder's receptances, and makes of these what tip_frfs takes: as they are where they hold
/// rotations, by coupling::complete_rotations where holder.points_mm says where they were measured, and by
/// coupling::remove_artefact where holder.artefact says on what.
/// @throws InvalidInput with file, line, key and value, or with the file of receptances and the FRFs that it lacks; as
///     read_joint_json; or if the joint of joint.json has another number of points, or the tool hangs free where it is
///     to cut or its joint is looked for
[[nodiscard]] ROBOMILL_API AssemblyFile read_assembly(const io::TomlSource& source,
                                                      const AssemblyReading& reading = {});

/// The lines of a set within [low_hz, high_hz] and above 0 Hz.
/// @throws InvalidInput if there is none
[[nodiscard]] ROBOMILL_API modal::FrfSet lines_between(const modal::FrfSet& set, double low_hz, double high_hz);

}  // namespace robomill::coupling
