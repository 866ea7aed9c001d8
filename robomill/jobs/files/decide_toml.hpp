#pragma once
#include "robomill/jobs/decide_options.hpp"

namespace robomill::io {
class TomlFile;
}

namespace robomill::jobs {

/// [decide] of job.toml.
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] DecideOptions read_decide(io::TomlFile& file);

}  // namespace robomill::jobs
