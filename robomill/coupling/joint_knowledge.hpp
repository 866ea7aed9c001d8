#pragma once
#include <array>
#include <string>
#include <vector>

#include "robomill/coupling/joint_hybrid.hpp"

namespace robomill::coupling::detail {

/// What the measured FRF shows of each unknown, linearised at the joint found: the inverse of JᵀJ over flexibilities
/// and dampings, times the variance of the residuals and their correlation length, or the worst that an error of
/// noise_floor |H| can do, whichever is larger. Sentences for the user go to notes.
[[nodiscard]] std::array<JointKnowledge, joint_unknowns> joint_knowledge(const JointModel& model,
                                                                         const JointValues& joint,
                                                                         const JointData& data,
                                                                         const JointFitOptions& options,
                                                                         std::vector<std::string>& notes);

}  // namespace robomill::coupling::detail
