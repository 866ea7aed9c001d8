#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/serve/files/kind.hpp"

// Method: robomill/serve/README.md, "Files"

namespace robomill::serve {

/// A file of the folder that is served.
struct FolderFile {
  std::string path = {};  ///< relative, with /
  FileKind what = {};
  std::uint64_t bytes = 0;
  std::filesystem::file_time_type modified = {};
  bool operator==(const FolderFile&) const = default;
};

/// "2026-11-27T18:57:00Z"
[[nodiscard]] std::string time_text(std::filesystem::file_time_type time);

/// Before anything is read or written below it, which would be made anew.
/// @throws InvalidInput if the folder that is served was taken away or cannot be read
void require_folder(const std::filesystem::path& root);

/// The folder that is served. Nothing outside it is read or written, nor what has a name with a dot in front.
class Folder {
 public:
  static constexpr std::uint64_t most_text_bytes = std::uint64_t{4} << 20;
  static constexpr std::uint64_t most_file_bytes = std::uint64_t{32} << 20;

  /// @throws InvalidInput if there is no such folder
  explicit Folder(const std::filesystem::path& root);

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  /// Where a relative path of a client's leads; there may be nothing yet.
  /// @throws InvalidInput if it is empty, absolute, has "..", a hidden part or a control character, or leads out of the
  ///     folder through a link
  [[nodiscard]] std::filesystem::path resolve(std::string_view relative) const;
  /// Visible files, to a depth of 6, at most `most`, those in few folders first; by path. Kinds of unchanged files are
  /// remembered.
  [[nodiscard]] std::vector<FolderFile> list(std::size_t& left_out, std::size_t most = 2000);
  /// The content of a file. @throws InvalidInput if it is missing or longer
  [[nodiscard]] static std::string read(const std::filesystem::path& path, std::uint64_t most_bytes = most_text_bytes);
  /// Whole or not at all; folders on the way are made. @throws InvalidInput
  static void write(const std::filesystem::path& path, std::string_view content);
  /// Changes with the content.
  [[nodiscard]] static std::string tag_of(std::string_view content);

 private:
  [[nodiscard]] FolderFile look_at(const std::filesystem::directory_entry& entry) const;

  std::filesystem::path root_;
  std::map<std::string, FolderFile> known_ = {};
};

}  // namespace robomill::serve
