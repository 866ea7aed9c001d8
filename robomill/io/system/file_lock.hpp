#pragma once
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {

/// A lock between processes, on a file that is made for it and stays: held until it goes, or its process ends. Where
/// the file system knows no locks it is none.
class FileLock {
 public:
  enum class Kind {
    shared,    ///< beside others of its kind
    exclusive  ///< alone
  };
  /// None where another process holds it. @throws InvalidInput if the file cannot be made
  [[nodiscard]] static std::optional<FileLock> try_take(const std::filesystem::path& path, Kind kind);
  /// Waits for it. @throws InvalidInput as try_take
  [[nodiscard]] static FileLock take(const std::filesystem::path& path, Kind kind);

  /// Replaces what stands in its file, for whoever looks at it. What cannot be written is left out.
  void note(std::string_view text) const noexcept;

 private:
  explicit FileLock(Descriptor file) : file_(std::move(file)) {}
  static std::optional<FileLock> locked(const std::filesystem::path& path, int operation);
  Descriptor file_;
};

}  // namespace robomill::io
