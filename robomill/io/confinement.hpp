#pragma once
#include <filesystem>

#include "robomill/base/export.hpp"

namespace robomill::io {

/// While it lives, no file outside one folder is read or written through io/, whatever a document names: for a server,
/// whose clients name files. Links are followed before the decision. One at a time.
class ROBOMILL_API Confinement {
 public:
  /// @throws InvalidInput if there is no such folder
  explicit Confinement(const std::filesystem::path& folder);
  ~Confinement();
  Confinement(const Confinement&) = delete;
  Confinement& operator=(const Confinement&) = delete;
};

/// Before a file is opened. @throws InvalidInput if a Confinement lives and the path leads out of its folder
void require_inside(const std::filesystem::path& path);

}  // namespace robomill::io
