#pragma once
#include <string>

#include "robomill/io/json.hpp"
#include "robomill/page/report.hpp"

namespace robomill::page {

/// The page's data, as report_json writes it. Texts are valid UTF-8.
[[nodiscard]] io::Json page_data(const Report& report);

/// To six significant digits; null unless finite.
[[nodiscard]] io::Json number(double value);
/// Bytes that are no UTF-8 become U+FFFD, so that a stray file name cannot break the page.
[[nodiscard]] io::Json text(const std::string& raw);

}  // namespace robomill::page
