#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/path/realtime/scheduling.hpp"
#include "robomill/path/setpoint_stream.hpp"

// Method: robomill/path/README.md, "Set-points by the clock"

namespace robomill::path {

/// How a stream ended.
enum class StreamEnd {
  finished,     ///< at the program's end
  stopped,      ///< by command
  interrupted,  ///< by a signal
  failed        ///< see StreamedProgram::failure
};
inline constexpr Name<StreamEnd> stream_end_names[] = {{"finished", StreamEnd::finished},
                                                       {"stopped", StreamEnd::stopped},
                                                       {"interrupted", StreamEnd::interrupted},
                                                       {"failed", StreamEnd::failed}};

/// Of the set-points' lines, behind the ring.
struct WrittenLines {
  std::uint64_t lines = 0;     ///< handed to the system
  std::uint64_t late = 0;      ///< … after the deadline of their set-point
  DelayStatistics delay = {};  ///< behind the begin of their period
};

/// A program that was streamed, as stream.json holds it.
struct StreamedProgram {
  std::string program = {}, cell = {};  ///< names of the files
  StreamEnd end = StreamEnd::finished;
  std::string failure = {};  ///< in words; empty: none
  StreamReport report = {};
  WrittenLines written = {};
  Scheduling scheduling = {};
  std::uint64_t commands = 0, rejected_commands = 0;
  std::vector<std::string> notes = {};
  std::vector<Assumption> assumed = {};
};

/// stream.json; docs/formats.md.
[[nodiscard]] ROBOMILL_API std::string stream_json(const StreamedProgram& streamed);

/// In lines, as a terminal may have them: how it ended, what is counted as a miss, delays, and what the system granted.
[[nodiscard]] ROBOMILL_API std::string stream_text(const StreamedProgram& streamed);

}  // namespace robomill::path
