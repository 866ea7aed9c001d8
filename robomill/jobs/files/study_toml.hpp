#pragma once
#include "robomill/base/export.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/sweep/study.hpp"

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// study.toml. @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API Study read_study(const io::TomlSource& source);

/// Of what a study computes: its own text, the document that it varies, every file that these or the values of keys
/// name, by their content; the version of robomill. 64 hexadecimal digits.
/// @throws InvalidInput if one cannot be read
[[nodiscard]] std::string fingerprint_of(const Study& study);

}  // namespace robomill::jobs
