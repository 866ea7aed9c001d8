#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/modal/posture_model.hpp"

// Method: robomill/cell/README.md, "Dynamics of a posture (`dynamics.hpp`)"

namespace robomill::cell {

/// The dynamics of a cell's robot over its postures, from what [[postures]] name and from the cell's own numbers.
struct CellDynamics {
  std::shared_ptr<const modal::PostureModel> model;
  /// Modes of each measured posture by its name, where they are interpolated; else empty.
  std::map<std::string, std::size_t> modes_of = {};
  /// How far xx, yy and zz are likely off, the mean over the measured postures; NaN where unknown.
  Eigen::Vector3d direct_deviation = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Sentences for the user, of the files read and of the calibration.
  std::vector<std::string> warnings = {}, notes = {};
  std::vector<Assumption> assumed = {};

  /// As model->at. @throws InvalidInput also where the measured postures have no mode in common there
  [[nodiscard]] ROBOMILL_API modal::PosturePrediction at(const Eigen::VectorXd& joints) const;
  /// Modes of the nearest measured posture that the others have no counterpart of: they are left out.
  [[nodiscard]] ROBOMILL_API std::size_t unmatched(const modal::PosturePrediction& prediction) const;
};

/// Reads the FRFs and modes of [[postures]], turns them into base axes and calibrates the model.
/// @throws InvalidInput with file, line and posture; Interrupted
[[nodiscard]] ROBOMILL_API CellDynamics cell_dynamics(const Cell& cell, Progress& progress = Progress::none());

/// Whether the calibration of [[postures]] is kept beside the cell, in sentences; none of a cell without them.
[[nodiscard]] ROBOMILL_API std::vector<std::string> calibration_notes(const Cell& cell);

/// Axes that a posture's modes are written in: the robot's base, or its flange before any mount.
enum class PostureAxes { base, flange };
inline constexpr Name<PostureAxes> posture_axes_names[] = {{"base", PostureAxes::base},
                                                           {"flange", PostureAxes::flange}};

/// The dynamics of one posture of a cell.
struct ModesOfPosture {
  std::vector<double> joints = {};  ///< [rad or m]
  modal::PosturePrediction prediction;
  modal::PostureReport report;
  /// How far xx, yy and zz in base axes are likely off there (PostureModel::direct_deviation); NaN where unknown.
  Eigen::Vector3d direct_deviation = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  double axis_off_z_rad = 0.0;                         ///< of the tool's axis from the base's z
  std::size_t unmatched = 0;                           ///< as CellDynamics::unmatched
  std::vector<std::string> warnings = {}, notes = {};  ///< of the files read and of the calibration
  std::vector<Assumption> assumed = {};
};
/// @param joints  one value a joint [rad or m]
/// @throws InvalidInput as cell_dynamics, or naming "joints[k]" (k from 1) that is outside its limits
[[nodiscard]] ROBOMILL_API ModesOfPosture posture_modes(const std::filesystem::path& cell,
                                                        const std::vector<double>& joints,
                                                        PostureAxes axes = PostureAxes::base,
                                                        Progress& progress = Progress::none());

/// The same of each of the cell's [[postures]], in their order, by one calibration.
/// @throws InvalidInput also where the cell has none
[[nodiscard]] ROBOMILL_API std::vector<ModesOfPosture> modes_of_postures(const std::filesystem::path& cell,
                                                                         PostureAxes axes = PostureAxes::base,
                                                                         Progress& progress = Progress::none());

/// What to do about axes that nobody hit along, where the cut depends on them: a sentence, empty where all were
/// measured.
/// @param deviation  of xx, yy and zz
/// @param asked      whether each axis matters
[[nodiscard]] ROBOMILL_API std::string unmeasured_axes_text(const modal::PostureReport& report,
                                                            const Eigen::Vector3d& deviation,
                                                            const std::array<bool, 3>& asked = {true, true, true});

/// Those of the calibration, and sentences about this posture: how far it lies outside the measured region, modes left
/// out, axes that nobody hit along.
/// @param asked  as of unmeasured_axes_text
[[nodiscard]] ROBOMILL_API std::vector<std::string> posture_warnings(const ModesOfPosture& posture,
                                                                     const std::array<bool, 3>& asked = {true, true,
                                                                                                         true});
/// modes.json of a posture: its modes, and under "posture" where it is and how well it is known.
[[nodiscard]] ROBOMILL_API std::string posture_modes_json(const ModesOfPosture& posture);

}  // namespace robomill::cell
