#include <array>
#include <cmath>
#include <string>

#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "robomill/program/program.hpp"
#include "testing/fuzz/input.hpp"
#include "testing/fuzz/reader.hpp"

namespace robomill::fuzz {
namespace {

void require_whole(const program::Program& read) {
  require(read.start.tip_m.allFinite() && std::abs(read.start.axis.norm() - 1.0) < 1e-9, "a start is a pose");
  for (const program::Block& block : read.blocks) {
    require(block.end.tip_m.allFinite(), "positions are finite");
    require(std::abs(block.end.axis.norm() - 1.0) < 1e-9, "axes are unit vectors");
    require(std::isfinite(block.duration_s) && block.duration_s >= 0.0, "times are finite");
    require(std::isfinite(block.spindle_speed_rad_per_s), "spindle speeds are finite");
  }
}

/// A program, and the same written at half its feeds, which its own reader checks.
void read_program(std::string_view bytes, const std::string& name, const program::ProgramReading& reading) {
  accept_or_reject([&] {
    const std::string text(bytes);
    const program::Program read = program::read_program_text(text, name, reading);
    require_whole(read);
    program::Program slower = read;
    for (program::Block& block : slower.blocks) {
      if (block.kind == program::Block::Kind::feed) block.duration_s *= 2.0;
    }
    const program::Rewritten written = program::rewrite_program_text(text, name, reading, read, slower);
    require_whole(program::read_program_text(written.text, name, reading));
  });
}

/// Chords long enough that a fuzzer's arcs are not its time.
constexpr double chord_tolerance_m = 1e-4;

/// The machine, or nothing, stands in the first line.
void read_gcode(std::string_view bytes) {
  const auto [machine, text] = labelled(bytes);
  program::ProgramReading reading = {.chord_tolerance_m = chord_tolerance_m};
  accept_or_reject([&, machine = machine] {
    if (!machine.empty()) reading.machine = program::parse_machine(machine);
  });
  read_program(text, "input.ngc", reading);
}

constexpr std::array<Reader, 3> all = {{
    {"gcode", read_gcode},
    {"apt", [](std::string_view bytes) { read_program(bytes, "input.apt", {.chord_tolerance_m = chord_tolerance_m}); }},
    {"poses", [](std::string_view bytes) { read_program(bytes, "input.csv", {}); }},
}};

}  // namespace

std::span<const Reader> program_readers() {
  return all;
}

}  // namespace robomill::fuzz
