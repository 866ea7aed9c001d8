#include "testing/modal/measured_arm.hpp"

#include <fmt/core.h>

#include <utility>

#include "robomill/modal/fit.hpp"

namespace robomill::modal::testing {

std::vector<MeasuredPosture> measure_postures(const SimulatedArm& arm, std::uint64_t seed) {
  std::vector<MeasuredPosture> out;
  for (const Eigen::VectorXd& joints : arm.measured_postures()) {
    const std::size_t p = out.size();
    out.push_back(
        {.name = fmt::format("postures[{}]", p + 1), .joints = joints, .frfs = arm.measure(joints, 1000 * seed + p)});
  }
  return out;
}

std::vector<PostureModes> fit_postures(const std::vector<MeasuredPosture>& measured) {
  std::vector<PostureModes> out;
  for (const MeasuredPosture& posture : measured) {
    ModalModel found = fit_modes(posture.frfs, {.max_modes = 30}).model;
    if (!found.modes.empty()) out.push_back({.joints = posture.joints, .modes = std::move(found)});
  }
  return out;
}

}  // namespace robomill::modal::testing
