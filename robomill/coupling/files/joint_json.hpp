#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/coupling/joint_fit.hpp"

// Method: robomill/coupling/README.md, "Files"

namespace robomill::coupling {

/// joint.json as text: the joint in the keys of assembly.toml, how well it fits and what the FRF shows of it. A
/// deviation that is infinite is null.
[[nodiscard]] ROBOMILL_API std::string joint_json(const JointFitResult& result);

}  // namespace robomill::coupling
