#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>

#include "robomill/signal/bands.hpp"

/// Rules that the parts of a report share. Each throws InvalidInput naming the field.
namespace robomill::report {

/// "channels[1].wave"
[[nodiscard]] std::string member(std::string_view list, std::size_t index, std::string_view name);
/// Finite, and each value above the one before.
void require_axis(const std::string& field, const Eigen::VectorXd& axis);
void require_length(const std::string& field, Eigen::Index length, Eigen::Index expected, bool may_be_empty);
void require_all_finite(const std::string& field, const Eigen::Ref<const Eigen::MatrixXd>& values);
/// Finite, and `runs` values on both sides.
void require_band(const std::string& field, const signal::Band& band, Eigen::Index runs, bool may_be_empty);

}  // namespace robomill::report
