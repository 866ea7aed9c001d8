#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {

/// What a file's ending says about its content.
enum class Format { uff, csv, text, mat, json, toml, wav, lvm, tdms, unknown };

/// .uff .unv .uf, .csv, .txt .dat .asc, .mat, .json, .toml, .wav, .lvm, .tdms; case does not matter.
[[nodiscard]] ROBOMILL_API Format format_of(const std::filesystem::path& path);

/// A path and, where it is a link, what it leads to, which may be missing, and so on.
[[nodiscard]] std::vector<std::filesystem::path> links_of(const std::filesystem::path& path);
/// The last of them: a link stays a link, and what it leads to is replaced.
[[nodiscard]] std::filesystem::path behind_link(const std::filesystem::path& path);
/// A device, a pipe or a socket, which cannot be renamed over; nothing of it remains half-written either.
[[nodiscard]] ROBOMILL_API bool is_special(const std::filesystem::path& path);
/// A name that no file has beside another one.
[[nodiscard]] std::filesystem::path temporary_name(const std::filesystem::path& path);
/// Whether it looks like one.
[[nodiscard]] bool is_temporary_name(const std::filesystem::path& path);

/// A file opened to be read.
/// @throws InvalidInput if there is no such file, it is a directory, cannot be read, is an output (OutputPlaces), is of
///     an unfinished FolderChange, or, while a Confinement lives, is a device or a pipe
[[nodiscard]] ROBOMILL_API std::ifstream open_file(const std::filesystem::path& path);

/// @throws InvalidInput as open_file
void require_file(const std::filesystem::path& path);

/// The whole content of a file.
/// @throws InvalidInput if there is no such file, it is a directory, cannot be read, is empty or holds more than
/// max_bytes
[[nodiscard]] ROBOMILL_API std::string read_file(const std::filesystem::path& path,
                                                 std::uintmax_t max_bytes = std::uintmax_t{1} << 31);

/// Makes a folder, and those above it, where they are missing.
/// @throws InvalidInput if it cannot be made
void make_folder(const std::filesystem::path& folder);

/// Makes a file appear whole or not at all, by a PendingFile. A device or a pipe is written through.
/// @throws InvalidInput if the place cannot be written
ROBOMILL_API void write_file(const std::filesystem::path& path, std::string_view content);

/// Takes a regular file away, through a link the one it points to. Whether there was one.
/// @throws InvalidInput if it cannot be removed
bool remove_file(const std::filesystem::path& path);

/// A file that appears whole or not at all: it is written under a temporary name beside its place, made durable and
/// renamed. It goes away unless committed. All that robomill writes into regular files, but for logs, is written here,
/// what libraries write by their callbacks (write_at), so that no failure of the system is missed.
class ROBOMILL_API PendingFile {
 public:
  /// @throws InvalidInput if the folder is missing, path is one, a device, a pipe or an open file, or it cannot be
  ///     written
  explicit PendingFile(std::filesystem::path path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Behind what there is. @throws InvalidInput if that fails
  void write(std::string_view bytes);
  /// From a place on. False where that fails or failed before; commit() says why.
  bool write_at(std::uint64_t offset, std::string_view bytes) noexcept;
  /// How many of them could be read from a place on; the others are not touched.
  std::size_t read_at(std::uint64_t offset, std::span<char> bytes) noexcept;
  /// Cuts it, or fills it up with zeros. False as write_at.
  bool resize(std::uint64_t size) noexcept;
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Whether something could not be written or read.
  [[nodiscard]] bool failed() const noexcept { return error_ != 0; }

  /// Its place, behind a link.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Where it is until then.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Makes it durable where it is. Nothing is written afterwards. @throws InvalidInput if that fails, or failed before
  void prepare();
  /// prepare(), and moves it to its place. @throws InvalidInput if that fails
  void commit();
  /// Takes away what stands under the temporary name, and ends its use.
  void discard() noexcept;

 private:
  bool keep(int error) noexcept;
  void require_written() const;

  std::filesystem::path path_, temporary_;
  Descriptor file_;
  std::uint64_t size_ = 0;
  int error_ = 0;  ///< errno of the first failure
};

/// A file written line by line that appears whole when it is closed, or not at all. A device or a pipe is written
/// through.
class ROBOMILL_API LineFile {
 public:
  /// @throws InvalidInput if the place cannot be written
  explicit LineFile(std::filesystem::path path);
  /// A text with its line's end. False where it could not be written.
  bool write(std::string_view line);
  /// @throws InvalidInput if something could not be written
  void close();

 private:
  std::filesystem::path path_;
  std::optional<PendingFile> pending_;
  std::ofstream file_;
};

}  // namespace robomill::io
