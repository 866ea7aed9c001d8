#include "robomill/program/files/gcode.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/program/files/program_files.hpp"

namespace robomill::program {
namespace {

constexpr std::array<std::pair<std::string_view, Machine>, 4> machines = {{{"xyzac-trt", Machine::xyzac_trt},
                                                                           {"xyzbc-trt", Machine::xyzbc_trt},
                                                                           {"xyzac-head", Machine::xyzac_head},
                                                                           {"xyzbc-head", Machine::xyzbc_head}}};

}  // namespace

Machine parse_machine(std::string_view name) {
  for (const auto& [known, machine] : machines) {
    if (name == known) return machine;
  }
  throw InvalidInput(InvalidInput::Parts{
      .field = "program.machine",
      .value = fmt::format("\"{}\"", name),
      .rule = "must be one of \"xyzac-trt\", \"xyzbc-trt\", \"xyzac-head\", \"xyzbc-head\"",
  });
}

Program read_gcode(const std::filesystem::path& path, std::optional<Machine> machine) {
  return read_program(path, {.machine = machine, .format = ProgramFormat::gcode});
}

}  // namespace robomill::program
