#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"

/// The system's calls on files, each finished (short counts, EINTR) and checked. They return 0 or errno, so that
/// callbacks of libraries and signal-safe code can use them.
namespace robomill::io {

/// What the system calls an errno, "No space left on device".
[[nodiscard]] ROBOMILL_API std::string error_text(int error);
/// Unless the error is 0. @throws InvalidInput that the file cannot be written, with the system's reason
ROBOMILL_API void require_success(const std::filesystem::path& path, int error);

/// An open file that closes itself.
class ROBOMILL_API Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int open) : open_(open) {}
  ~Descriptor() { static_cast<void>(close()); }
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const noexcept { return open_; }
  [[nodiscard]] bool is_open() const noexcept { return open_ >= 0; }
  /// What some file systems could not write shows here.
  [[nodiscard]] int close() noexcept;

 private:
  int open_ = -1;
};

/// @param error  becomes 0 or errno
/// @param mode   of a file that is made, less the process's umask
[[nodiscard]] ROBOMILL_API Descriptor open_descriptor(const char* path, int flags, int& error,
                                                      unsigned mode = 0666) noexcept;

[[nodiscard]] int write_all(int to, std::string_view bytes) noexcept;
/// @param count  becomes how many of them were written
[[nodiscard]] int write_all(int to, std::string_view bytes, std::size_t& count) noexcept;
[[nodiscard]] int write_all_at(int to, std::string_view bytes, std::uint64_t offset) noexcept;
/// @param count  becomes how many bytes there were, less than asked at the file's end
[[nodiscard]] int read_all_at(int from, std::span<char> bytes, std::uint64_t offset, std::size_t& count) noexcept;

/// Cuts a file, or fills it up with zeros.
[[nodiscard]] int resize_file(int file, std::uint64_t size) noexcept;
/// Until it has returned, a power cut may take what was written. What cannot be synchronised (a pipe) is no error.
[[nodiscard]] int synchronise(int file) noexcept;
/// Makes the names in a folder durable.
[[nodiscard]] int synchronise_folder(const std::filesystem::path& folder) noexcept;

[[nodiscard]] int rename_file(const std::filesystem::path& from, const std::filesystem::path& to) noexcept;
/// Gives a file a second name. Where the file system knows one name a file, it moves.
[[nodiscard]] int keep_file(const std::filesystem::path& file, const std::filesystem::path& name) noexcept;

/// A file that is not there is removed.
[[nodiscard]] int remove_name(const std::filesystem::path& path) noexcept;

}  // namespace robomill::io
