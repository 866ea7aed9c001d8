#pragma once
#include <string>
#include <string_view>
#include <vector>

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

/// The keys of a record's [[hits]].
[[nodiscard]] std::vector<HitSetting> row_settings(const FoundHit& hit);

}  // namespace robomill::modal
