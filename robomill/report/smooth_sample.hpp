#pragma once
#include <array>
#include <vector>

#include "robomill/path/sample.hpp"
#include "robomill/program/program.hpp"
#include "robomill/report/smooth.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::report {

/// A machine of three slides and two turns of the axis, for tests: q = (x, y, z, A, B).
class SampleMachine final : public robot::Kinematics {
 public:
  SampleMachine();
  [[nodiscard]] int joints() const noexcept override { return 5; }
  [[nodiscard]] const robot::JointLimits& limits() const noexcept override { return limits_; }
  [[nodiscard]] bool turns_about_axis() const noexcept override { return false; }
  [[nodiscard]] int all(const robot::ToolPose& pose, robot::Position6* out, int room) const noexcept override;
  [[nodiscard]] robot::Reach follow(const robot::ToolPose& pose, const robot::Position6& near,
                                    robot::Position6& position) const noexcept override;
  [[nodiscard]] robot::Reach follow(const robot::ToolJet& jet, const robot::Position6& near,
                                    robot::JointJet& joints) const noexcept override;
  [[nodiscard]] robot::ToolPose forward(const robot::Position6& position) const noexcept override;
  [[nodiscard]] double regularity(const robot::Position6&) const noexcept override { return 1.0; }

 private:
  robot::JointLimits limits_;
};

/// A zigzag with a leaning axis.
[[nodiscard]] program::Program sample_program();

/// That program at an even speed through two moving averages.
/// @param averages_s  their lengths
[[nodiscard]] std::vector<path::Sample> sample_motion(const program::Program& program, const SampleMachine& machine,
                                                      double speed_m_per_s, const std::array<double, 2>& averages_s);

/// Three such motions as a report's part. Nothing in it is a prediction.
[[nodiscard]] Smooth sample_smooth();

}  // namespace robomill::report
