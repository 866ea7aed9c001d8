#pragma once
#include <filesystem>
#include <vector>

#include "robomill/base/export.hpp"

namespace robomill::io {

/// The places that one job writes to. While it lives, the thread that made it reads no file that stands at one of them,
/// or in one that is a folder, whatever link leads there: no output takes the place of an input. Temporary files
/// (PendingFile) are no inputs.
class ROBOMILL_API OutputPlaces {
 public:
  /// @param places  files and folders, whether they are there or not; empty ones are left out
  /// @throws InvalidInput if two of them are one place
  explicit OutputPlaces(std::vector<std::filesystem::path> places);
  ~OutputPlaces();
  OutputPlaces(const OutputPlaces&) = delete;
  OutputPlaces& operator=(const OutputPlaces&) = delete;

 private:
  std::vector<std::filesystem::path> places_;
  OutputPlaces* outer_;
  friend void require_no_output(const std::filesystem::path& path);
};

/// While it lives, its thread reads what stands in a folder that its job writes: a job that goes on where it ended.
class ReadBack {
 public:
  explicit ReadBack(std::filesystem::path folder);
  ~ReadBack();
  ReadBack(const ReadBack&) = delete;
  ReadBack& operator=(const ReadBack&) = delete;

 private:
  std::filesystem::path folder_;
  ReadBack* outer_;
  friend void require_no_output(const std::filesystem::path& path);
};

/// Before a file is read. @throws InvalidInput if this thread's job writes there, and does not read it back
void require_no_output(const std::filesystem::path& path);

}  // namespace robomill::io
