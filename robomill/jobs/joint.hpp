#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/modal/frf.hpp"

// Method: robomill/jobs/README.md, "Joints (`joint.hpp`)"

namespace robomill::jobs {

/// An assembly whose joint is sought, and what was measured at its tip.
struct JointJob {
  std::filesystem::path assembly;
  std::vector<std::filesystem::path> measured;  ///< FRFs of the tip
  std::vector<std::string> as = {};             ///< their names, as modal::read_frfs takes them
  coupling::JointMethod method = coupling::JointMethod::hybrid;
  std::optional<coupling::Mutation> mutation = {};  ///< not given: the assembly's
  modal::Axis axis = modal::Axis::x;                ///< which driving-point FRF is fitted: x or y
  std::uint64_t seed = 1;
};

struct JointResult {
  coupling::JointFitResult fit;
  modal::FrfSet measured;          ///< the lines within the assembly's range
  std::vector<std::string> notes;  ///< on the files: sentences for the user
  std::vector<Assumption> assumed = {};
};

/// Finds the joint with which the assembly's tip moves as measured: coupling::fit_joint over the measured lines within
/// the assembly's frequency.range_hz.
/// @throws InvalidInput naming the file, as read_assembly, read_frfs, lines_between and fit_joint, or if the measured
///     FRFs hold the damping of an exponential window
/// @throws Interrupted when progress asks to stop
[[nodiscard]] ROBOMILL_API JointResult run_joint(const JointJob& job, Progress& progress = Progress::none());

}  // namespace robomill::jobs
