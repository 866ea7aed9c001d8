#include "robomill/io/confinement.hpp"

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

}  // namespace

Confinement::Confinement(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error || !fs::is_directory(real, error)) throw InvalidInput(folder.string(), "there is no such folder");
  const std::lock_guard lock(bounds().changing);
  bounds().folder = std::make_shared<const fs::path>(real);
}

Confinement::~Confinement() {
  const std::lock_guard lock(bounds().changing);
  bounds().folder.reset();
}

void require_inside(const fs::path& path) {
  std::shared_ptr<const fs::path> folder;
  {
    const std::lock_guard lock(bounds().changing);
    folder = bounds().folder;
  }
  if (!folder) return;
  std::error_code error;
  const fs::path real = fs::weakly_canonical(fs::absolute(path, error), error);
  const auto [end, rest] = std::mismatch(folder->begin(), folder->end(), real.begin(), real.end());
  static_cast<void>(rest);
  if (error || end != folder->end()) {
    throw InvalidInput(path.string(), "lies outside the folder that is served",
                       "Put the file into the folder, or serve a folder above both");
  }
}

}  // namespace robomill::io
