#pragma once
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"

namespace robomill::jobs {

/// The same error with its number, where it has one, in a unit that is `factor` times that of SI.
[[nodiscard]] InvalidInput in_unit(const InvalidInput& error, double factor, std::string unit);

/// An error about a cut in the words of its file: key, unit and line where it names a member that the file has, else
/// its path. Members of a point ("points.spindle_speed_rad_per_s") are those of --at, "options.sample_rate_hz" is
/// --sample-rate-hz. Modes that stand in the place of the file's are called fitted.
[[nodiscard]] InvalidInput in_words_of(const LobesFile& cut, const InvalidInput& error);

/// Calls work; an InvalidInput that it throws comes out in the cut's words.
template <class Work>
auto with_words_of(const LobesFile& cut, Work&& work) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    throw in_words_of(cut, error);
  }
}

}  // namespace robomill::jobs
