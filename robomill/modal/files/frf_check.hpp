#pragma once
#include <Eigen/Core>
#include <string>

#include "robomill/modal/files/frf_parts.hpp"

/// Whether what was read as an FRF can be one.
namespace robomill::modal {

/// @throws InvalidInput with where, if these steps are those of a time record: an FRF with lines so near would need a
///     record of minutes
void require_frequencies(const Eigen::VectorXd& axis, const std::string& where);

/// Looks at receptances: their size, the sign of a direct FRF's imaginary part, and whether they have one. Where the
/// file states what an FRF holds, what is odd becomes a note; where it does not, the reader's guess was wrong.
/// @throws InvalidInput with the likely content and what to write
void check_content(FrfParts& parts);

}  // namespace robomill::modal
