#pragma once
#include <filesystem>

namespace robomill::io {

/// While it lives, no file outside one folder is read or written through io/, whatever a document names: for a server,
/// whose clients name files. Links are followed before the decision.
class Confinement {
 public:
  /// @throws InvalidInput if there is no such folder, or another one lives
  explicit Confinement(const std::filesystem::path& folder);
  ~Confinement();
  Confinement(const Confinement&) = delete;
  Confinement& operator=(const Confinement&) = delete;
};

/// Whether one lives.
[[nodiscard]] bool is_confined();

/// Before a file is opened. @throws InvalidInput if a Confinement lives and the path leads out of its folder, or
/// through a link without a target
void require_inside(const std::filesystem::path& path);

}  // namespace robomill::io
