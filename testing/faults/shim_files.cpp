// The system's calls on files, in place of the C library's.
#include <fcntl.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <climits>

#include "testing/faults/shim.hpp"

namespace robomill::faults {
namespace {

/// -1 and errno.
int failed(int error) noexcept {
  errno = error;
  return -1;
}

/// A number of bytes written, or -1 and errno; what was written is noted.
ssize_t ended(int descriptor, ssize_t written, const Verdict& verdict) noexcept {
  if (verdict.dies) die();
  if (written > 0) note_write(descriptor);
  return written;
}

bool makes_or_writes(int flags) noexcept {
  return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0;
}

/// Those of several buffers: a short write ends within the first.
ssize_t write_vector(int descriptor, const iovec* vector, int count) noexcept {
  const Verdict verdict = next(Call::write, descriptor);
  if (verdict.error != 0) return failed(verdict.error);
  if (!verdict.half) return ended(descriptor, ::syscall(SYS_writev, descriptor, vector, count), verdict);
  while (count > 1 && vector->iov_len == 0) {
    ++vector;
    --count;
  }
  const std::size_t half = vector->iov_len > 1 ? vector->iov_len / 2 : vector->iov_len;
  return ended(descriptor, ::syscall(SYS_write, descriptor, vector->iov_base, half), verdict);
}

ssize_t write_at(int descriptor, const void* bytes, std::size_t size, off_t at) noexcept {
  const Verdict verdict = next(Call::write, descriptor);
  if (verdict.error != 0) return failed(verdict.error);
  const std::size_t written = verdict.half && size > 1 ? size / 2 : size;
  return ended(descriptor, ::syscall(SYS_pwrite64, descriptor, bytes, written, at), verdict);
}

int truncate_counted(int descriptor, off_t size) noexcept {
  const Verdict verdict = next(Call::truncate, descriptor);
  return verdict.error != 0 ? failed(verdict.error) : static_cast<int>(::syscall(SYS_ftruncate, descriptor, size));
}

/// Of a file that counts nothing is waited for: no test takes the power away, and a disk takes milliseconds.
int sync_counted(int descriptor, long number) noexcept {
  if (!counts(descriptor)) return static_cast<int>(::syscall(number, descriptor));
  const Verdict verdict = next(Call::sync, descriptor);
  if (verdict.error != 0) return failed(verdict.error);
  note_sync(descriptor);
  return 0;
}

int rename_counted(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  if (counts(to_folder, to)) {
    const Verdict verdict = next(Call::rename, to);
    if (verdict.error != 0) return failed(verdict.error);
  }
  const int status = static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
  if (status == 0) note_rename(to_folder, to);
  return status;
}

int link_counted(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  if (counts(to_folder, to)) {
    const Verdict verdict = next(Call::rename, to);
    if (verdict.error != 0) return failed(verdict.error);
  }
  const int status = static_cast<int>(::syscall(SYS_linkat, from_folder, from, to_folder, to, flags));
  if (status == 0) note_rename(to_folder, to);
  return status;
}

int make_folder_counted(int folder, const char* path, mode_t mode) noexcept {
  if (counts(folder, path)) {
    const Verdict verdict = next(Call::make_folder, path);
    if (verdict.error != 0) return failed(verdict.error);
  }
  return static_cast<int>(::syscall(SYS_mkdirat, folder, path, mode));
}

/// The mode, which open has only where it makes a file.
mode_t mode_of(int flags, va_list rest) noexcept {
  return (flags & (O_CREAT | __O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
}

}  // namespace

int open_counted(int folder, const char* path, int flags, mode_t mode) noexcept {
  const bool counted = counts(folder, path);
  if (counted) {
    note_open();
    const Verdict verdict = next(makes_or_writes(flags) ? Call::create : Call::open, path);
    if (verdict.error != 0) return failed(verdict.error);
  }
  const int descriptor = static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
  if (counted && descriptor >= 0) track(descriptor, makes_or_writes(flags));
  return descriptor;
}

ssize_t write_counted(int descriptor, const void* bytes, std::size_t size) noexcept {
  const Verdict verdict = next(Call::write, descriptor);
  if (verdict.error != 0) return failed(verdict.error);
  const std::size_t written = verdict.half && size > 1 ? size / 2 : size;
  return ended(descriptor, ::syscall(SYS_write, descriptor, bytes, written), verdict);
}

ssize_t read_counted(int descriptor, void* bytes, std::size_t size) noexcept {
  const Verdict verdict = next(Call::read, descriptor);
  return verdict.error != 0 ? failed(verdict.error) : ::syscall(SYS_read, descriptor, bytes, size);
}

/// Linux has closed a descriptor also where it says that this failed, EINTR among it.
int close_counted(int descriptor) noexcept {
  const Verdict verdict = is_written(descriptor) ? next(Call::close, descriptor) : Verdict{};
  forget(descriptor);
  const int status = static_cast<int>(::syscall(SYS_close, descriptor));
  return verdict.error != 0 ? failed(verdict.error) : status;
}

}  // namespace robomill::faults

using namespace robomill::faults;  // NOLINT(google-build-using-namespace): the names below are the C library's

ROBOMILL_INTERPOSED int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_counted(AT_FDCWD, path, flags, mode);
}
ROBOMILL_INTERPOSED int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_counted(AT_FDCWD, path, flags, mode);
}
ROBOMILL_INTERPOSED int openat(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_counted(folder, path, flags, mode);
}
ROBOMILL_INTERPOSED int openat64(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_counted(folder, path, flags, mode);
}
// What a fortified build calls where no mode is given.
ROBOMILL_INTERPOSED int __open_2(const char* path, int flags) {
  return open_counted(AT_FDCWD, path, flags, 0);
}
ROBOMILL_INTERPOSED int __open64_2(const char* path, int flags) {
  return open_counted(AT_FDCWD, path, flags, 0);
}
ROBOMILL_INTERPOSED int __openat_2(int folder, const char* path, int flags) {
  return open_counted(folder, path, flags, 0);
}
ROBOMILL_INTERPOSED int __openat64_2(int folder, const char* path, int flags) {
  return open_counted(folder, path, flags, 0);
}
ROBOMILL_INTERPOSED int creat(const char* path, mode_t mode) {
  return open_counted(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode);
}
ROBOMILL_INTERPOSED int creat64(const char* path, mode_t mode) {
  return open_counted(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode);
}
ROBOMILL_INTERPOSED ssize_t read(int descriptor, void* bytes, size_t size) {
  return read_counted(descriptor, bytes, size);
}
ROBOMILL_INTERPOSED ssize_t pread(int descriptor, void* bytes, size_t size, off_t at) {
  const Verdict verdict = next(Call::read, descriptor);
  return verdict.error != 0 ? failed(verdict.error) : ::syscall(SYS_pread64, descriptor, bytes, size, at);
}
ROBOMILL_INTERPOSED ssize_t pread64(int descriptor, void* bytes, size_t size, off_t at) {
  return pread(descriptor, bytes, size, at);
}
ROBOMILL_INTERPOSED ssize_t write(int descriptor, const void* bytes, size_t size) {
  return write_counted(descriptor, bytes, size);
}
ROBOMILL_INTERPOSED ssize_t writev(int descriptor, const iovec* vector, int count) {
  return write_vector(descriptor, vector, count);
}
ROBOMILL_INTERPOSED ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t at) {
  return write_at(descriptor, bytes, size, at);
}
ROBOMILL_INTERPOSED ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off_t at) {
  return write_at(descriptor, bytes, size, at);
}
ROBOMILL_INTERPOSED int fsync(int descriptor) {
  return sync_counted(descriptor, SYS_fsync);
}
ROBOMILL_INTERPOSED int fdatasync(int descriptor) {
  return sync_counted(descriptor, SYS_fdatasync);
}
ROBOMILL_INTERPOSED int close(int descriptor) {
  return close_counted(descriptor);
}
ROBOMILL_INTERPOSED int ftruncate(int descriptor, off_t size) noexcept {
  return truncate_counted(descriptor, size);
}
ROBOMILL_INTERPOSED int ftruncate64(int descriptor, off_t size) noexcept {
  return truncate_counted(descriptor, size);
}
ROBOMILL_INTERPOSED int rename(const char* from, const char* to) noexcept {
  return rename_counted(AT_FDCWD, from, AT_FDCWD, to, 0);
}
ROBOMILL_INTERPOSED int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  return rename_counted(from_folder, from, to_folder, to, 0);
}
ROBOMILL_INTERPOSED int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                                  unsigned flags) noexcept {
  return rename_counted(from_folder, from, to_folder, to, flags);
}
ROBOMILL_INTERPOSED int link(const char* from, const char* to) noexcept {
  return link_counted(AT_FDCWD, from, AT_FDCWD, to, 0);
}
ROBOMILL_INTERPOSED int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  return link_counted(from_folder, from, to_folder, to, flags);
}
ROBOMILL_INTERPOSED int mkdir(const char* path, mode_t mode) noexcept {
  return make_folder_counted(AT_FDCWD, path, mode);
}
ROBOMILL_INTERPOSED int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  return make_folder_counted(folder, path, mode);
}
ROBOMILL_INTERPOSED int dup(int descriptor) noexcept {
  const int other = static_cast<int>(::syscall(SYS_dup, descriptor));
  copy(descriptor, other);
  return other;
}
ROBOMILL_INTERPOSED int dup2(int descriptor, int other) noexcept {
  const int made = static_cast<int>(::syscall(SYS_dup2, descriptor, other));
  copy(descriptor, made);
  return made;
}
