#include "testing/fuzz/input.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>

#include "robomill/io/system/confinement.hpp"

namespace robomill::fuzz {
namespace {

class FolderInMemory {
 public:
  FolderInMemory() : path_("/dev/shm/robomill-fuzz-" + std::to_string(::getpid())) {
    std::filesystem::create_directories(path_);
    confinement_.emplace(path_);
  }
  ~FolderInMemory() {
    confinement_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  FolderInMemory(const FolderInMemory&) = delete;
  FolderInMemory& operator=(const FolderInMemory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<io::Confinement> confinement_;
};

}  // namespace

const std::filesystem::path& folder() {
  static const FolderInMemory made;
  return made.path();
}

const std::filesystem::path& file_of(std::string_view bytes, std::string_view ending) {
  static std::filesystem::path path;
  if (!path.empty()) std::filesystem::remove(path);
  path = folder() / ("input" + std::string(ending));
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

Labelled labelled(std::string_view bytes) {
  const std::size_t end = bytes.find('\n');
  if (end == std::string_view::npos) return {bytes, {}};
  return {bytes.substr(0, end), bytes.substr(end + 1)};
}

void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

}  // namespace robomill::fuzz
