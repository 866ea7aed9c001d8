#pragma once
#include "robomill/coupling/joint_model.hpp"

namespace robomill::coupling::detail {

/// ‖ |H| - |H model| ‖₂.
[[nodiscard]] double magnitude_misfit(const JointModel& model, const JointValues& joint,
                                      const Eigen::ArrayXd& magnitude, JointModel::Response& scratch);

/// The genetic algorithm as published; what the publication leaves open is said in README.md.
/// @param options  with its bounds set
[[nodiscard]] JointSearch search_by_genes(const JointModel& model, const Eigen::VectorXcd& measured,
                                          const JointFitOptions& options, Progress& progress);

}  // namespace robomill::coupling::detail
