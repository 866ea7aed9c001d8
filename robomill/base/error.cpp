#include "robomill/base/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "robomill/base/printable.hpp"

namespace robomill {
namespace {

// Names and values come from files. Line ends before an indent are ours.
std::string compose(const InvalidInput::Parts& p) {
  std::string text;
  if (!p.where.empty()) text += p.where + ": ";
  std::string subject = p.field;
  const std::string value = p.number ? fmt::format("{:.6g}", *p.number) : p.value;
  if (!value.empty()) {
    if (!subject.empty()) subject += " = ";
    subject += value;
    if (!p.unit.empty()) subject += " " + p.unit;
  }
  text = printable(text + subject);
  if (!p.rule.empty()) text += (subject.empty() ? "" : value.empty() ? ": " : "; ") + printable_lines(p.rule);
  if (!p.hint.empty()) text += ". " + printable_lines(p.hint);
  return text;
}

}  // namespace

InvalidInput::InvalidInput(Parts parts) : std::runtime_error(compose(parts)), parts_(std::move(parts)) {}

InvalidInput::InvalidInput(std::string field, double number, std::string unit, std::string rule, std::string hint)
    : InvalidInput(Parts{.field = std::move(field),
                         .number = number,
                         .unit = std::move(unit),
                         .rule = std::move(rule),
                         .hint = std::move(hint)}) {}

InvalidInput::InvalidInput(std::string field, std::string rule, std::string hint)
    : InvalidInput(Parts{.field = std::move(field), .rule = std::move(rule), .hint = std::move(hint)}) {}

InvalidInput within(const std::string& prefix, const InvalidInput& error) {
  InvalidInput::Parts parts = error.parts();
  parts.field = prefix + parts.field;
  return InvalidInput(std::move(parts));
}

void require_positive(const char* field, double number, const char* unit, const char* hint) {
  if (!(std::isfinite(number) && number > 0.0)) throw InvalidInput(field, number, unit, "must be > 0", hint);
}

void require_non_negative(const char* field, double number, const char* unit, const char* hint) {
  if (!(std::isfinite(number) && number >= 0.0)) throw InvalidInput(field, number, unit, "must be >= 0", hint);
}

void require_finite(const char* field, double number, const char* unit, const char* hint) {
  if (!std::isfinite(number)) throw InvalidInput(field, number, unit, "must be a finite number", hint);
}

}  // namespace robomill
