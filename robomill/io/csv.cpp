#include "robomill/io/csv.hpp"

#include <fmt/format.h>

#include <cmath>

namespace robomill::io {

std::string csv_text(std::string_view text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '"') out += '"';
    out += letter == '\n' || letter == '\r' ? ' ' : letter;
  }
  return out + "\"";
}

std::string csv_number(double value, double unit) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value / unit) : std::string();
}

void add_csv_row(std::string& table, std::initializer_list<std::string> cells) {
  bool first = true;
  for (const std::string& cell : cells) {
    if (!first) table += ',';
    first = false;
    table += cell;
  }
  table += '\n';
}

}  // namespace robomill::io
