#include "robomill/io/system/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <utility>

namespace robomill::io {

std::optional<FileLock> FileLock::locked(const std::filesystem::path& path, int operation) {
  int error = 0;
  Descriptor file = open_descriptor(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK, error);
  require_success(path, error);
  while (::flock(file.get(), operation) != 0) {
    if (errno == EWOULDBLOCK) return std::nullopt;
    if (errno == EINTR) continue;
    if (errno == ENOLCK || errno == EOPNOTSUPP) break;
    require_success(path, errno);
  }
  return FileLock(std::move(file));
}

std::optional<FileLock> FileLock::try_take(const std::filesystem::path& path, Kind kind) {
  return locked(path, (kind == Kind::shared ? LOCK_SH : LOCK_EX) | LOCK_NB);
}

FileLock FileLock::take(const std::filesystem::path& path, Kind kind) {
  return *locked(path, kind == Kind::shared ? LOCK_SH : LOCK_EX);
}

void FileLock::note(std::string_view text) const noexcept {
  if (resize_file(file_.get(), 0) == 0) static_cast<void>(write_all_at(file_.get(), text, 0));
}

}  // namespace robomill::io
