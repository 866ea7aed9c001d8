#pragma once
#include "robomill/process/decide_options.hpp"

namespace robomill::io {
class TomlFile;
}

namespace robomill::process {

/// [decide] of job.toml.
/// @param along_program  the job has a program with forces and a cell; else speed and depth are free, and nothing else
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] DecideOptions read_decide(io::TomlFile& file, bool along_program);

}  // namespace robomill::process
