#pragma once
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace robomill::io {

/// What became of a program.
struct ProgramEnd {
  bool started = false;  ///< false: there is none of its name, or it cannot be run; then `complaint` says why
  int code = -1;         ///< its exit code; 128 and the signal where one ended it
  std::string said = {}, complaint = {};  ///< on its standard output and standard error
};

struct ProgramLimits {
  std::chrono::milliseconds time{120'000};           ///< by the clock; then it is killed
  std::size_t output_bytes = std::size_t{64} << 20;  ///< that are kept of each output
};

/// Runs a program of PATH to its end, without input and without files that this process has open.
/// @param words  its name and its arguments; no shell reads them
[[nodiscard]] ProgramEnd run_program(std::vector<std::string> words, const ProgramLimits& limits = {});

}  // namespace robomill::io
