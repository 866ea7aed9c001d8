#pragma once
// Every verb with every ending that it writes, on the smallest input.
#include <string>
#include <vector>

#include "testing/faults/run.hpp"

namespace robomill::faults {

enum Trait : unsigned {
  to_stdout = 1,  ///< standard output counts, and is compared
  is_new = 2,     ///< there is no older result: the verb rejects one, or takes another name
  together = 4,   ///< all outputs are those of one run
  goes_on = 8,    ///< after an input or an output that fails it says so and exits with 0
  hdf5 = 16       ///< written by HDF5, which without memory leaves chunks uncompressed, crashes, or does not end
};

struct Case {
  const char* verb = "";
  const char* ending = "";       ///< what is written
  const char* arguments = "";    ///< of robomill
  const char* make_inputs = "";  ///< arguments with which robomill makes an input; none where empty
  unsigned traits = 0;           ///< of Trait
  [[nodiscard]] bool is(Trait trait) const { return (traits & trait) != 0; }
};

[[nodiscard]] std::vector<Case> all_cases();
/// The files that a case reads, but for those that make_inputs makes.
[[nodiscard]] Files inputs_of(const Case& which);

}  // namespace robomill::faults
