#include "robomill/io/system/confinement.hpp"

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <system_error>

#include "robomill/base/error.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

struct Bounds {
  std::mutex changing;
  std::shared_ptr<const fs::path> folder = {};
};
Bounds& bounds() {
  static Bounds one;
  return one;
}

std::shared_ptr<const fs::path> confined_to() {
  const std::lock_guard lock(bounds().changing);
  return bounds().folder;
}

/// A link to what is not there: who writes to it makes a file wherever it leads.
bool has_dangling_link(const fs::path& absolute) {
  std::error_code ignored;
  fs::path way;
  for (const fs::path& part : absolute) {
    way /= part;
    if (fs::exists(way, ignored)) continue;
    return fs::is_symlink(way, ignored);
  }
  return false;
}

}  // namespace

Confinement::Confinement(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error || !fs::is_directory(real, error)) throw InvalidInput(folder.string(), "there is no such folder");
  const std::lock_guard lock(bounds().changing);
  if (bounds().folder) {
    throw InvalidInput(folder.string(), "cannot be the folder to stay in while this program stays in another",
                       "One server at a time in a program");
  }
  bounds().folder = std::make_shared<const fs::path>(real);
}

Confinement::~Confinement() {
  const std::lock_guard lock(bounds().changing);
  bounds().folder.reset();
}

bool is_confined() {
  return confined_to() != nullptr;
}

void require_inside(const fs::path& path) {
  const std::shared_ptr<const fs::path> folder = confined_to();
  if (!folder) return;
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (has_dangling_link(absolute)) throw InvalidInput(path.string(), "is a link to a file that is not there");
  const fs::path real = fs::weakly_canonical(absolute, error);
  const auto [end, rest] = std::mismatch(folder->begin(), folder->end(), real.begin(), real.end());
  static_cast<void>(rest);
  if (error || end != folder->end()) {
    throw InvalidInput(path.string(), "lies outside the folder that is served",
                       "Put the file into the folder, or serve a folder above both");
  }
}

}  // namespace robomill::io
