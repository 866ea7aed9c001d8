#include "robomill/io/system/pending_names.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <climits>
#include <cstddef>
#include <mutex>
#include <string>

namespace robomill::io {
namespace {

/// One name: a fixed place, no pointers, so that it can be read whatever the threads are at.
struct PendingName {
  std::atomic<bool> used{false};
  std::array<char, PATH_MAX> path = {};
};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler reads it");

constexpr std::size_t most_names = 64;
std::array<PendingName, most_names> names;
std::mutex changing;  // not for the signal handler

}  // namespace

void register_pending(const std::filesystem::path& path) noexcept {
  const std::string& text = path.native();
  if (text.size() >= PATH_MAX) return;
  const std::scoped_lock lock(changing);
  const auto name = std::ranges::find_if(names, [](const PendingName& each) { return !each.used; });
  if (name == names.end()) return;
  *std::ranges::copy(text, name->path.begin()).out = '\0';
  name->used = true;
}

void forget_pending(const std::filesystem::path& path) noexcept {
  const std::scoped_lock lock(changing);
  for (PendingName& name : names) {
    if (name.used && path.native() == name.path.data()) name.used = false;
  }
}

bool is_pending(const std::filesystem::path& path) noexcept {
  const std::scoped_lock lock(changing);
  return std::ranges::any_of(names,
                             [&](const PendingName& name) { return name.used && path.native() == name.path.data(); });
}

void remove_pending_files() noexcept {
  for (const PendingName& name : names) {
    if (name.used) ::unlink(name.path.data());
  }
}

}  // namespace robomill::io
