#pragma once
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "robomill/cell/check.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/kinematics/images.hpp"

namespace robomill::cell {

/// Up to six joints; the rest, or all of an empty list, at 0.
[[nodiscard]] robot::Position6 position_of(const std::vector<double>& joints);

/// Which poses of the tool a machine can take, with the workpiece where it is put.
class ToolPlaces {
 public:
  /// @param cell       a machine that kinematics() takes; outlives this object
  /// @param workpiece  W in B
  ToolPlaces(const Cell& cell, const Eigen::Isometry3d& workpiece);

  /// A way to stand at a pose.
  struct Stand {
    robot::Position6 position = robot::Position6::Zero();
    double gamma_rad = 0.0;
    double margin = 0.0;  ///< path::Margin's least, there
  };
  struct Found {
    std::optional<Stand> stand = {};
    Miss miss = {};  ///< without one: why
  };
  /// The way with the largest margin, of all branches and all turns about the tool's axis that are free; of those that
  /// are alike the one near home. An arm without closed form is searched at a third of the turns.
  [[nodiscard]] Found find(const program::Pose& pose) const;
  /// The way that follows from another one at the same turn; none where it ends there.
  [[nodiscard]] std::optional<Stand> follow(const program::Pose& pose, const Stand& before) const;
  /// A way by what is quick alone: of an arm without closed form those to which Newton's steps lead from a stand, or
  /// from elbow and wrist bent either way.
  [[nodiscard]] std::optional<Stand> find_quickly(const program::Pose& pose, const Stand& near) const;

  [[nodiscard]] const robot::Kinematics& machine() const { return *machine_; }

 private:
  static constexpr std::size_t most_ways = 32;
  struct Ways {
    std::array<robot::Position6, most_ways> position;
    int count = 0;
    double out_of_reach_m = 0.0, out_of_reach_rad = 0.0;  ///< where there is none
  };
  [[nodiscard]] Ways ways_to(const robot::ToolPose& pose) const;
  [[nodiscard]] robot::Image image_of(int joint, double value) const;
  [[nodiscard]] double margin_of(const robot::Position6& position) const;
  struct Search;
  void consider(const robot::ToolPose& pose, const robot::Position6& way, Search& search) const;

  const Cell* cell_;
  robot::Cell arm_cell_;                                 ///< of a serial arm, with the workpiece
  std::unique_ptr<robot::Kinematics> machine_;           ///< within the joints' limits
  std::unique_ptr<robot::Kinematics> unlimited_;         ///< every branch once; none in closed form
  std::optional<robot::SphericalWristInverse> inverse_;  ///< of a spherical wrist
  robot::Position6 home_ = robot::Position6::Zero();
  std::vector<double> gamma_rad_;  ///< to try
};

}  // namespace robomill::cell
