#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/robot/dynamics.hpp"

// Method: robomill/process/README.md, "Forces (`forces.hpp`)"

namespace robomill::process {

/// A cutter in a material: one revolution of one cut, or what every block of a program has alike.
struct Cut {
  std::filesystem::path path = {};  ///< of the file that describes it, for messages; empty where there is none
  cutting::Cutter cutter = {};
  cutting::Cut cut = {};  ///< along a program the engagement comes from the workpiece, and this one has no part
  cutting::MillingCoefficients coefficients = {};
  cutting::CutMotion motion = {};  ///< along a program only its speed counts, 0: the program's own
  cutting::ForceOptions force = {};
  int slices = 0;                                             ///< rings of the engagement; 0: chosen
  bool on_workpiece = false;                                  ///< forces are reported as they act on the workpiece
  std::vector<double> joints_rad = {};                        ///< the posture of a single cut; empty: no robot
  Eigen::Vector3d feed_direction = Eigen::Vector3d::UnitX();  ///< of a single cut, in W
  bool robot_vibrates = false;                                ///< its joints and masses take part in the vibration
  robot::Inertia robot_inertia = robot::Inertia::full;        ///< … with this of its masses
  double feed_direction_rad = 0.0;                            ///< in the axes of the structures
  modal::ModalModel dynamics = {}, workpiece_dynamics = {};   ///< what vibrates; no modes where absent
  std::optional<cutting::Stock> stock = {};                   ///< none: a box around the program
  bool neighbours = false;                                    ///< no stock, but the neighbouring pass of each block
  double dexel_m = 0.25e-3;
  double power_time_s = 0.1;             ///< over which a program's power is a mean for the spindle
  std::vector<Assumption> assumed = {};  ///< of all this
  std::vector<std::string> notes = {};   ///< sentences for the user, of a material that is named
};

}  // namespace robomill::process
