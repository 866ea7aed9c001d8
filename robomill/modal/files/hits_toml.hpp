#pragma once
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// hits.toml with the records that it names, in SI units.
struct HitsFile {
  std::vector<Hit> hits;
  HitOptions options;
  std::vector<std::string> notes = {};  ///< what the readers of the records had to say
  std::vector<Assumption> assumed = {};
};

/// Reads hits.toml and every record it names (.csv .txt .mat .uff .wav); the keys stand in docs/formats.md.
/// @throws InvalidInput with file, line and key (of hits.toml or of a record) if a key is unknown, missing or wrong, a
///     record cannot be read, a column is not there, or no sample rate is known
[[nodiscard]] ROBOMILL_API HitsFile read_hits(const io::TomlSource& source);

}  // namespace robomill::modal
