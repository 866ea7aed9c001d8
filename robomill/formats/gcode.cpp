#include "robomill/formats/gcode.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/gcode_reader.hpp"
#include "robomill/formats/text.hpp"

namespace robomill::formats {
namespace {

using program::Machine;

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

program::Program read_gcode(const std::filesystem::path& path, std::optional<Machine> machine) {
  const std::string content = read_file(path);
  std::string_view rest = content;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  GcodeReader reader(path.string(), machine);
  program::Program out;
  while (!rest.empty() && !reader.ended()) {
    const std::size_t end = rest.find('\n');
    if (std::optional<program::Block> block = reader.next(rest.substr(0, end))) out.blocks.push_back(*block);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  if (!reader.start()) {
    throw InvalidInput(path.string(), "holds no complete position", "A program gives X, Y and Z by G0 before it cuts");
  }
  out.start = *reader.start();
  out.skipped = std::move(reader.skipped());
  return out;
}

}  // namespace robomill::formats
