#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/directions.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/sweep.hpp"
#include "robomill/stability/uncertainty.hpp"

// Method: robomill/jobs/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::jobs {

/// lobes.toml. What it says of the structure is one of: nothing, a file of modes, a file of FRFs, modes of its own, or
/// a cell and one posture of it.
struct LobesFile {
  std::filesystem::path path;
  std::filesystem::path job = {};            ///< the document, where it is a job that gives the structure; else empty
  stability::LobesProblem problem;           ///< dynamics is empty unless modes stand in the file itself
  stability::LobesOptions options;           ///< without points
  std::filesystem::path modes = {};          ///< dynamics.modes, resolved; empty where absent
  std::filesystem::path frf = {};            ///< dynamics.frf, resolved; empty where absent
  modal::MissingDirections directions = {};  ///< of the tool's structure
  std::filesystem::path cell = {};           ///< dynamics.cell, resolved; empty where absent
  std::vector<double> joints = {};           ///< dynamics.joints_deg, the posture [rad or m]
  cell::PostureAxes posture_axes = cell::PostureAxes::base;  ///< dynamics.axes beside a cell: those of the cut
  std::shared_ptr<const cell::ModesOfPosture> posture = {};  ///< what load_dynamics() found there
  std::filesystem::path workpiece_modes = {};                ///< workpiece_dynamics.modes, the same
  std::filesystem::path workpiece_frf = {};                  ///< workpiece_dynamics.frf, the same
  std::array<int, 2> surface_grid = {0, 0};                 ///< speeds and depths of the map of surface errors; 0: none
  stability::Uncertainty uncertainty = {};                  ///< samples: 0 where the file has none
  double radial_depth_m = 0.0;                              ///< b [m]; from the angles where they are given
  std::optional<cutting::MillingDirection> direction = {};  ///< cut.direction; none where the angles are given
  /// lobes.sweep: what the chart varies beside the speed, and over which range [m] or [rad]; options then holds an
  /// axial depth that does not count.
  stability::SweptParameter sweep = stability::SweptParameter::axial_depth;
  std::array<double, 2> sweep_range = {0.0, 0.0};
  bool drilling = false;               ///< cut.kind: the next two count, and of the cut neither angles nor radial depth
  double point_angle_rad = 0.0;        ///< of the drill [rad]; 0: not given
  double feed_per_revolution_m = 0.0;  ///< of the drill [m]
  std::vector<std::string> notes =
      {};                      ///< sentences for the user, of a material and of the files that load_dynamics() read
  std::string band_note = {};  ///< for the user where a band of the limits is computed
  std::vector<Assumption> assumed = {};               ///< of these files
  std::shared_ptr<const io::TomlFile> document = {};  ///< for errors in its words; empty where built in memory

  bool dropped_dynamics = false;  ///< by drop_dynamics()

  /// Forgets the tool's structure: another stands in its place.
  ROBOMILL_API void drop_dynamics();
  /// Checks what the problem still needs, with errors in the file's words where there is one: call it when dynamics is
  /// there.
  /// @throws InvalidInput
  ROBOMILL_API void validate() const;
};

/// Everything but the structure is checked. @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API LobesFile read_lobes(const io::TomlSource& source);

/// Reads the files of modes and of FRFs that it names, of the tool and of the workpiece, into its problem; of a cell
/// the modes of its posture. Without [uncertainty] these bring their own.
/// @throws InvalidInput also where an exponential window's damping is still in FRFs (without modes it stays
///     there), and where milling needs a direction that was not measured and the file does not say what it is taken for
ROBOMILL_API void load_dynamics(LobesFile& file, Progress& progress = Progress::none());

/// Takes the modes of a cell's posture as the tool's structure, with the uncertainty that they come with.
ROBOMILL_API void take_posture(LobesFile& file, std::shared_ptr<const cell::ModesOfPosture> posture);

/// The sweep that its table [lobes] asks for. Points of an angle were read as mm and are degrees.
[[nodiscard]] ROBOMILL_API stability::SweepOptions sweep_options(const LobesFile& file);

/// @param hint  for whoever gave another cut
/// @throws InvalidInput unless the cut is milling with an upright flat end, in x and y
ROBOMILL_API void require_plane(const LobesFile& file, const std::string& hint = {});

/// @throws InvalidInput if a cut in three directions names FRFs
ROBOMILL_API void require_modes_in_three_directions(const LobesFile& file);

/// A milling cut in x and y with the structure that its file names, everything checked.
/// @param hint  for whoever gave another cut
/// @throws InvalidInput as read_lobes, load_dynamics and validate, or as require_plane
[[nodiscard]] ROBOMILL_API LobesFile read_milling(const std::filesystem::path& path, const std::string& hint = {});

}  // namespace robomill::jobs
