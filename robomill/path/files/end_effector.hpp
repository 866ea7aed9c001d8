#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <string>

// Method: robomill/path/README.md, "Files"

namespace robomill::path {

/// A digital output of a controller: a number (KUKA, Universal Robots) or the name of a signal (ABB).
struct DigitalOutput {
  std::optional<int> number = {};
  std::string signal = {};
  [[nodiscard]] bool given() const { return number.has_value() || !signal.empty(); }
};

/// The spindle on the flange as a controller must know it: [tool] and [spindle] of cell.toml.
struct EndEffector {
  std::optional<int> tool_number = {};           ///< KUKA: of TOOL_DATA
  std::optional<int> load_number = {};           ///< KUKA: of LOAD_DATA; not given: the tool's number
  std::string tool_name = {};                    ///< ABB: of a tooldata on the controller
  std::optional<double> mass_kg = {};            ///< > 0; of all that hangs on the flange
  std::optional<Eigen::Vector3d> center_m = {};  ///< its centre of mass in the flange frame
  Eigen::Isometry3d tip =
      Eigen::Isometry3d::Identity();  ///< frame at the tip in the flange frame, z away from the flange
  DigitalOutput spindle = {}, coolant = {};
  double spin_up_s = 5.0;  ///< >= 0; waited for after the spindle was switched on

  /// Where the mass is taken to hang where nobody said: half-way to the tip.
  [[nodiscard]] Eigen::Vector3d center() const { return center_m.value_or(0.5 * tip.translation()); }
};

}  // namespace robomill::path
