#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/file.hpp"

namespace robomill::io {

/// Files of one folder that belong together: after commit() all of them are new, and after a failure all of them are
/// the old ones. Where the process is killed while it puts them in their places, a marker remains that names them:
/// reading one of them is an error then, until another change of the folder has been completed.
class FolderChange {
 public:
  /// Makes the folder; empty: that in which the process works. @throws InvalidInput if it cannot be made
  explicit FolderChange(std::filesystem::path folder);
  ~FolderChange();
  FolderChange(const FolderChange&) = delete;
  FolderChange& operator=(const FolderChange&) = delete;

  /// A file of it. @throws InvalidInput if it cannot be written
  void write(const std::string& name, std::string_view content);
  /// A file of that name which somebody else has written; it lives until commit() has returned.
  void add(const std::string& name, PendingFile& file);
  /// A regular file that goes, where it is there.
  void remove(const std::string& name);
  /// @throws InvalidInput if that fails
  void commit();

 private:
  struct Place;
  void remove_stray(std::string_view name);
  void find_old();
  void take_place(Place& place);
  void synchronise_folders() const;
  bool undo() noexcept;

  std::filesystem::path folder_;
  std::vector<std::unique_ptr<PendingFile>> own_;
  std::vector<Place> places_;
};

/// Whether a file belongs to a change of its folder that was not completed. Waits for one that is being made.
[[nodiscard]] bool is_unfinished(const std::filesystem::path& path);
/// Before a file is read. @throws InvalidInput if it is unfinished
void require_completed(const std::filesystem::path& path);

}  // namespace robomill::io
