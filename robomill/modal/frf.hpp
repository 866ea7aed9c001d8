#pragma once
#include <Eigen/Core>
#include <compare>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/modal/README.md, "Hammer hits to FRFs (`hits.hpp`)"

namespace robomill::modal {

/// Direction of a force or displacement: x, y, z along the axis of that name; rx, ry, rz a moment or rotation about it.
/// The numbers are those of UFF58.
enum class Axis : int { x = 1, y = 2, z = 3, rx = 4, ry = 5, rz = 6 };

/// One degree of freedom of the structure: a point and a direction at it. Point 0 is the unnumbered tool tip.
struct Dof {
  int point = 0;
  Axis axis = Axis::x;
  auto operator<=>(const Dof&) const = default;
};

/// Which FRF: response due to excitation. "xy" is x due to a force in y; "1x:3x" names points; "x:my" is x due to a
/// moment about y, "ry:x" the rotation about y due to a force in x, "ry:my" the rotation due to the moment.
struct FrfName {
  Dof response, excitation;
  auto operator<=>(const FrfName&) const = default;
};

/// "x", "3x", "ry"; an excitation's moment reads "my".
[[nodiscard]] ROBOMILL_API std::string to_string(const Dof& dof, bool as_excitation = false);
[[nodiscard]] ROBOMILL_API std::string to_string(const FrfName& name);
/// Inverse of to_string. @throws InvalidInput if text names no degree of freedom
[[nodiscard]] ROBOMILL_API Dof parse_dof(std::string_view text);
/// Inverse of to_string. @throws InvalidInput if text names no FRF
[[nodiscard]] ROBOMILL_API FrfName parse_frf_name(std::string_view text);

/// One receptance, displacement per force (m/N; rad/N, m/(N m), rad/(N m) where a rotation or moment is named), as
/// exp(+iωt).
struct Frf {
  FrfName name;
  Eigen::VectorXcd receptance;     ///< length n
  Eigen::VectorXd coherence = {};  ///< length n, in [0, 1]; empty where unknown
  Eigen::VectorXd deviation = {};  ///< length n: standard deviation of |receptance's error| (complex, E|e|^2 =
                                   ///< deviation^2); empty where unknown
};

/// Receptances over one common frequency axis.
struct FrfSet {
  Eigen::VectorXd frequency_hz;  ///< length n, strictly increasing, >= 0 [Hz]
  std::vector<Frf> frfs;

  /// @throws InvalidInput if empty, a length differs, a value is not finite, frequencies do not increase, or a name
  /// comes twice
  ROBOMILL_API void validate() const;
  /// The FRF of that name, or nullptr.
  [[nodiscard]] ROBOMILL_API const Frf* find(const FrfName& name) const;
};

}  // namespace robomill::modal
