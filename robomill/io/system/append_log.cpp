#include "robomill/io/system/append_log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <span>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {

AppendLog::AppendLog(std::filesystem::path path, Options options)
    : path_(std::move(path)), options_(std::move(options)) {
  require_inside(path_);
  open();
}

void AppendLog::open() {
  const auto fail = [this](const char* rule, const std::string& hint) {
    throw InvalidInput(path_.string(), rule, hint);
  };
  std::error_code ignored;
  const bool special = is_special(path_);
  if (std::filesystem::is_directory(path_, ignored)) fail("is a folder, not a file", {});
  if (special && is_confined()) fail("is a device or a pipe, not a file", {});
  const char* rule = "cannot be written";
  const int error = open_file(special ? O_WRONLY : O_RDWR | O_CREAT, rule);
  if (error != 0) {
    const std::filesystem::path folder = path_.parent_path();
    const bool lacks_folder = !folder.empty() && !std::filesystem::is_directory(folder, ignored);
    fail(rule, lacks_folder ? "There is no folder " + folder.string() : error_text(error));
  }
  was_unfinished_ = unfinished_;
}

/// 0, or errno; then nothing has changed. Its last byte is read: a line that was cut off must not be continued.
/// @param rule  becomes what went wrong, where it was not opening
int AppendLog::open_file(int flags, const char*& rule) {
  int error = 0;
  Descriptor file = open_descriptor(path_.c_str(), flags | O_APPEND, error);
  if (error != 0) return error;
  struct stat status = {};
  const bool is_regular = ::fstat(file.get(), &status) == 0 && S_ISREG(status.st_mode);
  char last = '\n';
  std::size_t got = 0;
  if (is_regular && status.st_size > 0) {
    rule = "cannot be read to its end";
    error = read_all_at(file.get(), std::span(&last, 1), static_cast<std::uint64_t>(status.st_size - 1), got);
    if (error != 0) return error;
  }
  file_ = std::move(file);
  is_regular_ = is_regular;
  place_ = {.device = status.st_dev, .inode = status.st_ino};
  unfinished_ = got == 1 && last != '\n';
  return 0;
}

/// 0, or errno. Who removes or rotates a file leaves this one without its name: what is written to it nobody finds.
int AppendLog::follow() {
  if (!is_regular_) return 0;
  struct stat there = {};
  const bool is_there = ::stat(path_.c_str(), &there) == 0;
  if (is_there ? place_ == Place{.device = there.st_dev, .inode = there.st_ino} : errno != ENOENT) return 0;
  if (is_there && !S_ISREG(there.st_mode)) return EEXIST;
  const char* rule = nullptr;
  const int error = open_file(O_RDWR | O_CREAT, rule);
  if (error == 0) ++moved_;
  return error;
}

AppendLog::State AppendLog::write(std::string line, bool minor) {
  line.insert(line.begin(), '\n');
  std::list<Line> one;
  one.push_back({.text = std::move(line), .minor = minor});
  std::unique_lock lock(mutex_);
  waiting_.splice(waiting_.end(), one);
  drop_surplus();
  write_waiting(lock);
  state_.waiting = waiting_.size();
  return state_;
}

AppendLog::State AppendLog::retry() {
  std::unique_lock lock(mutex_);
  write_waiting(lock);
  state_.waiting = waiting_.size();
  return state_;
}

AppendLog::State AppendLog::state() const {
  const std::scoped_lock lock(mutex_);
  return state_;
}

AppendLog::State AppendLog::close() {
  std::unique_lock lock(mutex_);
  write_waiting(lock);
  int error = synchronise(file_.get());
  if (is_regular_ && error == 0) error = synchronise_folder(path_.parent_path());
  const int closed = file_.close();
  if (state_.error == 0) state_.error = error != 0 ? error : closed;
  state_.waiting = waiting_.size();
  return state_;
}

void AppendLog::drop_surplus() {
  while (waiting_.size() > options_.most_waiting) {
    const auto minor = std::ranges::find_if(waiting_, &Line::minor);
    waiting_.erase(minor != waiting_.end() ? minor : waiting_.begin());
    ++unreported_;
    ++state_.lost;
  }
}

/// The lock is held, but not while the system writes. What throws leaves everything as it was.
void AppendLog::write_waiting(std::unique_lock<std::mutex>& lock) {
  if (busy_) return;
  int error = 0;
  while (error == 0 && (unreported_ > 0 || !waiting_.empty())) {
    std::string of_lost;
    if (unreported_ > 0 && options_.lost_line) of_lost = '\n' + options_.lost_line(unreported_);
    const std::uint64_t lost = std::exchange(unreported_, 0);
    if (lost > 0 && of_lost.empty()) continue;
    std::list<Line> oldest;
    if (lost == 0) oldest.splice(oldest.end(), waiting_, waiting_.begin());
    busy_ = true;
    lock.unlock();
    error = append(lost > 0 ? of_lost : oldest.front().text);
    lock.lock();
    busy_ = false;
    state_.moved = moved_;
    if (error == 0) continue;
    unreported_ += lost;
    waiting_.splice(waiting_.begin(), oldest);
    drop_surplus();  // there may be too many meanwhile
  }
  if (error != 0 && state_.error == 0) ++state_.failures;
  state_.error = error;
}

/// 0, or errno. A line of which a part alone could be written is taken back.
/// @param text  '\n' and the line; the first is left off where the line before was finished
int AppendLog::append(std::string_view text) {
  int error = follow();
  if (error != 0) return error;
  if (!unfinished_) text.remove_prefix(1);
  std::size_t written = 0;
  error = write_all(file_.get(), text, written);
  if (error == 0) {
    unfinished_ = false;
  } else if (written > 0) {
    take_back(written);
  }
  return error;
}

/// Of what others have written behind it nothing is taken: then the line is ended by the next one.
void AppendLog::take_back(std::size_t bytes) {
  const bool was = unfinished_;
  unfinished_ = true;
  if (!is_regular_) return;
  struct stat status = {};
  const off_t end = ::lseek(file_.get(), 0, SEEK_CUR);
  const bool is_last = end >= 0 && ::fstat(file_.get(), &status) == 0 && status.st_size == end;
  if (is_last && resize_file(file_.get(), static_cast<std::uint64_t>(end) - bytes) == 0) unfinished_ = was;
}

}  // namespace robomill::io
