#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// The drawing of an assembly, to scale, as SVG that stands without script and takes its colours from the page.
namespace robomill::report {

/// Where labels of these widths stand side by side in their order, none over another: each as near to its target as
/// the others allow (least squares), within [low, high] where all fit.
/// @return their centres, as many as targets
[[nodiscard]] std::vector<double> side_by_side(const std::vector<double>& targets, const std::vector<double>& widths,
                                               double low, double high);

/// @param assembly  as assembly_json writes it
[[nodiscard]] std::string assembly_drawing(const nlohmann::ordered_json& assembly);

}  // namespace robomill::report
