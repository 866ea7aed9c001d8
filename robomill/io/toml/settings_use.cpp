#include "robomill/io/toml/settings_use.hpp"

namespace robomill::io {
namespace {

thread_local SettingsUse* innermost_use = nullptr;

}  // namespace

SettingsUse::SettingsUse() : before_(innermost_use) {
  innermost_use = this;
}

SettingsUse::~SettingsUse() {
  innermost_use = before_;
}

SettingsUse* SettingsUse::current() {
  return innermost_use;
}

}  // namespace robomill::io
