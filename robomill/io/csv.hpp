#pragma once
#include <initializer_list>
#include <string>
#include <string_view>

namespace robomill::io {

/// Within quotes; a quote is written twice, a line's end as a blank.
[[nodiscard]] std::string csv_text(std::string_view text);
/// Nine significant digits in a unit; empty where it is not finite.
[[nodiscard]] std::string csv_number(double value, double unit = 1.0);
/// Adds a row of cells and its line's end.
void add_csv_row(std::string& table, std::initializer_list<std::string> cells);

}  // namespace robomill::io
