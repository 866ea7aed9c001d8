#pragma once
// What somebody measures on a simulated arm, for judging models over postures.
#include <cstdint>
#include <vector>

#include "robomill/modal/posture/inverse_distance.hpp"
#include "robomill/modal/posture_model.hpp"
#include "testing/modal/simulated_arm.hpp"

namespace robomill::modal::testing {

/// FRFs of the arm's twelve measured postures, each with noise of its own.
[[nodiscard]] std::vector<MeasuredPosture> measure_postures(const SimulatedArm& arm, std::uint64_t seed);

/// The modes that `fit_modes` finds in each. A fit that finds nothing makes no posture.
[[nodiscard]] std::vector<PostureModes> fit_postures(const std::vector<MeasuredPosture>& measured);

}  // namespace robomill::modal::testing
