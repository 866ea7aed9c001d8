#pragma once
#include <filesystem>
#include <optional>
#include <string_view>

#include "robomill/base/export.hpp"
#include "robomill/program/machine.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/program/README.md, "Files"

namespace robomill::program {

/// "xyzac-trt", "xyzbc-trt", "xyzac-head", "xyzbc-head".
/// @throws InvalidInput naming the field program.machine
[[nodiscard]] ROBOMILL_API Machine parse_machine(std::string_view name);

/// Reads a whole program of G-code (.ngc .nc .gcode), whatever its ending, with the default ProgramReading: moves G0
/// and G1, arcs G2 and G3, and dwells G4, in mm or inches (G21, G20), absolute or incremental (G90, G91), with F in
/// mm/min (G94; deg/min where only the axis moves) or as the inverse of the move's minutes (G93). The axis comes from
/// A, B and C in degrees, each turning evenly over its move, or from I, J and K on lines of straight moves, its unit
/// vector. A program that says nothing
/// else is in mm, absolute, G94, G17, its axis along z.
///
/// Arcs lie in the plane G17, G18 or G19 and rise along its normal; I, J and K are their centre, counted from the begin
/// (G91.1) or not (G90.1), or R their radius, negative beyond half a turn; P is the number of turns begun. They become
/// equal chords, whose ends lie on the arc; A, B and C turn evenly with it. The radius at an arc's end may differ from
/// that at its begin by 5 um (inches: 12.7 um) or a thousandth of it, at most by 0.5 mm [LinuxCncGcode].
/// The time of a dwell is P in seconds.
///
/// The first line after which X, Y and Z are all known makes the start. Moves that move nothing are left out. Spindle
/// and coolant stand with each block, M0 and M1 as dwells with `operator_stop`; harmless M codes, tools, offsets'
/// numbers and G codes that move nothing stand in `skipped`.
/// @param machine  what A, B and C mean; a program without them needs none
/// @throws InvalidInput with file, line, word and value: what cannot be read, feeds that are missing or not above 0,
///     two G codes of one group, words of axes that the machine does not have, arcs whose radius does not fit, and
///     codes that would move the tool or its frame in ways that are not read (cycles, splines, offsets G10 and G92,
///     other coordinate systems, G28), M codes not known to be harmless, and moves after another tool, another length
///     or the end of the tool centre point
[[nodiscard]] ROBOMILL_API Program read_gcode(const std::filesystem::path& path, std::optional<Machine> machine = {});

}  // namespace robomill::program
