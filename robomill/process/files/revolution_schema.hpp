#pragma once
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {

/// One revolution with the sign of what is written.
struct RevolutionView {
  const RevolutionForces* revolution = nullptr;
  double sign = 1.0;
  [[nodiscard]] const cutting::CuttingForce& force() const { return revolution->deflected.force; }
  [[nodiscard]] bool on_robot() const { return revolution->posture.has_value(); }
};

/// The keys of forces.json over one revolution.
[[nodiscard]] std::vector<io::Row<RevolutionView>> revolution_rows();

}  // namespace robomill::process
