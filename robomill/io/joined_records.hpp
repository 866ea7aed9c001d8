#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"

namespace robomill::io {

class TomlFile;

/// One measurement in several files, force and responses apart.
struct JoinedRecords {
  std::vector<Record> parts = {};  ///< in their order, each cut to what all have
  double sample_rate_hz = 0.0;     ///< of all; 0: none says it
  double begin_s = 0.0;            ///< time of the first sample; 0 where no column of time says it
  std::vector<std::string> notes = {};
};

/// Puts records side by side: of columns of time the stretch that all have, else from their first samples on. One that
/// states no rate has that of the others, if it is as long as they are.
/// @param parts  one comes back as it is
/// @param times  column of the time [s] of each, by name or number from 1; empty: found by its name
/// @throws InvalidInput naming two files if their rates differ by more than the digits of their times allow, they have
///     no stretch in common, or one states no rate and has another length
[[nodiscard]] JoinedRecords join_records(std::vector<Record> parts, std::vector<std::string> times = {});

/// A key that names the file of a record, or several with its columns apart.
/// @throws InvalidInput with the key if it names none, or one twice
void read_record_files(TomlFile& file, const std::string& key, std::vector<std::filesystem::path>& out);

/// A column of records side by side, both counted from 0.
struct PartColumn {
  std::size_t part = 0, place = 0;
  bool operator==(const PartColumn&) const = default;
};

/// Finds a column by its name, by "FILE:COLUMN", or by its number from 1.
/// @param own  the file in which a number, or a name that several have, is looked up; nothing: the file must be given
/// @throws InvalidInput naming the columns that are there, or what to write
[[nodiscard]] PartColumn find_column(const std::vector<Record>& parts, const std::string& text,
                                     std::optional<std::size_t> own = {});
/// How a column is named so that find_column finds it: by its name where that is its own, else by its number, with the
/// file's name before it where neither is enough.
[[nodiscard]] std::string column_name(const std::vector<Record>& parts, const PartColumn& column,
                                      std::optional<std::size_t> own = {});
/// The error for records that have no such column; it names those that they have.
[[nodiscard]] InvalidInput no_column(const std::vector<Record>& parts, std::string_view what);

/// The column of a record's time; empty: it has none. @param given  its name or number from 1; empty: found
[[nodiscard]] std::string time_column_of(const Record& record, const std::string& given = {});

}  // namespace robomill::io
