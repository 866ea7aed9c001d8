#pragma once
#include "robomill/io/json.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"

namespace robomill::serve {

/// The keys of a lobes.toml that sliders may move, with the value in force and the range of usual cuts, all in the
/// file's units: {"tool.teeth": {"value": 3, "min": 1, "max": 20, "step": 1}, …}. A range is wider where the file's own
/// value lies outside, and stays the same whatever the source sets.
/// @param source  that `file` was read from
[[nodiscard]] io::Json lobes_fields(const io::TomlSource& source, const jobs::LobesFile& file);

}  // namespace robomill::serve
