#include "robomill/io/folder_change.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/descriptor.hpp"

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
    out.path_ = folder / marker_name;
    while (true) {
      int error = 0;
      // What is no file of ours, a pipe say, is not waited for.
      out.file_ = open_descriptor(out.path_.c_str(), flags | O_NOFOLLOW | O_NONBLOCK, error);
      if (error == ENOENT && (flags & O_CREAT) == 0) return std::nullopt;
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
    return error != 0 ? error : synchronise_folder(path_.parent_path());
  }
  void write(std::string_view text) const { require_success(path_, put(text)); }

  [[nodiscard]] int remove() const noexcept {
    if (const int error = remove_name(path_); error != 0) return error;
    return synchronise_folder(path_.parent_path());
  }

 private:
  fs::path path_;
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
    if (tab != std::string_view::npos) out.push_back({line.substr(0, tab), line.substr(tab + 1)});
  }
  return out;
}

}  // namespace

/// A file of the change.
struct FolderChange::Place {
  PendingFile* file = nullptr;                ///< null: it is removed
  std::unique_ptr<PendingFile> removed = {};  ///< where it waits for that
  bool done = false, exchanged = false;       ///< exchanged: the old file is where the new one was

  [[nodiscard]] const PendingFile& pending() const { return file != nullptr ? *file : *removed; }
  [[nodiscard]] std::string line() const {
    return fmt::format("{}\t{}\n", pending().path().filename().string(), pending().temporary().filename().string());
  }
};

FolderChange::FolderChange(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_);
}

FolderChange::~FolderChange() = default;

void FolderChange::write(const std::string& name, std::string_view content) {
  own_.push_back(std::make_unique<PendingFile>(folder_ / name));
  own_.back()->write(content);
  add(*own_.back());
}

void FolderChange::add(PendingFile& file) {
  file.prepare();
  Place place;
  place.file = &file;
  places_.push_back(std::move(place));
}

void FolderChange::remove(const std::string& name) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder_ / name, ignored)) return;
  Place place;
  place.removed = std::make_unique<PendingFile>(folder_ / name);
  place.removed->prepare();
  places_.push_back(std::move(place));
}

/// A file that is removed waits where its temporary file was, so that it can come back.
void FolderChange::take_place(Place& place) {
  const fs::path &from = place.pending().temporary(), &to = place.pending().path();
  int error = place.file != nullptr ? exchange_files(from, to) : rename_file(to, from);
  place.exchanged = place.file != nullptr && error == 0;
  const bool cannot_exchange = error == ENOENT || error == EINVAL || error == ENOSYS;
  if (place.file != nullptr && cannot_exchange) error = rename_file(from, to);
  require_success(to, error);
  place.done = true;
}

/// What cannot be undone stays named in the marker.
void FolderChange::undo() noexcept {
  for (auto place = places_.rbegin(); place != places_.rend(); ++place) {
    if (!place->done) continue;
    const fs::path &temporary = place->pending().temporary(), &path = place->pending().path();
    const int error = place->file == nullptr ? rename_file(temporary, path)
                      : place->exchanged     ? exchange_files(temporary, path)
                                             : rename_file(path, temporary);
    place->done = error != 0;
  }
}

void FolderChange::commit() {
  const std::optional<Marker> marker = Marker::open(folder_, O_RDWR | O_CREAT, LOCK_EX);
  const std::string left_behind = marker->text();
  try {
    std::string text = left_behind;  // whose temporary files are still to be taken away
    for (const Place& place : places_) text += place.line();
    marker->write(text);
    for (Place& place : places_) take_place(place);
    require_success(folder_, synchronise_folder(folder_));
  } catch (...) {
    undo();
    const bool undone = std::ranges::none_of(places_, &Place::done);
    if (undone) static_cast<void>(left_behind.empty() ? marker->remove() : marker->put(left_behind));
    throw;
  }
  for (Place& place : places_) {
    if (place.file != nullptr) place.file->discard();
    place.removed.reset();
  }
  for (const MarkerLine& line : lines_of(left_behind)) static_cast<void>(remove_name(folder_ / line.temporary));
  require_success(folder_, marker->remove());
}

void require_completed(const fs::path& path) {
  const std::optional<Marker> marker = Marker::open(path.parent_path(), O_RDONLY, LOCK_SH);
  if (!marker) return;
  const std::string text = marker->text();
  for (const MarkerLine& line : lines_of(text)) {
    if (line.name != path.filename().native()) continue;
    throw InvalidInput(path.string(), "belongs to files that were being replaced when the program was ended",
                       "Some are of the last run and some of the one before. Run it again");
  }
}

}  // namespace robomill::io
