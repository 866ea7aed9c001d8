#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// The records that appear in a folder during a tap test.
class TapFolder {
 public:
  using Clock = std::chrono::steady_clock;
  /// A record that did not change for so long is complete: who writes over a network pauses in between.
  static constexpr std::chrono::milliseconds settled{500};
  /// What is there already is of an earlier test.
  /// @param named  records of other folders that are of the test once they appear
  /// @throws InvalidInput if there is no such folder, or it cannot be read
  TapFolder(std::filesystem::path watch, std::vector<std::filesystem::path> named);

  /// Those that are new and have settled, each once; at most so many.
  [[nodiscard]] std::vector<std::filesystem::path> look(std::size_t most, Clock::time_point now = Clock::now());
  /// A file that is no record: the test writes it. From any thread.
  void ignore(const std::filesystem::path& file);

 private:
  struct Seen {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type written = {};
    Clock::time_point changed = {};  ///< when that was seen first
    bool done = false;               ///< taken, or not of the test
  };
  std::filesystem::path watch_;
  std::vector<std::filesystem::path> named_;
  std::mutex mutex_;
  std::map<std::string, Seen> seen_;  ///< by path
};

}  // namespace robomill::serve
