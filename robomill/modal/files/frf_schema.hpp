#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::modal {

/// FRFs with what is known beside them.
struct FrfView {
  const FrfSet* set = nullptr;
  const FrfResult* hits = nullptr;    ///< null: not from hits
  const FrfDoubts* doubts = nullptr;  ///< null: not predicted
};
/// tip.json
[[nodiscard]] const io::Schema<FrfView>& frf_table();
/// Verdicts, grades and notes of it, for plan.json.
[[nodiscard]] const io::Schema<FrfResult>& hits_table();

}  // namespace robomill::modal
