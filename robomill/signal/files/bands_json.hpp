#pragma once
#include "robomill/io/json.hpp"
#include "robomill/signal/bands.hpp"

namespace robomill::signal {

/// {"low": […], "high": […]} in a shop unit.
[[nodiscard]] io::Json band_json(const Band& band, double unit = 1.0);

}  // namespace robomill::signal
