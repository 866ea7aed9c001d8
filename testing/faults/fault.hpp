#pragma once
// What the shim and its runner agree on: the kinds of faults, the variables that ask for one, and the report.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace robomill::faults {

/// What happens at the n-th call that it applies to.
enum class Kind : unsigned char {
  no_space,     ///< ENOSPC, once
  io_error,     ///< EIO, once
  interrupted,  ///< EINTR, once
  short_write,  ///< half of the bytes are written
  disk_full,    ///< ENOSPC, from there on
  disk_lost,    ///< EIO of all that changes something, from there on
  killed,       ///< SIGKILL before the call; a write has written half
  no_memory     ///< an allocation fails, once
};
constexpr std::size_t kind_count = 8;
constexpr std::array<const char*, kind_count> kind_names = {"ENOSPC",    "EIO",       "EINTR",   "short write",
                                                            "full disk", "lost disk", "kill -9", "no memory"};
constexpr std::array<Kind, kind_count> all_kinds = {Kind::no_space,    Kind::io_error,  Kind::interrupted,
                                                    Kind::short_write, Kind::disk_full, Kind::disk_lost,
                                                    Kind::killed,      Kind::no_memory};

/// What was called. Opening to read and opening to write differ, since a full disk can still be read. Only what was
/// opened to write is closed with consequences.
enum class Call : unsigned char {
  open,
  create,
  read,
  write,
  print,
  sync,
  close,
  rename,
  truncate,
  make_folder,
  allocate
};
constexpr std::size_t call_count = 11;
constexpr std::array<const char*, call_count> call_names = {
    "open", "create", "read", "write", "print", "sync", "close", "rename", "truncate", "make folder", "allocate"};

/// Whether a kind can happen to a call. EINTR of opening to read and of printing to standard output is left out: the
/// program's signal handlers restart them (SA_RESTART), and streams of the C library do not go on after it.
constexpr bool applies(Kind kind, Call call) {
  const bool allocates = call == Call::allocate;
  const bool only_reads = call == Call::open || call == Call::read;
  switch (kind) {
    case Kind::no_memory:
      return allocates;
    case Kind::io_error:
      return !allocates;
    case Kind::disk_lost:
    case Kind::killed:
    case Kind::no_space:
      return !allocates && !only_reads;
    case Kind::disk_full:
      return !allocates && !only_reads && call != Call::close && call != Call::rename;
    case Kind::short_write:
      return call == Call::write || call == Call::print;
    case Kind::interrupted:
      return !allocates && call != Call::open && call != Call::print && call != Call::rename &&
             call != Call::make_folder;
  }
  return false;
}

/// A file that both map: it survives whatever ends the program, and its children count on.
struct Report {
  std::array<std::atomic<std::uint64_t>, kind_count> calls;  ///< to which each kind applies
  std::atomic<std::uint64_t> reached;                        ///< how often the fault happened
  std::atomic<unsigned char> call;                           ///< the Call that it first happened to
  std::array<char, 256> file;                                ///< and its file
  /// Files that were renamed with bytes that a loss of power would take from them, and folders whose renamed entries it
  /// would take back.
  std::atomic<std::uint64_t> unsynced_files, unsynced_folders;
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "processes share it");

// The environment of the program.
constexpr const char* fault_variable = "ROBOMILL_FAULT";          ///< KIND:N, the kind by its number; N = 0: none
constexpr const char* folder_variable = "ROBOMILL_FAULT_FOLDER";  ///< only files below it count; canonical
constexpr const char* stdout_variable = "ROBOMILL_FAULT_STDOUT";  ///< set: standard output counts too
constexpr const char* report_variable = "ROBOMILL_FAULT_REPORT";  ///< a file as large as Report

}  // namespace robomill::faults
