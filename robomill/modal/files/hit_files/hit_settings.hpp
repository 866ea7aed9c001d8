#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/modal/files/found_hits.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// A key of hits.toml as a record says it, or lacks it.
struct HitSetting {
  std::string key, value;  ///< as TOML writes them
  std::string remark = {};
  std::string missing = {};  ///< what only somebody else can say: "the hammer's sensitivity"; empty: it is known
};

/// Keys of [acquisition], of which all records have one, by one of them.
[[nodiscard]] std::vector<HitSetting> acquisition_settings(const FoundHit& hit);

/// Columns that no record states a unit of.
struct UnstatedUnits {
  bool force = false, response = false;
};
/// The units that are assumed for them, with the keys of hits.toml to give instead. @param file  its name
[[nodiscard]] std::vector<Assumption> assumed_units(const UnstatedUnits& unstated, ResponseKind kind,
                                                    const std::string& file);
/// The same of records that were found.
[[nodiscard]] std::vector<Assumption> assumed_units(const FoundHits& found, const std::string& file);

/// The keys of a record's [[hits]].
[[nodiscard]] std::vector<HitSetting> row_settings(const FoundHit& hit);

}  // namespace robomill::modal
