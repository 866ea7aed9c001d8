#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/modal/README.md, "FRFs to modes (`fit.hpp`)"

namespace robomill::modal {

/// What somebody takes a direction of the x-y plane to be that was not measured. Nothing said: it has to be measured.
struct MissingDirections {
  bool equal = false;            ///< like the measured one, without cross terms
  std::vector<Axis> rigid = {};  ///< x, y: these do not move
};

/// Those of x and y that the data does not know both as a response and as an excitation.
[[nodiscard]] ROBOMILL_API std::vector<Axis> unknown_directions(const ModalModel& model);
[[nodiscard]] ROBOMILL_API std::vector<Axis> unknown_directions(const FrfSet& set);

/// @param unknown  of the data that a cut is computed from
/// @throws InvalidInput naming "equal_directions" or "rigid_directions" if what is said does not fit what is unknown,
///     and without a field if something is unknown of which nothing is said
ROBOMILL_API void require_said(const std::vector<Axis>& unknown, const MissingDirections& said);

/// A structure of one measured direction with the other taken equal: every mode twice, in x and in y, without cross
/// terms. Mode k becomes modes 2k - 1 and 2k.
/// @throws InvalidInput unless there is one excitation and one response, both x or both y
[[nodiscard]] ROBOMILL_API ModalModel with_equal_directions(const ModalModel& model);
/// The same of a fit: its model, its errors and its bounds.
[[nodiscard]] ROBOMILL_API FitResult with_equal_directions(FitResult fit);
/// The same of one FRF, xx or yy. @throws InvalidInput if the set holds another, or several
[[nodiscard]] ROBOMILL_API FrfSet with_equal_directions(const FrfSet& set);

/// What stands in place of a measurement, with the option's name as key; nothing where nothing does.
[[nodiscard]] ROBOMILL_API std::optional<Assumption> assumed_of(const MissingDirections& said);

}  // namespace robomill::modal
