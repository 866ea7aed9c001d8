#pragma once
#include <functional>
#include <set>
#include <string>
#include <string_view>

namespace robomill::io {

/// While it lives, which settings (TomlSource::settings) the documents that this thread reads have asked for. A
/// document counts once it is gone. The innermost counts.
class SettingsUse {
 public:
  SettingsUse();
  ~SettingsUse();
  SettingsUse(const SettingsUse&) = delete;
  SettingsUse& operator=(const SettingsUse&) = delete;

  [[nodiscard]] bool has(std::string_view key) const { return keys_.contains(key); }
  void add(std::string_view key) { keys_.emplace(key); }
  /// Of this thread; null: none lives.
  [[nodiscard]] static SettingsUse* current();

 private:
  SettingsUse* before_;
  std::set<std::string, std::less<>> keys_;
};

}  // namespace robomill::io
