// The C library's streams write by calls of its own, which no other library can stand in for. A stream of a file that
// counts is therefore one whose bytes go through the counted calls.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "testing/faults/shim.hpp"

namespace robomill::faults {
namespace {

/// The counted streams that are open, to answer fileno.
struct Stream {
  std::atomic<FILE*> file{nullptr};
  std::atomic<int> descriptor{-1};
};
std::array<Stream, 256> streams;

int descriptor_of(void* cookie) noexcept {
  return static_cast<int>(reinterpret_cast<std::intptr_t>(cookie));
}

/// As the C library writes: on after a short write, not after an error.
ssize_t write_stream(void* cookie, const char* bytes, size_t size) noexcept {
  size_t done = 0;
  while (done < size) {
    const ssize_t written = write_counted(descriptor_of(cookie), bytes + done, size - done);
    if (written < 0) break;
    done += static_cast<size_t>(written);
  }
  return static_cast<ssize_t>(done);
}

ssize_t read_stream(void* cookie, char* bytes, size_t size) noexcept {
  return read_counted(descriptor_of(cookie), bytes, size);
}

int seek_stream(void* cookie, off64_t* offset, int whence) noexcept {
  const off_t at = ::lseek(descriptor_of(cookie), *offset, whence);
  if (at < 0) return -1;
  *offset = at;
  return 0;
}

int close_stream(void* cookie) noexcept {
  for (Stream& stream : streams) {
    if (stream.descriptor != descriptor_of(cookie)) continue;
    stream.file = nullptr;
    stream.descriptor = -1;
  }
  return close_counted(descriptor_of(cookie));
}

FILE* stream_of(int descriptor, const char* mode) noexcept {
  const cookie_io_functions_t calls = {read_stream, write_stream, seek_stream, close_stream};
  FILE* file = ::fopencookie(reinterpret_cast<void*>(static_cast<std::intptr_t>(descriptor)), mode, calls);
  if (file == nullptr) return nullptr;
  for (Stream& stream : streams) {
    FILE* none = nullptr;
    if (!stream.file.compare_exchange_strong(none, file)) continue;
    stream.descriptor = descriptor;
    break;
  }
  return file;
}

int flags_of(const char* mode) noexcept {
  const bool both = std::strchr(mode, '+') != nullptr;
  int flags = both ? O_RDWR : mode[0] == 'r' ? O_RDONLY : O_WRONLY;
  if (mode[0] == 'w') flags |= O_CREAT | O_TRUNC;
  if (mode[0] == 'a') flags |= O_CREAT | O_APPEND;
  if (std::strchr(mode, 'x') != nullptr) flags |= O_EXCL;
  if (std::strchr(mode, 'e') != nullptr) flags |= O_CLOEXEC;
  return flags;
}

FILE* open_stream(const char* path, const char* mode) noexcept {
  const int descriptor = open_counted(AT_FDCWD, path, flags_of(mode), 0666);
  if (descriptor < 0) return nullptr;
  FILE* file = stream_of(descriptor, mode);
  if (file == nullptr) close_counted(descriptor);
  return file;
}

template <class Function>
Function next_of(const char* name) noexcept {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

void count_stdout() noexcept {
  if (FILE* file = stream_of(STDOUT_FILENO, "w")) stdout = file;
}

}  // namespace robomill::faults

using namespace robomill::faults;  // NOLINT(google-build-using-namespace): the names below are the C library's

ROBOMILL_INTERPOSED FILE* fopen(const char* path, const char* mode) {
  if (counts(AT_FDCWD, path)) return open_stream(path, mode);
  static FILE* (*const real)(const char*, const char*) = next_of<FILE* (*)(const char*, const char*)>("fopen");
  return real(path, mode);
}
ROBOMILL_INTERPOSED FILE* fopen64(const char* path, const char* mode) {
  return fopen(path, mode);
}
ROBOMILL_INTERPOSED int fileno(FILE* file) noexcept {
  for (const Stream& stream : streams) {
    if (stream.file == file) return stream.descriptor;
  }
  static int (*const real)(FILE*) = next_of<int (*)(FILE*)>("fileno");
  return real(file);
}
