#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robomill/report/report.hpp"

namespace robomill::report {

/// The report in shop units, as report_json writes it. Texts are valid UTF-8.
[[nodiscard]] nlohmann::ordered_json shop_units(const Report& report);

/// Its part on a smoothed program.
[[nodiscard]] nlohmann::ordered_json smooth_json(const Smooth& smooth);

/// Whether every run of a curve is one sample.
[[nodiscard]] bool is_single(const signal::Band& band);
/// Where the values of band_json stand, for each of `runs`: with `points` its one value at its begin; else its lowest
/// and highest value a quarter before and after its middle.
[[nodiscard]] nlohmann::ordered_json run_times_json(Eigen::Index runs, bool points, double run_s);
[[nodiscard]] nlohmann::ordered_json band_json(const signal::Band& band, bool points, double unit = 1.0);

/// To six significant digits; null unless finite.
[[nodiscard]] nlohmann::ordered_json number(double value);
/// SI to a shop unit: the edge of the stage.
[[nodiscard]] nlohmann::ordered_json number(double si, double unit);
[[nodiscard]] nlohmann::ordered_json numbers(const Eigen::VectorXd& si, double unit = 1.0);
/// Bytes that are no UTF-8 become U+FFFD, so that a stray file name cannot break the page.
[[nodiscard]] nlohmann::ordered_json text(const std::string& raw);
[[nodiscard]] nlohmann::ordered_json facts_json(const std::vector<Fact>& facts);
[[nodiscard]] nlohmann::ordered_json texts(const std::vector<std::string>& raw);

}  // namespace robomill::report
