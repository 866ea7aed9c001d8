#pragma once
#include <filesystem>

#include "robomill/base/export.hpp"

/// The temporary files that there are, where a signal handler that ends the process can read them.
namespace robomill::io {

/// A temporary file that is about to be written. Past 64 at once, or with a name longer than the system takes, it is
/// one that remove_pending_files() does not know.
void register_pending(const std::filesystem::path& path) noexcept;
/// It has been moved to its place, or removed.
void forget_pending(const std::filesystem::path& path) noexcept;

/// Whether it is one of them, by its name.
[[nodiscard]] bool is_pending(const std::filesystem::path& path) noexcept;

/// Removes all of them: async-signal-safe.
ROBOMILL_API void remove_pending_files() noexcept;

}  // namespace robomill::io
