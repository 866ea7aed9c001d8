#pragma once
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// As names of keys and columns end: "m_per_s2".
[[nodiscard]] ROBOMILL_API const char* response_unit(ResponseKind kind);

/// hits.toml with the records that it names, in SI units.
struct HitsFile {
  std::vector<Hit> hits;
  HitOptions options;
  std::vector<std::string> notes = {};  ///< what the readers of the records had to say
  std::vector<Assumption> assumed = {};
};

/// Reads hits.toml and every record it names (io::read_record); the keys stand in docs/formats.md.
/// @throws InvalidInput with file, line and key (of hits.toml or of a record) if a key is unknown, missing or wrong, a
///     record cannot be read, a column is not there, or no sample rate is known
[[nodiscard]] ROBOMILL_API HitsFile read_hits(const io::TomlSource& source);

/// A [[hits]] table without its record: what its columns are.
struct HitRow {
  struct Response {
    Dof dof;
    bool against_axis = false;
    std::string column;  ///< a name, or a number from 1
  };
  Dof excitation;
  bool against_axis = false;
  std::string force;  ///< column
  std::vector<Response> responses;
};

/// hits.toml as the settings of hits that come another way than as files.
struct HitRows {
  HitOptions options;
  double force_factor = 1.0;     ///< [N] per 1 of a record
  double response_factor = 1.0;  ///< SI unit of the response per 1 of a record
  double sample_rate_hz = 0.0;   ///< 0: not said
  std::vector<HitRow> rows;
  std::vector<std::string> notes = {};  ///< sentences for the user
};

/// Reads hits.toml alone; its records need not be there.
/// @throws InvalidInput as read_hits does about the document
[[nodiscard]] ROBOMILL_API HitRows read_hit_rows(const io::TomlSource& source);

}  // namespace robomill::modal
