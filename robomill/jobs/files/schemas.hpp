#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"

// Method: docs/formats.md, "Schemas"

namespace robomill::jobs {

/// The documents that have one: "lobes.toml", "lobes.json", …
[[nodiscard]] ROBOMILL_API const std::vector<std::string>& schema_names();
/// The JSON Schema (draft 2020-12) of a document, as text.
/// @throws InvalidInput naming "schema" where there is no such document
[[nodiscard]] ROBOMILL_API std::string schema_text(std::string_view document);
/// Its table of docs/formats.md; "job.toml spindle safety": of these tables alone.
/// @throws InvalidInput as schema_text
[[nodiscard]] std::string schema_table(std::string_view document);

}  // namespace robomill::jobs
