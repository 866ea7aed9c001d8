#include "robomill/io/file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/confinement.hpp"
#include "robomill/io/pending_names.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void reject(const fs::path& path, std::string rule, std::string hint = {}) {
  throw InvalidInput(path.string(), std::move(rule), std::move(hint));
}

void write_all(const fs::path& place, const fs::path& named, std::string_view content) {
  errno = 0;
  std::ofstream out(place, std::ios::binary | std::ios::trunc);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) reject(named, "cannot be written", errno != 0 ? std::strerror(errno) : "");
}

/// A link stays a link: what it points to is replaced, or taken away.
fs::path behind_link(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_symlink(path, ignored)) return path;
  const fs::path target = fs::weakly_canonical(path, ignored);
  return ignored || target.empty() ? path : target;
}

/// A device or a pipe cannot be renamed over; nothing of it remains half-written either.
bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// A device or a pipe keeps who opens it waiting. On a command line that is wanted; a server names none.
void require_regular_if_confined(const fs::path& path) {
  if (is_confined() && is_special(path)) reject(path, "is a device or a pipe, not a file");
}

}  // namespace

Format format_of(const fs::path& path) {
  static constexpr std::array<std::pair<std::string_view, Format>, 11> endings = {{{".uff", Format::uff},
                                                                                   {".unv", Format::uff},
                                                                                   {".uf", Format::uff},
                                                                                   {".csv", Format::csv},
                                                                                   {".txt", Format::text},
                                                                                   {".dat", Format::text},
                                                                                   {".asc", Format::text},
                                                                                   {".mat", Format::mat},
                                                                                   {".json", Format::json},
                                                                                   {".toml", Format::toml},
                                                                                   {".wav", Format::wav}}};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  for (const auto& [known, format] : endings) {
    if (ending == known) return format;
  }
  return Format::unknown;
}

std::ifstream open_file(const fs::path& path) {
  require_inside(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) reject(path, "there is no such file");
  if (fs::is_directory(status)) reject(path, "is a folder, not a file");
  require_regular_if_confined(path);
  std::ifstream in(path, std::ios::binary);
  if (!in) reject(path, "cannot be read", "Are its permissions right?");
  return in;
}

std::string read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::ifstream in = open_file(path);
  std::error_code error;
  std::string content;
  if (fs::is_regular_file(path, error)) {
    const std::uintmax_t size = fs::file_size(path, error);
    if (!error && size > max_bytes) reject(path, "holds more than " + std::to_string(max_bytes) + " bytes");
    if (!error) content.reserve(static_cast<std::size_t>(size));
  }
  std::array<char, 1 << 16> block = {};
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    content.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (content.size() > max_bytes) reject(path, "holds more than " + std::to_string(max_bytes) + " bytes");
  }
  if (in.bad()) reject(path, "cannot be read to its end");
  if (content.empty()) reject(path, "is empty");
  return content;
}

void write_file(const fs::path& path, std::string_view content) {
  require_inside(path);
  require_regular_if_confined(path);
  if (is_special(path)) {
    write_all(path, path, content);
    return;
  }
  PendingFile pending(path);
  write_all(pending.temporary(), path, content);
  pending.commit();
}

void make_folder(const fs::path& folder) {
  require_inside(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) reject(folder, "cannot be made: " + error.message(), "Give a folder that you may write to");
}

bool remove_file(const fs::path& path) {
  require_inside(path);
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const bool removed = fs::remove(behind_link(path), error);
  if (error) reject(path, "cannot be removed: " + error.message());
  return removed;
}

PendingFile::PendingFile(fs::path path) : path_(std::move(path)) {
  require_inside(path_);
  static std::atomic<unsigned> counter{0};
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) reject(path_, "is a folder, not a file");
  path_ = behind_link(path_);
  const fs::path folder = path_.parent_path();
  if (path_.filename().empty() || (!folder.empty() && !fs::is_directory(folder, ignored))) {
    reject(path_, "cannot be written", "There is no folder " + (folder.empty() ? "." : folder.string()));
  }
  temporary_ = folder / fmt::format(".{}.{}-{}{}", path_.stem().string(), ::getpid(), counter.fetch_add(1),
                                    path_.extension().string());
  register_pending(temporary_);
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (temporary_.empty()) return;
  fs::remove(temporary_, ignored);
  forget_pending(temporary_);
}

void PendingFile::commit() {
  std::error_code error;
  const fs::file_status old = fs::status(path_, error);
  if (fs::is_regular_file(old)) fs::permissions(temporary_, old.permissions(), error);
  fs::rename(temporary_, path_, error);
  if (error) reject(path_, "cannot be written", error.message());
  forget_pending(temporary_);
  temporary_.clear();
}

LineFile::LineFile(fs::path path, bool live) : path_(std::move(path)), live_(live) {
  require_inside(path_);
  require_regular_if_confined(path_);
  if (!is_special(path_)) pending_.emplace(path_);
  if (live) pending_.reset();  // it has checked the place
  file_.open(pending_ ? pending_->temporary() : path_, std::ios::binary | std::ios::trunc);
  if (!file_) reject(path_, "cannot be written");
}

bool LineFile::write(std::string_view line) {
  file_.write(line.data(), static_cast<std::streamsize>(line.size()));
  if (live_) file_.flush();
  return file_.good();
}

void LineFile::close() {
  file_.close();
  if (!file_) reject(path_, "could not be written to its end", "Is the disk full?");
  if (pending_) pending_->commit();
}

}  // namespace robomill::io
