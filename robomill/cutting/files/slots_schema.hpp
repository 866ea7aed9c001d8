#pragma once
#include "robomill/io/table_info.hpp"

namespace robomill::cutting {

/// coefficients.json
[[nodiscard]] const io::TableInfo& coefficients_document();

}  // namespace robomill::cutting
