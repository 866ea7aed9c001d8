#pragma once
// The parts of the shim. Nothing in it allocates, and it needs the C library alone.
#include <sys/types.h>

#include "testing/faults/fault.hpp"

namespace robomill::faults {

/// How a call ends in place of what was asked.
struct Verdict {
  int error = 0;      ///< the errno that it fails with; 0: it works
  bool half = false;  ///< a write writes half
  bool dies = false;  ///< and is the program's last
};

/// Counts a call and says how it ends.
/// @param file  whatever names the file in the report
Verdict next(Call call, const char* file) noexcept;
/// The same of a descriptor's file.
Verdict next(Call call, int descriptor) noexcept;

/// Whether a path, relative to an open folder, lies below the folder that counts.
bool counts(int folder, const char* path) noexcept;
bool counts(int descriptor) noexcept;
bool is_written(int descriptor) noexcept;
/// The descriptor is one of a file that counts.
void track(int descriptor, bool written) noexcept;
void forget(int descriptor) noexcept;
void copy(int from, int to) noexcept;

/// Has a descriptor's file bytes that are not known to be on the disk? Writing sets it, syncing ends it.
void note_write(int descriptor) noexcept;
void note_sync(int descriptor) noexcept;
/// A file has come to its place in a folder.
void note_rename(int folder, const char* to) noexcept;
/// kill -9 of oneself.
[[noreturn]] void die() noexcept;

// The calls with their faults, as the interposed ones make them: -1 and errno on failure.
int open_counted(int folder, const char* path, int flags, mode_t mode) noexcept;
ssize_t write_counted(int descriptor, const void* bytes, std::size_t size) noexcept;
ssize_t read_counted(int descriptor, void* bytes, std::size_t size) noexcept;
int close_counted(int descriptor) noexcept;

/// Standard output becomes a stream whose writes count.
void count_stdout() noexcept;
/// Allocations count while main runs, from the first file on that is opened: the parser of the command line is a
/// library's, and ends the program where it has no memory.
void note_open() noexcept;
bool is_at_work() noexcept;

}  // namespace robomill::faults

#define ROBOMILL_INTERPOSED extern "C" __attribute__((visibility("default")))
