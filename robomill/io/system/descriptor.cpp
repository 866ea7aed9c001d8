#include "robomill/io/system/descriptor.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::io {
namespace {

/// A call again as long as a signal interrupts it. @param call  returns -1 where it fails
template <class Call>
auto retried(const Call& call) noexcept {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// @param done  becomes how many are written
/// @param some  writes a part of the bytes, of which so many are written, and returns how many
template <class Some>
int write_parts(std::string_view bytes, std::size_t& done, const Some& some) noexcept {
  done = 0;
  while (done < bytes.size()) {
    const ssize_t count = retried([&] { return some(bytes.data() + done, bytes.size() - done, done); });
    if (count < 0) return errno;
    if (count == 0) return EIO;  // it neither writes nor says why
    done += static_cast<std::size_t>(count);
  }
  return 0;
}

bool cannot_be_synchronised(int error) noexcept {
  return error == EINVAL || error == EROFS || error == ENOTSUP;
}

}  // namespace

std::string error_text(int error) {
  return std::generic_category().message(error);
}

void require_success(const std::filesystem::path& path, int error) {
  if (error != 0) throw InvalidInput(path.string(), "cannot be written", error_text(error));
}

Descriptor::Descriptor(Descriptor&& other) noexcept : open_(std::exchange(other.open_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  static_cast<void>(close());
  open_ = std::exchange(other.open_, -1);
  return *this;
}

int Descriptor::close() noexcept {
  const int open = std::exchange(open_, -1);
  // After EINTR Linux has closed it: closing again could close another thread's file.
  return open < 0 || ::close(open) == 0 || errno == EINTR ? 0 : errno;
}

Descriptor open_descriptor(const char* path, int flags, int& error, unsigned mode) noexcept {
  const int open = retried([&] { return ::open(path, flags | O_CLOEXEC, mode); });
  error = open < 0 ? errno : 0;
  return Descriptor(open);
}

int write_all(int to, std::string_view bytes) noexcept {
  std::size_t count = 0;
  return write_all(to, bytes, count);
}

int write_all(int to, std::string_view bytes, std::size_t& count) noexcept {
  return write_parts(bytes, count,
                     [to](const char* part, std::size_t size, std::size_t) { return ::write(to, part, size); });
}

int write_all_at(int to, std::string_view bytes, std::uint64_t offset) noexcept {
  std::size_t written = 0;
  return write_parts(bytes, written, [to, offset](const char* part, std::size_t count, std::size_t done) {
    return ::pwrite(to, part, count, static_cast<off_t>(offset + done));
  });
}

int read_all_at(int from, std::span<char> bytes, std::uint64_t offset, std::size_t& count) noexcept {
  count = 0;
  while (count < bytes.size()) {
    const ssize_t got = retried(
        [&] { return ::pread(from, bytes.data() + count, bytes.size() - count, static_cast<off_t>(offset + count)); });
    if (got < 0) return errno;
    if (got == 0) break;
    count += static_cast<std::size_t>(got);
  }
  return 0;
}

int resize_file(int file, std::uint64_t size) noexcept {
  return retried([&] { return ::ftruncate(file, static_cast<off_t>(size)); }) == 0 ? 0 : errno;
}

int synchronise(int file) noexcept {
  const int failed = retried([file] { return ::fsync(file); });
  return failed == 0 || cannot_be_synchronised(errno) ? 0 : errno;
}

int synchronise_folder(const std::filesystem::path& folder) noexcept {
  int error = 0;
  Descriptor open = open_descriptor(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY, error);
  if (error == EACCES) return 0;  // one may write into a folder that one may not read
  if (error == 0) error = synchronise(open.get());
  const int closed = open.close();
  return error != 0 ? error : closed;
}

int rename_file(const std::filesystem::path& from, const std::filesystem::path& to) noexcept {
  return retried([&] { return ::rename(from.c_str(), to.c_str()); }) == 0 ? 0 : errno;
}

int keep_file(const std::filesystem::path& file, const std::filesystem::path& name) noexcept {
  if (::link(file.c_str(), name.c_str()) == 0) return 0;
  const bool has_one_name = errno == EPERM || errno == ENOTSUP || errno == ENOSYS || errno == EMLINK;
  return has_one_name ? rename_file(file, name) : errno;
}

int remove_name(const std::filesystem::path& path) noexcept {
  return ::unlink(path.c_str()) == 0 || errno == ENOENT ? 0 : errno;
}

}  // namespace robomill::io
