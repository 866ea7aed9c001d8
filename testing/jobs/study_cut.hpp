#pragma once
#include <string>

#include "robomill/io/file.hpp"

namespace robomill::test_support {

/// lobes.toml of the studies of tests, of which two or three keys vary. Its readers stand in AT_SOURCE.
inline std::string study_cut() {
  return io::read_file(ROBOMILL_SOURCE_DIR "/testing/jobs/study/lobes.toml");
}

}  // namespace robomill::test_support
