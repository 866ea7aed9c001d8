#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/robot/files/loads_csv.hpp"
#include "robomill/robot/identify.hpp"

// Method: robomill/jobs/README.md, "Measurements and fits"

namespace robomill::jobs {

struct StiffnessJob {
  std::filesystem::path loads, cell;            ///< loads.csv, cell.toml
  std::optional<Eigen::Vector3d> point_m = {};  ///< where the loads attack, in the flange frame; none: the tool's tip
  std::filesystem::path output = {};  ///< what write_document() is asked for; as .toml only where it converges
};

struct StiffnessResult {
  cell::Cell cell;
  robot::LoadsFile loads;
  robot::IdentifiedStiffness found;
  std::vector<Assumption> assumed = {};
  std::filesystem::path output = {};  ///< the job's
  [[nodiscard]] bool converged() const { return found.status == robot::IdentifiedStiffness::Status::converged; }
};

/// Joint stiffness from loads and displacements.
/// @throws InvalidInput with file, line and key or column, or as robot::identify_joint_stiffness
[[nodiscard]] ROBOMILL_API StiffnessResult run_stiffness(const StiffnessJob& job);

}  // namespace robomill::jobs
