#include "robomill/io/append_log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <span>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/confinement.hpp"

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
  const std::filesystem::file_status there = std::filesystem::status(path_, ignored);
  const bool special = std::filesystem::exists(there) && !std::filesystem::is_regular_file(there);
  if (std::filesystem::is_directory(there)) fail("is a folder, not a file", {});
  if (special && is_confined()) fail("is a device or a pipe, not a file", {});
  // Its last byte is read: a line that was cut off must not be continued.
  int error = 0;
  file_ = open_descriptor(path_.c_str(), (special ? O_WRONLY : O_RDWR | O_CREAT) | O_APPEND, error);
  if (error != 0) {
    const std::filesystem::path folder = path_.parent_path();
    const bool lacks_folder = !folder.empty() && !std::filesystem::is_directory(folder, ignored);
    fail("cannot be written", lacks_folder ? "There is no folder " + folder.string() : reason(error));
  }
  struct stat status = {};
  is_regular_ = ::fstat(file_.get(), &status) == 0 && S_ISREG(status.st_mode);
  if (!is_regular_ || status.st_size == 0) return;
  char last = '\n';
  std::size_t got = 0;
  error = read_all_at(file_.get(), std::span(&last, 1), static_cast<std::uint64_t>(status.st_size - 1), got);
  if (error != 0) fail("cannot be read to its end", reason(error));
  unfinished_ = was_unfinished_ = got == 1 && last != '\n';
}

std::string AppendLog::reason(int error) {
  return std::generic_category().message(error);
}

AppendLog::State AppendLog::write(std::string line) {
  std::unique_lock lock(mutex_);
  waiting_.push_back(std::move(line));
  if (waiting_.size() > options_.most_waiting) {
    waiting_.pop_front();
    ++unreported_;
    ++state_.lost;
  }
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

/// The lock is held, but not while the system writes.
void AppendLog::write_waiting(std::unique_lock<std::mutex>& lock) {
  if (busy_) return;
  busy_ = true;
  int error = 0;
  while (error == 0 && (unreported_ > 0 || !waiting_.empty())) {
    const std::uint64_t lost = std::exchange(unreported_, 0);
    const bool of_lost = lost > 0 && options_.lost_line;
    if (lost > 0 && !of_lost) continue;
    std::string line;
    if (!of_lost) {
      line = std::move(waiting_.front());
      waiting_.pop_front();
    }
    lock.unlock();
    if (of_lost) line = options_.lost_line(lost);
    error = append(line);
    lock.lock();
    if (error == 0) continue;
    if (of_lost) {
      unreported_ += lost;
    } else if (unreported_ > 0) {  // meanwhile there were too many: this was the oldest
      ++unreported_;
      ++state_.lost;
    } else {
      waiting_.push_front(std::move(line));
    }
  }
  if (error != 0 && state_.error == 0) ++state_.failures;
  state_.error = error;
  busy_ = false;
}

/// 0, or errno. A line of which a part alone could be written is taken back.
int AppendLog::append(const std::string& line) {
  const std::string text = unfinished_ ? '\n' + line : line;
  std::size_t written = 0;
  const int error = write_all(file_.get(), text, written);
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
