#include "robomill/io/system/folder_change.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <optional>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* marker_name = ".robomill-unfinished";
constexpr std::size_t most_marker_bytes = std::size_t{1} << 16;

/// Names the files of a change while they take their places, a line each: the file's name and that of the temporary
/// file that takes its place. Whoever changes the folder holds its lock, which ends with the process.
class Marker {
 public:
  /// @param flags  as open() takes them
  static std::optional<Marker> open(const fs::path& folder, int flags, int lock) {
    Marker out;
    out.folder_ = folder;
    out.path_ = folder / marker_name;
    while (true) {
      int error = 0;
      // What is no file of ours, a pipe say, is not waited for.
      out.file_ = open_descriptor(out.path_.c_str(), flags | O_NOFOLLOW | O_NONBLOCK, error);
      if ((flags & O_CREAT) == 0) {
        if (error == ENOENT || error == ENOTDIR) return std::nullopt;
        if (error != 0) throw InvalidInput(out.path_.string(), "cannot be read", error_text(error));
      }
      require_success(out.path_, error);
      while (::flock(out.file_.get(), lock) != 0) {
        if (errno == EINTR) continue;
        if (errno == ENOLCK || errno == EOPNOTSUPP) break;  // the file system knows no locks
        require_success(out.path_, errno);
      }
      struct stat status = {};
      // Whoever had the lock may have completed its change and taken the marker away.
      if (::fstat(out.file_.get(), &status) == 0 && status.st_nlink > 0) return out;
    }
  }

  [[nodiscard]] bool is_empty() const noexcept {
    struct stat status = {};
    return ::fstat(file_.get(), &status) == 0 && status.st_size == 0;
  }
  [[nodiscard]] std::string text() const {
    std::string out(most_marker_bytes, '\0');
    std::size_t count = 0;
    if (read_all_at(file_.get(), out, 0, count) != 0) count = 0;
    out.resize(count);
    return out;
  }

  [[nodiscard]] int put(std::string_view text) const noexcept {
    int error = resize_file(file_.get(), 0);
    if (error == 0) error = write_all_at(file_.get(), text, 0);
    if (error == 0) error = synchronise(file_.get());
    return error != 0 ? error : synchronise_folder(folder_);
  }
  void write(std::string_view text) const { require_success(path_, put(text)); }

  [[nodiscard]] int remove() const noexcept {
    if (const int error = remove_name(path_); error != 0) return error;
    static_cast<void>(synchronise_folder(folder_));  // at worst it is back after a loss of power
    return 0;
  }

 private:
  fs::path folder_, path_;
  Descriptor file_;
};

struct MarkerLine {
  std::string_view name, temporary;
};

std::vector<MarkerLine> lines_of(std::string_view text) {
  std::vector<MarkerLine> out;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t tab = line.find('\t');
    if (tab == std::string_view::npos) continue;
    const MarkerLine found{line.substr(0, tab), line.substr(tab + 1)};
    // Whatever else somebody wrote into a marker, no other file is taken away for it.
    if (fs::path(found.name).has_parent_path() || !is_temporary_name(found.temporary)) continue;
    out.push_back(found);
  }
  return out;
}

}  // namespace

/// A file of the change.
struct FolderChange::Place {
  std::string name;
  PendingFile* file = nullptr;  ///< null: it is removed
  fs::path path;                ///< where it stands, behind a link
  fs::path old;                 ///< where the old file waits until all have their places; empty: there is none
  bool kept = false;            ///< the old file is there
  bool placed = false;          ///< the new one is in its place

  /// Both names that it has in the meantime.
  [[nodiscard]] std::string lines(const fs::path& folder) const {
    std::string out;
    for (const fs::path& temporary : {file != nullptr ? file->temporary() : fs::path(), old}) {
      if (temporary.empty()) continue;
      const bool beside = temporary.parent_path() == folder;
      out += fmt::format("{}\t{}\n", name, beside ? temporary.filename().string() : fs::absolute(temporary).string());
    }
    return out;
  }
};

FolderChange::FolderChange(fs::path folder) : folder_(std::move(folder)) {
  if (!folder_.empty()) make_folder(folder_);
}

FolderChange::~FolderChange() = default;

void FolderChange::write(const std::string& name, std::string_view content) {
  own_.push_back(std::make_unique<PendingFile>(folder_ / name));
  own_.back()->write(content);
  add(name, *own_.back());
}

void FolderChange::add(const std::string& name, PendingFile& file) {
  file.prepare();
  places_.push_back({.name = name, .file = &file, .path = file.path(), .old = {}});
}

void FolderChange::remove(const std::string& name) {
  places_.push_back({.name = name, .path = behind_link(folder_ / name), .old = {}});
}

/// What a change that was ended has written, and this one does not write, is of no run.
void FolderChange::remove_stray(std::string_view name) {
  if (std::ranges::find(places_, name, &Place::name) == places_.end()) remove(std::string(name));
}

/// Regular files alone: what is none of ours is not taken away.
void FolderChange::find_old() {
  std::erase_if(places_, [](Place& place) {
    std::error_code ignored;
    if (fs::is_regular_file(place.path, ignored)) place.old = temporary_name(place.path);
    return place.file == nullptr && place.old.empty();
  });
}

void FolderChange::take_place(Place& place) {
  if (!place.old.empty()) {
    const int error = place.file != nullptr ? keep_file(place.path, place.old) : rename_file(place.path, place.old);
    require_success(place.path, error);
    place.kept = true;
  }
  if (place.file == nullptr) return;
  require_success(place.path, rename_file(place.file->temporary(), place.path));
  place.placed = true;
}

/// What cannot be undone stays where it is, and named in the marker. Whether all was undone.
bool FolderChange::undo() noexcept {
  bool all = true;
  for (auto place = places_.rbegin(); place != places_.rend(); ++place) {
    int error = place->kept ? rename_file(place->old, place->path) : place->placed ? remove_name(place->path) : 0;
    if (error == 0 && place->kept) error = remove_name(place->old);  // two names of one file both stay
    if (error == 0) place->kept = place->placed = false;
    all = all && error == 0;
  }
  return all;
}

void FolderChange::synchronise_folders() const {
  std::vector<fs::path> folders = {folder_};
  for (const Place& place : places_) {
    if (std::ranges::find(folders, place.path.parent_path()) == folders.end())
      folders.push_back(place.path.parent_path());
  }
  for (const fs::path& folder : folders) require_success(folder, synchronise_folder(folder));
}

void FolderChange::commit() {
  const std::optional<Marker> marker = Marker::open(folder_, O_RDWR | O_CREAT, LOCK_EX);
  const bool is_new = marker->is_empty();
  std::optional<std::string> left_behind;  // by a change that was ended
  try {
    left_behind = marker->text();
    const std::vector<MarkerLine> left = lines_of(*left_behind);
    for (const MarkerLine& line : left) remove_stray(line.name);
    find_old();
    std::string text = *left_behind;  // whose temporary files are still to be taken away
    for (const Place& place : places_) text += place.lines(folder_);
    marker->write(text);
    for (Place& place : places_) take_place(place);
    synchronise_folders();
    for (const MarkerLine& line : left) static_cast<void>(remove_name(folder_ / line.temporary));
    require_success(folder_, marker->remove());
  } catch (...) {
    const bool undone = undo();
    if (undone && is_new) static_cast<void>(marker->remove());
    if (undone && !is_new && left_behind) static_cast<void>(marker->put(*left_behind));
    throw;
  }
  for (const Place& place : places_) {
    if (place.file != nullptr) place.file->discard();  // its name only: the file has moved
    if (place.kept) static_cast<void>(remove_name(place.old));
  }
}

bool is_unfinished(const fs::path& path) {
  for (const fs::path& place : links_of(path)) {
    const std::optional<Marker> marker = Marker::open(place.parent_path(), O_RDONLY, LOCK_SH);
    if (!marker) continue;
    const std::string text = marker->text();
    for (const MarkerLine& line : lines_of(text)) {
      if (line.name == place.filename().native()) return true;
    }
  }
  return false;
}

void require_completed(const fs::path& path) {
  if (!is_unfinished(path)) return;
  throw InvalidInput(path.string(), "belongs to files that were being replaced when the program was ended",
                     "Some are of the last run and some of the one before. Run it again");
}

}  // namespace robomill::io
