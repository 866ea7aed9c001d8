#pragma once
#include "robomill/robot/arm.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::robot {

/// Whether axes 2, 3 and 4 of an arm of six revolute joints are parallel, within 0.01 rad, and apart, as of a Universal
/// Robots arm; axis 1 is parallel to none of them, axis 5 to neither 4 nor 6.
[[nodiscard]] bool has_parallel_axes(const Arm& arm);

/// The configuration of such an arm. Joints 2, 3 and 4 turn about n and move the wrist across n; joints 1, 5 and 6
/// must do the rest, so that
///     det J ~ [(p₃ − p₂) × (p₄ − p₃)]·n  ·  [z₅ × z₆]·n  ·  [z₁ × (m − p₁)]·n
/// with p_i on axis i and m the point of axis 6 that is nearest to axis 5. Elbow, wrist and shoulder are the signs of
/// the three factors.
[[nodiscard]] Configuration parallel_configuration(const Posture& posture) noexcept;

}  // namespace robomill::robot
