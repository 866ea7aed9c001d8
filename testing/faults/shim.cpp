// Which call fails: set up from the environment, counted in the report.
#include "testing/faults/shim.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace robomill::faults {
namespace {

constexpr int most_descriptors = 4096;
enum : unsigned char { counted = 1, written = 2 };

Report* report = nullptr;  // null: nothing counts
Kind kind = Kind::no_space;
std::uint64_t nth = 0;
char root[PATH_MAX] = {};
std::atomic<unsigned char> descriptors[most_descriptors];
std::atomic<bool> in_main{false}, has_opened{false};

/// Files or folders, by their inodes, of which something is not on the disk.
struct Unsynced {
  std::array<std::atomic<std::uint64_t>, 256> inodes;  // 0: none

  bool add(std::uint64_t inode) noexcept {
    for (const auto& each : inodes) {
      if (each == inode) return false;
    }
    for (auto& each : inodes) {
      std::uint64_t none = 0;
      if (each.compare_exchange_strong(none, inode)) return true;
    }
    return false;
  }
  bool remove(std::uint64_t inode) noexcept {
    for (auto& each : inodes) {
      std::uint64_t there = inode;
      if (each.compare_exchange_strong(there, 0)) return true;
    }
    return false;
  }
};
Unsynced files, folders;

/// a/./b/../c to a/c, in place; the path is absolute.
void normalise(char* path) noexcept {
  char* out = path;
  for (const char* in = path; *in != '\0';) {
    while (*in == '/') ++in;
    const std::size_t length = std::strcspn(in, "/");
    if (length == 2 && in[0] == '.' && in[1] == '.') {
      while (out > path && *--out != '/') {
      }
    } else if (length > 0 && !(length == 1 && in[0] == '.')) {
      *out++ = '/';
      std::memmove(out, in, length);
      out += length;
    }
    in += length;
  }
  *out = '\0';
}

void name_of(int descriptor, char* name, std::size_t size) noexcept {
  char link[32];
  std::snprintf(link, sizeof(link), "/proc/self/fd/%d", descriptor);
  const long length = ::syscall(SYS_readlink, link, name, size - 1);
  name[length > 0 ? length : 0] = '\0';
}

void set_up() noexcept {
  const char* path = std::getenv(report_variable);
  const char* fault = std::getenv(fault_variable);
  const char* folder = std::getenv(folder_variable);
  if (path == nullptr || fault == nullptr || folder == nullptr || std::strlen(folder) >= sizeof(root)) return;
  const long file = ::syscall(SYS_openat, AT_FDCWD, path, O_RDWR | O_CLOEXEC, 0);
  if (file < 0) return;
  void* mapped = ::mmap(nullptr, sizeof(Report), PROT_READ | PROT_WRITE, MAP_SHARED, static_cast<int>(file), 0);
  ::syscall(SYS_close, file);
  if (mapped == MAP_FAILED) return;
  char* end = nullptr;
  kind = static_cast<Kind>(std::strtoul(fault, &end, 10));
  nth = *end == ':' ? std::strtoull(end + 1, nullptr, 10) : 0;
  std::strcpy(root, folder);
  report = static_cast<Report*>(mapped);
  if (std::getenv(stdout_variable) != nullptr) {
    track(STDOUT_FILENO, true);
    // Its buffer is one more allocation: only where files are counted.
    if (kind != Kind::no_memory) count_stdout();
  }
}

using Main = int (*)(int, char**, char**);
Main real_main = nullptr;

int counted_main(int count, char** words, char** environment) {
  set_up();
  in_main = true;
  const int status = real_main(count, words, environment);
  in_main = false;
  return status;
}

}  // namespace

Verdict next(Call call, const char* file) noexcept {
  if (report == nullptr) return {};
  std::uint64_t number = 0;
  for (const Kind each : all_kinds) {
    if (!applies(each, call)) continue;
    const std::uint64_t now = report->calls[static_cast<std::size_t>(each)].fetch_add(1) + 1;
    if (each == kind) number = now;
  }
  const bool lasts = kind == Kind::disk_full || kind == Kind::disk_lost;
  if (nth == 0 || number == 0 || (lasts ? number < nth : number != nth)) return {};
  if (report->reached.fetch_add(1) == 0) {
    report->call = static_cast<unsigned char>(call);
    std::strncpy(report->file.data(), file, report->file.size() - 1);
  }
  switch (kind) {
    case Kind::io_error:
    case Kind::disk_lost:
      return {.error = EIO};
    case Kind::interrupted:
      return {.error = EINTR};
    case Kind::short_write:
      return {.half = true};
    case Kind::no_memory:
      return {.error = ENOMEM};
    case Kind::killed:
      if (call == Call::write || call == Call::print) return {.half = true, .dies = true};
      die();
    case Kind::no_space:
    case Kind::disk_full:
      break;
  }
  return {.error = ENOSPC};
}

void die() noexcept {
  for (;;) ::kill(::getpid(), SIGKILL);
}

void note_write(int descriptor) noexcept {
  struct stat status;
  if (counts(descriptor) && ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) files.add(status.st_ino);
}

void note_sync(int descriptor) noexcept {
  struct stat status;
  if (!counts(descriptor) || ::fstat(descriptor, &status) != 0) return;
  if (!S_ISDIR(status.st_mode)) {
    files.remove(status.st_ino);
  } else if (folders.remove(status.st_ino)) {
    --report->unsynced_folders;
  }
}

void note_rename(int folder, const char* to) noexcept {
  struct stat status;
  if (!counts(folder, to)) return;
  if (::fstatat(folder, to, &status, 0) == 0 && files.remove(status.st_ino)) ++report->unsynced_files;
  char parent[PATH_MAX] = ".";
  if (const char* name = std::strrchr(to, '/')) {
    const auto length = static_cast<std::size_t>(name - to);
    if (length >= sizeof(parent)) return;
    std::memcpy(parent, to, length + 1);
    parent[length + 1] = '\0';
  }
  if (::fstatat(folder, parent, &status, 0) == 0 && folders.add(status.st_ino)) ++report->unsynced_folders;
}

Verdict next(Call call, int descriptor) noexcept {
  if (!counts(descriptor)) return {};
  char name[256];
  name_of(descriptor, name, sizeof(name));
  return next(call == Call::write && descriptor == STDOUT_FILENO ? Call::print : call, name);
}

bool counts(int folder, const char* path) noexcept {
  if (report == nullptr || path == nullptr) return false;
  char whole[2 * PATH_MAX] = {};
  if (std::strlen(path) >= PATH_MAX) return false;
  if (path[0] == '/') {
    std::strcpy(whole, path);
  } else {
    if (folder == AT_FDCWD) {
      if (::syscall(SYS_getcwd, whole, PATH_MAX) <= 0) return false;
    } else {
      name_of(folder, whole, PATH_MAX);
    }
    std::strcat(whole, "/");
    std::strcat(whole, path);
  }
  normalise(whole);
  const std::size_t length = std::strlen(root);
  return std::strncmp(whole, root, length) == 0 && (whole[length] == '/' || whole[length] == '\0');
}

bool counts(int descriptor) noexcept {
  return descriptor >= 0 && descriptor < most_descriptors && (descriptors[descriptor] & counted) != 0;
}

bool is_written(int descriptor) noexcept {
  return counts(descriptor) && (descriptors[descriptor] & written) != 0;
}

void track(int descriptor, bool is_for_writing) noexcept {
  if (descriptor < 0 || descriptor >= most_descriptors) return;
  descriptors[descriptor] = static_cast<unsigned char>(counted | (is_for_writing ? written : 0));
}

void forget(int descriptor) noexcept {
  if (descriptor >= 0 && descriptor < most_descriptors) descriptors[descriptor] = 0;
}

void copy(int from, int to) noexcept {
  if (to < 0 || to >= most_descriptors) return;
  descriptors[to] = counts(from) ? descriptors[from].load() : static_cast<unsigned char>(0);
}

void note_open() noexcept {
  has_opened = true;
}

bool is_at_work() noexcept {
  return in_main && has_opened;
}

}  // namespace robomill::faults

// Libraries that are loaded before main allocate and open what is none of the program's: counting begins with main.
ROBOMILL_INTERPOSED int __libc_start_main(robomill::faults::Main main, int count, char** words, void (*init)(),
                                          void (*fini)(), void (*unload)(), void* stack) {
  using Start = int (*)(robomill::faults::Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  robomill::faults::real_main = main;
  return start(robomill::faults::counted_main, count, words, init, fini, unload, stack);
}
