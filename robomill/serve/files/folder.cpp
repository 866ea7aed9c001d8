#include "robomill/serve/files/folder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/confinement.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

constexpr int deepest = 6;

bool hidden(const fs::path& name) {
  return name.string().starts_with('.');
}

}  // namespace

std::string time_text(fs::file_time_type time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     std::chrono::floor<std::chrono::seconds>(std::chrono::file_clock::to_sys(time)));
}

void require_folder(const fs::path& root) {
  std::error_code error;
  const fs::directory_iterator content(root, error);
  if (!error) return;
  const bool gone = error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory;
  throw InvalidInput("folder", gone ? "the folder that is served is gone" : "the folder that is served cannot be read",
                     "Put it back and start robomill serve anew");
}

Folder::Folder(const fs::path& root) {
  std::error_code error;
  root_ = fs::canonical(root, error);
  if (error || !fs::is_directory(root_, error)) {
    throw InvalidInput(root.string(), "there is no such folder", "robomill serve FOLDER; the present one without");
  }
}

fs::path Folder::resolve(std::string_view relative) const {
  const auto reject = [&](const char* rule) {
    return InvalidInput("path", printable(std::string(relative)) + " " + rule);
  };
  if (relative.empty() || relative.size() > 1024) throw reject("must be a path of up to 1,024 bytes");
  for (const char letter : relative) {
    if (static_cast<unsigned char>(letter) < 0x20 || letter == '\\')
      throw reject("must not hold control characters or \\");
  }
  const fs::path path{relative};
  if (path.is_absolute()) throw reject("must be relative to the folder that is served");
  for (const fs::path& part : path) {
    if (part == "..") throw reject("must not lead upwards");
    if (part.empty() || hidden(part)) throw reject("must not have empty or hidden parts");
  }
  io::require_inside(root_ / path);
  return root_ / path;
}

/// Breadth first: what is far down leaves out nothing above it.
std::vector<FolderFile> Folder::list(std::size_t& left_out, std::size_t most) {
  struct Place {
    fs::path folder;
    int depth = 0;
  };
  left_out = 0;
  std::size_t seen = 0;
  const std::size_t most_seen = 100 * most;  // a folder like / : enough is enough
  std::vector<FolderFile> out;
  std::deque<Place> places = {{root_, 0}};
  for (; !places.empty() && seen < most_seen; places.pop_front()) {
    const auto [folder, depth] = places.front();
    // One that cannot be read, or goes meanwhile, has nothing in it.
    std::error_code error;
    fs::directory_iterator it(folder, error);
    for (; !error && it != fs::directory_iterator() && seen < most_seen; it.increment(error)) {
      std::error_code ignored;
      ++seen;
      if (hidden(it->path().filename()) || it->is_symlink(ignored)) continue;
      if (it->is_directory(ignored)) {
        if (depth < deepest) places.push_back({it->path(), depth + 1});
      } else if (it->is_regular_file(ignored)) {
        if (out.size() < most) {
          out.push_back(look_at(*it));
        } else {
          ++left_out;
        }
      }
    }
  }
  std::ranges::sort(out, {}, &FolderFile::path);
  known_.clear();
  for (const FolderFile& file : out) known_.emplace(file.path, file);
  return out;
}

/// Its kind anew only where it changed.
FolderFile Folder::look_at(const fs::directory_entry& entry) const {
  std::error_code ignored;
  FolderFile file;
  file.path = entry.path().lexically_relative(root_).generic_string();
  file.bytes = entry.file_size(ignored);
  file.modified = entry.last_write_time(ignored);
  const auto known = known_.find(file.path);
  const bool same =
      known != known_.end() && known->second.bytes == file.bytes && known->second.modified == file.modified;
  file.what = same ? known->second.what : kind_of_file(entry.path());
  return file;
}

std::string Folder::read(const fs::path& path, std::uint64_t most_bytes) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && fs::file_size(path, ignored) == 0) return {};
  return io::read_file(path, most_bytes);
}

void Folder::write(const fs::path& path, std::string_view content) {
  io::make_folder(path.parent_path());
  io::write_file(path, content);
}

std::string Folder::tag_of(std::string_view content) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a: tells versions apart, guards nothing
  for (const char letter : content) hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
  return fmt::format("\"{:016x}-{}\"", hash, content.size());
}

}  // namespace robomill::serve
