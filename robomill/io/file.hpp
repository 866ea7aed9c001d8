#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"

namespace robomill::io {

/// What a file's ending says about its content.
enum class Format { uff, csv, text, mat, json, toml, wav, unknown };

/// .uff .unv .uf, .csv, .txt .dat .asc, .mat, .json, .toml, .wav; case does not matter.
[[nodiscard]] ROBOMILL_API Format format_of(const std::filesystem::path& path);

/// A file opened to be read.
/// @throws InvalidInput if there is no such file, it is a directory, or cannot be read; or while a Confinement lives,
/// if
///     it is a device or a pipe
[[nodiscard]] std::ifstream open_file(const std::filesystem::path& path);

/// The whole content of a file.
/// @throws InvalidInput if there is no such file, it is a directory, cannot be read, is empty or holds more than
/// max_bytes
[[nodiscard]] ROBOMILL_API std::string read_file(const std::filesystem::path& path,
                                                 std::uintmax_t max_bytes = std::uintmax_t{1} << 31);

/// Makes a folder, and those above it, where they are missing.
/// @throws InvalidInput if it cannot be made
ROBOMILL_API void make_folder(const std::filesystem::path& folder);

/// Makes a file appear whole or not at all: written beside its place, then renamed.
/// @throws InvalidInput if the place cannot be written
ROBOMILL_API void write_file(const std::filesystem::path& path, std::string_view content);

/// Takes a regular file away, through a link the one it points to. Whether there was one.
/// @throws InvalidInput if it cannot be removed
ROBOMILL_API bool remove_file(const std::filesystem::path& path);

/// A file under a temporary name beside its place, for writers that insist on a path of their own. Goes away unless
/// committed.
class PendingFile {
 public:
  /// @throws InvalidInput if the folder is missing or path is one
  explicit PendingFile(std::filesystem::path path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Moves what was written to its place. @throws InvalidInput if that fails
  void commit();

 private:
  std::filesystem::path path_, temporary_;
};

/// A file written line by line, of which each line is there at once where it is live; else it appears whole when it is
/// closed, or not at all. A device or a pipe is written through.
class LineFile {
 public:
  /// @throws InvalidInput if the place cannot be written
  LineFile(std::filesystem::path path, bool live);
  /// A text with its line's end. False where it could not be written.
  bool write(std::string_view line);
  /// @throws InvalidInput if something could not be written
  void close();

 private:
  std::filesystem::path path_;
  bool live_;
  std::optional<PendingFile> pending_;
  std::ofstream file_;
};

}  // namespace robomill::io
