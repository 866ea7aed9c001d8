#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "robomill/io/records/uff.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

/// Data set 164: metre, newton, kelvin.
constexpr const char* si_units =
    "    -1\n   164\n         1SI: Meter (newton)            2\n"
    "  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00\n"
    "  2.73149999999999977D+02\n    -1\n";

/// As many digits as go into 12 characters: more than E13.5 has, in the same columns.
std::string in_12_characters(double number) {
  for (int digits = 12; digits > 5; --digits) {
    std::string text = fmt::format("{:.{}g}", number, digits);
    if (text.size() <= 12) return text;
  }
  return fmt::format("{:.5g}", number);
}

/// What a reader makes of in_12_characters.
double as_read(double number) {
  return parse_number(in_12_characters(number)).value_or(number);
}

bool is_even(const Eigen::VectorXd& abscissa, double tolerance) {
  const Eigen::Index n = abscissa.size();
  if (n < 2) return true;
  const double first = as_read(abscissa(0));
  const double step = as_read((abscissa(n - 1) - abscissa(0)) / static_cast<double>(n - 1));
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(std::abs(first + static_cast<double>(i) * step - abscissa(i)) <= tolerance * std::abs(step))) return false;
  }
  return true;
}

std::string line_of_text(const std::string& text) {
  std::string line = text.substr(0, 80);
  for (char& letter : line) {
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  }
  return fmt::format("{:<80}\n", line);
}

void append_axis(std::string& out, const UffAxis& axis) {
  out += fmt::format("{:10}{:5}{:5}{:5} {:<20.20} {:<20.20}\n", axis.type, axis.length_exponent, axis.force_exponent, 0,
                     axis.label, axis.unit);
}

void append_bytes(std::string& out, double number) {
  const auto bits = std::bit_cast<std::uint64_t>(number);
  for (int place = 0; place < 64; place += 8) out += static_cast<char>(static_cast<unsigned char>(bits >> place));
}

void append_values(std::string& out, const UffFunction& function, bool even, bool binary) {
  const std::size_t points_a_line = even ? (function.is_complex ? 2 : 4) : (function.is_complex ? 1 : 2);
  for (Eigen::Index i = 0; i < function.values.size(); ++i) {
    const std::complex<double> value = function.values(i);
    if (binary) {
      if (!even) append_bytes(out, function.abscissa(i));
      append_bytes(out, value.real());
      if (function.is_complex) append_bytes(out, value.imag());
      continue;
    }
    if (!even) out += fmt::format(" {:>12}", in_12_characters(function.abscissa(i)));
    out += fmt::format("{:20.12E}", value.real());
    if (function.is_complex) out += fmt::format("{:20.12E}", value.imag());
    const bool line_full = static_cast<std::size_t>(i) % points_a_line == points_a_line - 1;
    if (line_full || i + 1 == function.values.size()) out += '\n';
  }
}

void append_function(std::string& out, const UffFunction& function, bool binary) {
  const Eigen::Index n = function.values.size();
  const bool even = is_even(function.abscissa, binary ? 1e-9 : 1e-6);
  const Eigen::Index numbers = n * ((function.is_complex ? 2 : 1) + (even ? 0 : 1));
  out += "    -1\n";
  out += binary ? fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n", 1, 2, 11, 8 * numbers, 0, 0, 0, 0)
                : fmt::format("{:<80}\n", "    58");
  for (const std::string& id : function.id) out += line_of_text(id);
  out += fmt::format("{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n", function.type, 0, 0, 0, "NONE",
                     function.response_node, function.response_direction, "NONE", function.reference_node,
                     function.reference_direction);
  const double first = n > 0 && even ? function.abscissa(0) : 0.0;
  const double step =
      n > 1 && even ? (function.abscissa(n - 1) - function.abscissa(0)) / static_cast<double>(n - 1) : 0.0;
  out += fmt::format("{:10}{:10}{:10} {:>12} {:>12} {:>12}\n", function.is_complex ? 6 : 4, n, even ? 1 : 0,
                     in_12_characters(first), in_12_characters(step), "0.00000E+00");
  append_axis(out, function.abscissa_axis);
  append_axis(out, function.numerator);
  append_axis(out, function.denominator);
  append_axis(out, UffAxis{});
  append_values(out, function, even, binary);
  out += "    -1\n";
}

}  // namespace

std::string format_uff(const std::vector<UffFunction>& functions, bool binary) {
  std::string out = si_units;
  for (const UffFunction& function : functions) append_function(out, function, binary);
  return out;
}

}  // namespace robomill::io
