#pragma once
#include <string>
#include <vector>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

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

/// The column of a record's time; empty: it has none. @param given  its name or number from 1; empty: found
[[nodiscard]] std::string time_column_of(const Record& record, const std::string& given = {});

}  // namespace robomill::io
