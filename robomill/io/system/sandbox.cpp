#include "robomill/io/system/sandbox.hpp"

#include <fcntl.h>
#include <link.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <fstream>
#include <string_view>
#include <system_error>

#include "robomill/io/system/sanitized.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

// What kernels can do that are younger than the header of Debian 12: Landlock ABI 3 to 6.
constexpr std::uint64_t access_truncate = 1ULL << 14, access_ioctl_dev = 1ULL << 15;
constexpr std::uint64_t access_bind_tcp = 1ULL << 0, access_connect_tcp = 1ULL << 1;
constexpr std::uint64_t scope_abstract_unix_socket = 1ULL << 0, scope_signal = 1ULL << 1;

constexpr std::uint64_t reading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t writing = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                  LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR |
                                  LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REFER | access_truncate;
/// All that the first version knows.
constexpr std::uint64_t known_at_first = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1U) - 1U;
/// A rule of a file, not a folder, may have no other.
constexpr std::uint64_t of_files = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE |
                                   LANDLOCK_ACCESS_FS_READ_FILE | access_truncate | access_ioctl_dev;

/// As the kernel has it from ABI 6 on. An older one takes it where the members that it does not know are 0.
struct Ruleset {
  std::uint64_t files = 0, network = 0, scoped = 0;
};

/// What a kernel can forbid.
Ruleset forbidden(long abi, bool connects) {
  Ruleset out = {.files = known_at_first};
  if (abi >= 2) out.files |= LANDLOCK_ACCESS_FS_REFER;
  if (abi >= 3) out.files |= access_truncate;
  if (abi >= 4 && !connects) out.network = access_bind_tcp | access_connect_tcp;
  if (abi >= 5) out.files |= access_ioctl_dev;
  if (abi >= 6) out.scoped = connects ? scope_signal : scope_signal | scope_abstract_unix_socket;
  return out;
}

/// What Landlock leaves open: UDP, sockets of other programs by their path, other programs' memory. Of this thread and
/// those that it starts; io_uring would do the same by another way. Where the kernel has no seccomp, nothing.
void forbid_connections() {
#if defined(__x86_64__)
  constexpr std::uint32_t machine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
  constexpr std::uint32_t machine = AUDIT_ARCH_AARCH64;
#else
  constexpr std::uint32_t machine = 0;  // whose numbers are not known
#endif
  if (sanitized || machine == 0) return;
  constexpr std::uint32_t first_of_x32 = 0x40000000;
  const auto load = [](std::size_t offset) {
    return sock_filter{.code = BPF_LD | BPF_W | BPF_ABS, .jt = 0, .jf = 0, .k = static_cast<std::uint32_t>(offset)};
  };
  const auto go_on_unless = [](unsigned comparison, std::uint32_t value) {
    return sock_filter{.code = static_cast<std::uint16_t>(BPF_JMP | comparison | BPF_K), .jt = 0, .jf = 1, .k = value};
  };
  const auto end = [](std::uint32_t action) {
    return sock_filter{.code = BPF_RET | BPF_K, .jt = 0, .jf = 0, .k = action};
  };
  const sock_filter denied = end(SECCOMP_RET_ERRNO | EACCES);
  std::vector<sock_filter> program = {load(offsetof(seccomp_data, arch)),
                                      {.code = BPF_JMP | BPF_JEQ | BPF_K, .jt = 1, .jf = 0, .k = machine},
                                      denied,
                                      load(offsetof(seccomp_data, nr)),
                                      go_on_unless(BPF_JGE, first_of_x32),
                                      denied};
  constexpr int io_uring_setup = 425;  // of all machines
  for (const int call :
       {SYS_socket, SYS_connect, SYS_ptrace, SYS_process_vm_readv, SYS_process_vm_writev, io_uring_setup}) {
    program.push_back(go_on_unless(BPF_JEQ, static_cast<std::uint32_t>(call)));
    program.push_back(denied);
  }
  program.push_back(end(SECCOMP_RET_ALLOW));
  const sock_fprog filter = {.len = static_cast<unsigned short>(program.size()), .filter = program.data()};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}

/// What cannot be opened to make the rule cannot be opened later either.
void allow(int ruleset, const fs::path& path, std::uint64_t access) {
  const int place = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (place < 0) return;
  struct stat what = {};
  if (::fstat(place, &what) == 0) {
    landlock_path_beneath_attr rule = {};
    rule.allowed_access = S_ISDIR(what.st_mode) ? access : access & of_files;
    rule.parent_fd = place;
    ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0U);
  }
  ::close(place);
}

}  // namespace

bool restrict_files(const FileRights& rights) {
  if (!rights.connects) forbid_connections();
  const long abi = ::syscall(SYS_landlock_create_ruleset, nullptr, 0UL, LANDLOCK_CREATE_RULESET_VERSION);
  if (abi < 1) return false;
  const Ruleset wanted = forbidden(abi, rights.connects);
  const int ruleset = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &wanted, sizeof(wanted), 0U));
  if (ruleset < 0) return false;
  for (const fs::path& path : rights.readable) allow(ruleset, path, wanted.files & reading);
  for (const fs::path& path : rights.writable) allow(ruleset, path, wanted.files & (reading | writing));
  for (const fs::path& path : rights.programs) {
    allow(ruleset, path, wanted.files & (reading | LANDLOCK_ACCESS_FS_EXECUTE));
  }
  const bool restricted =
      ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::syscall(SYS_landlock_restrict_self, ruleset, 0U) == 0;
  ::close(ruleset);
  return restricted;
}

void restrict_to_more_files(int count) {
  const int next = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
  if (next < 0) return;
  ::close(next);
  const auto most = static_cast<rlim_t>(next + count);
  const rlimit descriptors{most, most};
  ::setrlimit(RLIMIT_NOFILE, &descriptors);
}

// Of data, not of the address space: threads and allocators set far more of that aside than they use.
void limit_own_memory(std::uint64_t bytes) {
  if (sanitized) return;
  const rlimit memory{bytes, bytes};
  ::setrlimit(RLIMIT_DATA, &memory);
}

std::uint64_t machine_memory_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page = ::sysconf(_SC_PAGESIZE);
  std::uint64_t out = pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
  // A container's: version 2, then 1, which says "none" by a number near 2^63.
  for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::uint64_t limit = 0;
    if (std::ifstream(file) >> limit && limit > 0 && (out == 0 || limit < out)) out = limit;  // "max" is no number
  }
  return out;
}

std::vector<fs::path> loaded_files() {
  std::vector<fs::path> out;
  std::error_code error;
  if (const fs::path program = fs::read_symlink("/proc/self/exe", error); !error) out.push_back(program);
  const auto add = [](dl_phdr_info* info, std::size_t, void* to) {
    const std::string_view name = info->dlpi_name == nullptr ? "" : info->dlpi_name;
    if (name.starts_with('/')) static_cast<std::vector<fs::path>*>(to)->emplace_back(name);
    return 0;
  };
  ::dl_iterate_phdr(add, &out);
  return out;
}

}  // namespace robomill::io
