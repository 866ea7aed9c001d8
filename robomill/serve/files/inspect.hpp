#pragma once
#include <filesystem>

#include "robomill/io/json.hpp"

namespace robomill::serve {

/// What a file looks like, for somebody who has just brought it: {"kind", "columns": [{"name", "unit", "guess",
/// "direction", "from"}], "rows", "sample_rate_hz", "direction_guess", "questions", "files", "time"}; of what is no
/// recording the kind alone. A file that is one hit with others beside it, by their names, is described with them:
/// "files" has their names, the force's first, and "time" the column of time where hits.toml must give it.
/// @throws InvalidInput if a recording cannot be read
[[nodiscard]] io::Json inspect(const std::filesystem::path& path);

}  // namespace robomill::serve
