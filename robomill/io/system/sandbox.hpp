#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace robomill::io {

/// What may still be opened. Of a folder all below it; what is not there is left out.
struct FileRights {
  std::vector<std::filesystem::path> readable = {};
  std::vector<std::filesystem::path> writable = {};  ///< read too
  std::vector<std::filesystem::path> programs = {};  ///< read and started
  /// False: no socket of any kind (by seccomp, on x86-64 and aarch64), no TCP, no look into other programs, as far as
  /// the kernel can forbid them. Sanitized builds, whose tools look into programs, leave seccomp out.
  bool connects = true;
};

/// From here on the calling thread, and the threads and programs that it starts, open no other file, whatever they are
/// made to do: by Landlock, for ever. What is open already stays open. Nor do they signal programs beside them (Linux
/// 6.12).
/// False where the kernel has no Landlock: nothing has changed then.
bool restrict_files(const FileRights& rights);

/// From here on this process can open so many more descriptors than it has now. It needs nothing of the kernel.
void restrict_to_more_files(int count);

/// From here on this process may have so much memory of its own [bytes]; beyond it std::bad_alloc is thrown. Sanitized
/// builds know no limit: their shadow memory is not told apart.
void limit_own_memory(std::uint64_t bytes);

/// All memory of the machine, or of the container that this is in [bytes]; 0 where the system does not say.
[[nodiscard]] std::uint64_t machine_memory_bytes();

/// Files that this program and its libraries were loaded from.
[[nodiscard]] std::vector<std::filesystem::path> loaded_files();

}  // namespace robomill::io
