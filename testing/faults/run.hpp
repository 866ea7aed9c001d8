#pragma once
// The program in a folder of its own, with a fault at one of its calls.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "testing/faults/fault.hpp"

namespace robomill::faults {

struct Fault {
  Kind kind = Kind::io_error;
  std::uint64_t n = 0;  ///< the call that it happens to, from 1 on; 0: none
};

/// How a run ended.
struct Outcome {
  int exit = -1;  ///< 128 and the signal where one ended it
  std::string out, err;
  std::array<std::uint64_t, kind_count> calls = {};  ///< to which each kind applies
  bool reached = false;
  Call call = Call::open;  ///< that the fault happened to
  std::string file;        ///< and its file
  std::uint64_t unsynced_files = 0, unsynced_folders = 0;
};

struct Programs {
  std::filesystem::path robomill, shim;
};

/// The files of a folder by their paths in it, with what they hold.
using Files = std::map<std::string, std::string>;
[[nodiscard]] Files files_of(const std::filesystem::path& folder);
/// A text without the seconds that a run took, so that two runs are alike.
[[nodiscard]] std::string without_times(std::string text);
/// Makes a folder hold these files and no others.
void restore(const std::filesystem::path& folder, const Files& files);

/// A place to run in: the folder that counts, and beside it what the run prints.
class Place {
 public:
  /// @param base  a folder of nobody else's
  Place(Programs programs, const std::filesystem::path& base);
  ~Place();
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// @param arguments     of robomill, with blanks between them; they end with --threads 1, so that calls have an order
  /// @param count_stdout  the fault may happen to standard output too
  Outcome run(const std::string& arguments, const Fault& fault, bool count_stdout);
  /// The words of a command that does so, and what it has counted so far; one command at a time.
  [[nodiscard]] std::vector<std::string> words(const std::string& arguments, const Fault& fault, bool count_stdout);
  [[nodiscard]] Outcome counted() const;
  /// Without the shim, its standard output a device.
  Outcome run_onto(const std::string& arguments, const std::filesystem::path& device);
  /// Without the shim, killed after a time unless it has ended.
  Outcome run_killed(const std::string& arguments, double after_s);

 private:
  [[nodiscard]] std::string command(const std::string& arguments, const std::string& environment) const;
  Outcome ended(std::vector<std::string> words, const std::filesystem::path& out);

  Programs programs_;
  std::filesystem::path base_, folder_;
  Report* report_ = nullptr;
};

}  // namespace robomill::faults
