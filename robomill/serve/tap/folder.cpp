#include "robomill/serve/tap/folder.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

bool is_tap_record(const fs::path& path) {
  if (io::is_read_as_record(path)) return !path.filename().string().starts_with('.');
  return !io::unread_record(path).what.empty();  // named with what to do
}

std::string key_of(const fs::path& path) {
  return path.lexically_normal().string();
}

/// The records of a folder up to an error: one of another machine may fail in between.
std::vector<fs::path> records_in(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> out;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_tap_record(entry->path())) out.push_back(entry->path());
  }
  return out;
}

}  // namespace

TapFolder::TapFolder(fs::path watch, std::vector<fs::path> named) : watch_(std::move(watch)), named_(std::move(named)) {
  std::error_code error;
  if (!fs::is_directory(watch_, error)) {
    throw InvalidInput("watch", "there is no folder " + printable(watch_.filename().string()));
  }
  const std::vector<fs::path> there = records_in(watch_, error);
  if (error) throw InvalidInput("watch", "the folder cannot be read: " + error.message());
  for (const fs::path& record : there) {
    seen_[key_of(record)].done = true;
  }
  for (const fs::path& name : named_) {
    if (fs::exists(name, error)) seen_[key_of(name)].done = true;
  }
}

std::vector<fs::path> TapFolder::look(std::size_t most, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  std::vector<fs::path> found = named_;
  std::error_code unreadable;  // what is missing now comes the next time
  std::ranges::move(records_in(watch_, unreadable), std::back_inserter(found));
  std::ranges::sort(found);
  std::vector<fs::path> out;
  for (const fs::path& record : found) {
    if (out.size() >= most) break;
    std::error_code missing;
    const std::uintmax_t bytes = fs::file_size(record, missing);
    if (missing || bytes == 0) continue;
    const fs::file_time_type written = fs::last_write_time(record, missing);
    if (missing) continue;
    Seen& known = seen_.try_emplace(key_of(record)).first->second;
    if (known.done) continue;
    if (known.bytes != bytes || known.written != written) {
      known = {.bytes = bytes, .written = written, .changed = now};
    } else if (now - known.changed >= settled) {
      known.done = true;
      out.push_back(record);
    }
  }
  return out;
}

void TapFolder::ignore(const fs::path& file) {
  const std::lock_guard lock(mutex_);
  seen_[key_of(file)].done = true;
}

}  // namespace robomill::serve
