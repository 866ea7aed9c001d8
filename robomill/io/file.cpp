#include "robomill/io/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <regex>
#include <system_error>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/system/folder_change.hpp"
#include "robomill/io/system/output_places.hpp"
#include "robomill/io/system/pending_names.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void reject(const fs::path& path, std::string rule, std::string hint = {}) {
  throw InvalidInput(path.string(), std::move(rule), std::move(hint));
}

constexpr unsigned owner_writes = 0600;
constexpr int most_links = 40;  // as the kernel follows

/// A name of a file by a descriptor that is open, /dev/stdout for one: renaming over it would take what it is open for.
bool names_open_file(const fs::path& path) {
  std::vector<fs::path> links = links_of(path);
  links.pop_back();
  return std::ranges::any_of(links, [](const fs::path& link) { return link.native().starts_with("/proc/"); });
}

/// A device or a pipe keeps who opens it waiting. On a command line that is wanted; a server names none.
void require_regular_if_confined(const fs::path& path) {
  if (is_confined() && is_special(path)) reject(path, "is a device or a pipe, not a file");
}

}  // namespace

std::vector<fs::path> links_of(const fs::path& path) {
  std::vector<fs::path> out = {path};
  std::error_code error;
  for (int links = 0; links < most_links && fs::is_symlink(out.back(), error); ++links) {
    const fs::path target = fs::read_symlink(out.back(), error);
    if (error) break;
    out.push_back(out.back().parent_path() / target);
  }
  return out;
}

fs::path behind_link(const fs::path& path) {
  return links_of(path).back();
}

bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

fs::path temporary_name(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  fs::path name;
  std::error_code ignored;
  do {  // a killed process of the same number may have left one
    name = path.parent_path() / fmt::format(".{}.{}-{}{}", path.stem().string(), ::getpid(), counter.fetch_add(1),
                                            path.extension().string());
  } while (fs::exists(fs::symlink_status(name, ignored)));
  return name;
}

bool is_temporary_name(const fs::path& path) {
  // .STEM.PROCESS-NUMBER, and perhaps an extension
  static const std::regex form(R"(\..+\.\d+-\d+(\.[^.]*)?)");
  return std::regex_match(path.filename().string(), form);
}

Format format_of(const fs::path& path) {
  static constexpr std::array<std::pair<std::string_view, Format>, 13> endings = {{{".uff", Format::uff},
                                                                                   {".unv", Format::uff},
                                                                                   {".uf", Format::uff},
                                                                                   {".csv", Format::csv},
                                                                                   {".txt", Format::text},
                                                                                   {".dat", Format::text},
                                                                                   {".asc", Format::text},
                                                                                   {".mat", Format::mat},
                                                                                   {".json", Format::json},
                                                                                   {".toml", Format::toml},
                                                                                   {".wav", Format::wav},
                                                                                   {".lvm", Format::lvm},
                                                                                   {".tdms", Format::tdms}}};
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
  require_no_output(path);
  require_completed(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) reject(path, "there is no such file");
  if (fs::is_directory(status)) reject(path, "is a folder, not a file");
  require_regular_if_confined(path);
  std::ifstream in(path, std::ios::binary);
  if (!in) reject(path, "cannot be read", "Are its permissions right?");
  return in;
}

void require_file(const fs::path& path) {
  static_cast<void>(open_file(path));
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
  if (!is_special(path)) {
    PendingFile pending(path);
    pending.write(content);
    pending.commit();
    return;
  }
  int error = 0;
  Descriptor device = open_descriptor(path.c_str(), O_WRONLY | O_TRUNC, error);
  require_success(path, error);
  require_success(path, write_all(device.get(), content));
  require_success(path, device.close());
}

void make_folder(const fs::path& folder) {
  require_inside(folder);
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path each = folder; !each.empty() && !fs::exists(each, error); each = each.parent_path()) {
    missing.push_back(each);
    if (each == each.parent_path()) break;
  }
  fs::create_directories(folder, error);
  if (error) reject(folder, "cannot be made: " + error.message(), "Give a folder that you may write to");
  for (const fs::path& each : missing) require_success(each, synchronise_folder(each.parent_path()));
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
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) reject(path_, "is a folder, not a file");
  if (is_special(path_)) reject(path_, "is a device or a pipe, and this file is written to a place of its own");
  if (names_open_file(path_)) {
    reject(path_, "is a file that is open already", "Give the file's own name, or - for standard output");
  }
  path_ = behind_link(path_);
  require_inside(path_);
  const fs::path folder = path_.parent_path();
  if (path_.filename().empty() || (!folder.empty() && !fs::is_directory(folder, ignored))) {
    reject(path_, "cannot be written", "There is no folder " + (folder.empty() ? "." : folder.string()));
  }
  // Nobody may read it who could not read the old one.
  const fs::file_status old = fs::status(path_, ignored);
  const auto mode = static_cast<unsigned>(fs::is_regular_file(old) ? old.permissions() : fs::perms{0666});
  int error = EEXIST;
  while (error == EEXIST) {
    temporary_ = temporary_name(path_);
    register_pending(temporary_);
    file_ = open_descriptor(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL, error, mode | owner_writes);
    if (error != 0) forget_pending(temporary_);
  }
  require_success(path_, error);
}

PendingFile::~PendingFile() {
  discard();
}

void PendingFile::discard() noexcept {
  if (temporary_.empty()) return;
  static_cast<void>(remove_name(temporary_));
  forget_pending(temporary_);
  temporary_.clear();
}

bool PendingFile::keep(int error) noexcept {
  if (error_ == 0) error_ = error;
  return error_ == 0;
}

void PendingFile::require_written() const {
  require_success(path_, error_);
}

void PendingFile::write(std::string_view bytes) {
  write_at(size_, bytes);
  require_written();
}

bool PendingFile::write_at(std::uint64_t offset, std::string_view bytes) noexcept {
  if (error_ != 0 || !keep(write_all_at(file_.get(), bytes, offset))) return false;
  size_ = std::max<std::uint64_t>(size_, offset + bytes.size());
  return true;
}

std::size_t PendingFile::read_at(std::uint64_t offset, std::span<char> bytes) noexcept {
  std::size_t count = 0;
  keep(read_all_at(file_.get(), bytes, offset, count));
  return count;
}

bool PendingFile::resize(std::uint64_t size) noexcept {
  if (error_ != 0 || !keep(resize_file(file_.get(), size))) return false;
  size_ = size;
  return true;
}

void PendingFile::prepare() {
  if (!file_.is_open()) return require_written();
  std::error_code ignored;
  const fs::file_status old = fs::status(path_, ignored);
  // A file system without permissions keeps none.
  if (fs::is_regular_file(old)) fs::permissions(temporary_, old.permissions(), ignored);
  keep(synchronise(file_.get()));
  keep(file_.close());
  require_written();
}

void PendingFile::commit() {
  prepare();
  require_success(path_, rename_file(temporary_, path_));
  forget_pending(temporary_);
  temporary_.clear();
  require_success(path_, synchronise_folder(path_.parent_path()));
}

LineFile::LineFile(fs::path path) : path_(std::move(path)) {
  require_inside(path_);
  require_regular_if_confined(path_);
  if (!is_special(path_)) {
    pending_.emplace(path_);
    return;
  }
  file_.open(path_, std::ios::binary | std::ios::trunc);
  if (!file_) reject(path_, "cannot be written");
}

bool LineFile::write(std::string_view line) {
  if (pending_) return pending_->write_at(pending_->size(), line);
  file_.write(line.data(), static_cast<std::streamsize>(line.size()));
  return file_.good();
}

void LineFile::close() {
  if (pending_) {
    pending_->commit();
    return;
  }
  file_.close();
  if (!file_) reject(path_, "could not be written to its end", "Is the disk full?");
}

}  // namespace robomill::io
