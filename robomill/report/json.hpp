#pragma once
#include <nlohmann/json.hpp>

#include "robomill/report/report.hpp"

namespace robomill::report {

/// The report in shop units, as report_json writes it. Texts are valid UTF-8.
[[nodiscard]] nlohmann::ordered_json shop_units(const Report& report);

}  // namespace robomill::report
