#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/program/files/program_files.hpp"

namespace robomill::program {

/// A program in G-code with the lines of its subprograms in the place of their calls.
struct ExpandedCalls {
  std::string text = {};
  std::vector<std::size_t> origins = {};  ///< of each line of the text: the program's line that it is
  std::size_t passes = 0;                 ///< of subprograms; 0: the program calls none
  std::size_t first = 0;                  ///< line of the text that calls first
};

/// Whether some line of a program in G-code may call a subprogram.
[[nodiscard]] bool may_call(std::string_view text, const std::string& file);

/// Follows the calls as the program's reader does, and copies the lines as they come.
///
/// - M98, M97, M99 with their P and L, and the O words of calls become comments; so do deleted lines (/) that contain
///   them, which would run where the machine's switch is off.
/// - Lines of subprograms lose their N, which would come more than once.
/// - Definitions (o sub … endsub) and what stands behind the program's end are left out, but for the % that closes it.
///
/// @param file  its name, for errors
/// @throws InvalidInput with file and line: as the reader; a call in a statement over several lines; a text of more
///     than GcodeCalls::most_bytes, or more lines than are affordable
[[nodiscard]] ExpandedCalls expand_calls(std::string_view text, const std::string& file, const ProgramReading& reading);

/// The error at the program's line in place of that of a text made from it.
/// @param origins  of each line of that text: the program's line; 0: none
[[nodiscard]] InvalidInput at_origin(const InvalidInput& error, const std::string& file,
                                     const std::vector<std::size_t>& origins);

}  // namespace robomill::program
