#pragma once
// What the writers of trajectories and joint programs share.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "robomill/io/file.hpp"
#include "robomill/path/files/trajectory.hpp"

namespace robomill::path {

/// What a header says of collisions where nobody looked.
inline constexpr const char* unchecked_collisions = "not checked: the cell has no [geometry]";

/// A long text that appears whole or not at all, written through a buffer.
class PendingText {
 public:
  /// @throws InvalidInput if the place cannot be written or is no regular file
  explicit PendingText(const std::filesystem::path& path);
  /// Append here; call drain() now and then.
  [[nodiscard]] fmt::memory_buffer& buffer() { return buffer_; }
  /// Writes the buffer out where it has grown large.
  void drain();
  void restart();
  /// As SampleFile::finish.
  [[nodiscard]] io::PendingFile& finish();

 private:
  void flush();

  io::PendingFile pending_;
  fmt::memory_buffer buffer_;
};

[[nodiscard]] std::unique_ptr<SampleFile> open_trajectory_csv(const std::filesystem::path& path,
                                                              const TrajectoryInfo& info);
[[nodiscard]] std::unique_ptr<SampleFile> open_trajectory_hdf5(const std::filesystem::path& path,
                                                               const TrajectoryInfo& info);

}  // namespace robomill::path
