#pragma once
#include <string>

#include "robomill/io/table_info.hpp"

namespace robomill::jobs {

struct SignalCoefficientsResult;

/// signal_coefficients.json
[[nodiscard]] const io::TableInfo& signal_coefficients_document();
[[nodiscard]] std::string signal_coefficients_json(const SignalCoefficientsResult& result);
/// coefficients.toml, with how well each is known in remarks.
[[nodiscard]] std::string signal_coefficients_toml(const SignalCoefficientsResult& result);

}  // namespace robomill::jobs
