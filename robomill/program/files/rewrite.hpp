#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/program/README.md, "Rewriting"

namespace robomill::program {

/// A program's text with other speeds, feeds, positions or tool axes.
struct Rewritten {
  std::string text;                ///< the whole program
  std::size_t changed_lines = 0;   ///< of the program, with its calls expanded
  std::size_t added_lines = 0;     ///< … beside the header's
  std::size_t first_changed = 0;   ///< the program's first line that is changed, preceded by another, or calls; 0: none
  std::size_t expanded_calls = 0;  ///< of subprograms: a call that repeats counts as often
};

/// The program with other spindle speeds, feeds, positions and tool axes, in its own dialect; what needs no change
/// keeps its bytes.
///
/// The new text is read again by the program's reader. Each block must then be the wanted one: its tip within 0.2 um
/// (0.1 um and the digits written), its axis within 1e-7 rad, its speed and its feed within 1e-5 (the feed beyond by
/// what the digits change of the way's length); kind, spindle, coolant, stops and the line that it comes from alike.
/// While the spindle is off its speed does not count.
///
/// Moves that turn the axis may come back as several blocks, because a machine's A, B and C that turn evenly leave a
/// great circle:
/// - At feed, a wanted block is written in as many lines as keep the axis within reading.axis_tolerance_rad of its
///   great circle at the same time. Where each ends tip and axis are on the wanted way.
/// - A rapid stays one line where its tips run evenly along a line. Its end is the wanted one; between, the axis goes
/// as
///   the machine turns, and the wanted blocks' axes there do not count.
///
/// Calls of subprograms are expanded: their lines stand in the place of the call, as often as it runs them, so that
/// each pass has its own feeds, speeds and positions. Definitions are left out, and so is what stands behind the
/// program's end. A comment behind those of the header has their number. Blocks of several passes have the same line:
/// their order counts. The expanded program has at most 64 MB.
///
/// A feed is the wanted way over the wanted time: whoever moves tips and means to keep feeds scales the times by the
/// ways.
///
/// @param reading  as the program was read; machine and rotary say what A, B and C of the new text do
/// @param as_read  what read_program gives for the file
/// @param wanted   the same blocks and start with other spindle_speed_rad_per_s, other duration_s of feed moves, other
///     tips and other axes; kinds and all else are those of as_read. Axes are unit vectors within 1e-9
/// @param header   sentences that become comments at the program's head, one a line. What is not plain ASCII becomes
///     a question mark, parentheses in G-code brackets
/// @throws InvalidInput with file and line: as read_program; as_read is not the file's; wanted differs in what cannot
///     be rewritten; and what the dialect cannot say, as an axis in G-code without a machine or in APT without MULTAX
[[nodiscard]] ROBOMILL_API Rewritten rewrite_program(const std::filesystem::path& path, const ProgramReading& reading,
                                                     const Program& as_read, const Program& wanted,
                                                     const std::vector<std::string>& header = {});

/// The same of a text in memory.
/// @param name  as of a file, for errors; its ending is the format's where the reading names none
[[nodiscard]] ROBOMILL_API Rewritten rewrite_program_text(const std::string& text, const std::filesystem::path& name,
                                                          const ProgramReading& reading, const Program& as_read,
                                                          const Program& wanted,
                                                          const std::vector<std::string>& header = {});

}  // namespace robomill::program
