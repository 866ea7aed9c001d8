#pragma once
#include <optional>
#include <stdexcept>
#include <string>

#include "robomill/base/export.hpp"

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// Bad input, reported so that the user can correct it: where, which field, its value and unit, the rule it breaks, the
/// likely cause.
///
/// A stage throws it with the SI member's name ("tangential_n_per_m2"); files/ rethrows it with the file, the line
/// and the file's own key, value and unit. what() reads "where: field = value unit; rule. hint", empty parts left out.
class ROBOMILL_API InvalidInput : public std::runtime_error {
 public:
  struct Parts {
    std::string where = {};             ///< "lobes.toml:14", a JSON path, empty while unknown
    std::string field = {};             ///< "axial_depth_m"
    std::optional<double> number = {};  ///< the value, where it is a number; files/ converts it
    std::string value = {};             ///< the value as text, where it is none
    std::string unit = {};              ///< "m"
    std::string rule = {};              ///< "must be > 0"
    std::string hint = {};              ///< "Aluminium is near 700; did you pass N/m^2?"
  };
  explicit InvalidInput(Parts parts);
  /// field = number unit; rule. hint
  InvalidInput(std::string field, double number, std::string unit, std::string rule, std::string hint = {});
  /// field: rule. hint (where there is no one number: a length, a missing file)
  InvalidInput(std::string field, std::string rule, std::string hint = {});

  [[nodiscard]] const Parts& parts() const noexcept { return parts_; }

 private:
  Parts parts_;
};

/// The same error of a member of something larger: its field reads prefix + field, "tool[1]." + "length_m".
[[nodiscard]] ROBOMILL_API InvalidInput within(const std::string& prefix, const InvalidInput& error);

/// Throws InvalidInput unless number is finite and > 0.
ROBOMILL_API void require_positive(const char* field, double number, const char* unit, const char* hint = "");
/// Throws InvalidInput unless number is finite and >= 0.
ROBOMILL_API void require_non_negative(const char* field, double number, const char* unit, const char* hint = "");
/// Throws InvalidInput unless number is finite.
ROBOMILL_API void require_finite(const char* field, double number, const char* unit, const char* hint = "");

}  // namespace robomill
