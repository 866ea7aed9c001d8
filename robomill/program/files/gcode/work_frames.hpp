#pragma once
#include <optional>

namespace robomill::program {

/// The number of G54, in which a program without a code of a work frame is.
inline constexpr int first_work_frame = 540;

/// The number of the work frame that a G code names: the code in tenths, and 100,000 + P of the extended ones. G110 is
/// that of G154 P1.
/// @param tenths  of the code: 591 of G59.1
/// @param p       that names one of G54.1, G154 or G54; none: G54 alone
/// @return none where it names no work frame
[[nodiscard]] std::optional<int> work_frame_number(int tenths, std::optional<double> p);

/// … that G10 L2 P names: 1 is G54, 6 is G59, 9 is G59.3.
[[nodiscard]] std::optional<int> work_frame_of_table(double p);

/// Whether no G10 L2 names it.
[[nodiscard]] bool is_extended_frame(int number);

}  // namespace robomill::program
