#include "robomill/program/files/gcode.hpp"

#include <fmt/format.h>

#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/program/files/program_files.hpp"

namespace robomill::program {
namespace {

constexpr Name<Machine> machine_names[] = {{"xyzac-trt", Machine::xyzac_trt},
                                           {"xyzbc-trt", Machine::xyzbc_trt},
                                           {"xyzac-head", Machine::xyzac_head},
                                           {"xyzbc-head", Machine::xyzbc_head}};

}  // namespace

Machine parse_machine(std::string_view name) {
  if (const std::optional<Machine> machine = value_in(machine_names, name)) return *machine;
  throw InvalidInput(InvalidInput::Parts{
      .field = "program.machine", .value = fmt::format("\"{}\"", name), .rule = one_of(machine_names)});
}

Program read_gcode(const std::filesystem::path& path, std::optional<Machine> machine) {
  return read_program(path, {.machine = machine, .format = ProgramFormat::gcode});
}

}  // namespace robomill::program
