#pragma once
// Every verb with every ending that it writes, on the smallest input.
#include <string>
#include <vector>

#include "testing/faults/run.hpp"

namespace robomill::faults {

struct Case {
  const char* verb = "";
  const char* ending = "";       ///< what is written
  const char* arguments = "";    ///< of robomill
  const char* make_inputs = "";  ///< arguments with which robomill makes an input; none where empty
  bool to_stdout = false;        ///< standard output counts, and is compared
  bool is_new = false;           ///< there is no older result: the verb rejects one, or takes another name
  bool together = false;         ///< all outputs are those of one run
};

[[nodiscard]] std::vector<Case> all_cases();
/// The files that a case reads, but for those that make_inputs makes.
[[nodiscard]] Files inputs_of(const Case& which);

}  // namespace robomill::faults
