#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"

// Method: robomill/serve/README.md, "Overview"

namespace robomill::serve {

/// A value that nobody has confirmed: a sample of an example, or a guess about a record.
struct Guess {
  std::string key = {};  ///< "tool.teeth"
  int line = 0;          ///< from 1
};

/// The rule of an error about a file that is not there; its value is what the document calls it.
inline constexpr const char* no_such_file = "is missing: there is no such file";

/// A part of a job as its documents have it, without any computation.
struct JobPart {
  std::filesystem::path file = {};         ///< that gives it; empty: the job has no such part
  std::string says = {};                   ///< in words, of one that could be read
  std::optional<InvalidInput> error = {};  ///< why it cannot be used
  std::vector<Guess> guesses = {};         ///< in `file`
};

/// What the documents of a job give.
struct JobParts {
  std::string title = {};
  std::optional<InvalidInput> error = {};  ///< of the job's document as a whole
  std::vector<std::string> names = {};     ///< keys of [job]
  JobPart hits = {}, frfs = {}, modes = {}, cut = {}, robot = {}, program = {}, monitor = {};
  JobPart limits = {};                                ///< what the decision keeps: [spindle], [safety], [decide], …
  std::vector<std::filesystem::path> frf_files = {};  ///< all of them, where they are given
  bool predicted = false;                             ///< FRFs are those of an assembly
  bool recommends = false;                            ///< a depth and a speed: the job has a chart of lobes
  bool decides = false;                               ///< on its program
};

/// Reads the documents that a job consists of; records, FRFs and programs are not opened. What is wrong with one is the
/// error of its part.
/// @param results  the folder of its plan, whose monitor.toml is taken where there is no other; empty: none
[[nodiscard]] JobParts read_job_parts(const std::filesystem::path& job, const std::filesystem::path& results);

}  // namespace robomill::serve
