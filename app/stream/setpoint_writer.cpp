#include "setpoint_writer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstddef>

#include "robomill/base/error.hpp"

namespace robomill::app {
namespace {

constexpr int poll_ms = 50;
/// A pipe that takes something takes so much without waiting.
constexpr std::size_t at_once = PIPE_BUF;
/// Lines that are written together where the writer is behind: below that limit.
constexpr std::size_t lines_together = 10;

}  // namespace

SetpointWriter::SetpointWriter(const std::string& place, int joints)
    : place_(place.empty() || place == "-" ? "standard output" : place),
      format_(path::setpoint_format_of(place)),
      joints_(joints) {
  if (place.empty() || place == "-") {
    to_ = STDOUT_FILENO;
  } else if (io::is_special(place)) {
    int error = 0;
    special_ = io::open_descriptor(place.c_str(), O_WRONLY | O_CLOEXEC, error);
    io::require_success(place, error);
    to_ = special_.get();
  } else {
    file_.emplace(place);
  }
}

std::string SetpointWriter::write(std::string_view text) {
  if (file_) {
    file_->write(text);
    return {};
  }
  while (!text.empty()) {
    pollfd waited = {.fd = to_, .events = POLLOUT, .revents = 0};
    const int ready = ::poll(&waited, 1, poll_ms);
    if (given_up_) return "its reader takes nothing any more";
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = ::write(to_, text.data(), std::min(text.size(), at_once));
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) return errno == EPIPE ? "its reader has closed it" : io::error_text(errno);
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

void SetpointWriter::run(path::SetpointStream& stream, double period_s) {
  path::MonotonicClock clock;
  const auto period_ns = static_cast<std::int64_t>(1e9 * period_s);
  std::string text = path::setpoint_header(format_, joints_);
  while (stream.wait()) {
    const std::size_t begin = stream.begin(), end = std::min(stream.end(), begin + lines_together);
    if (failure_.empty()) {
      for (std::size_t i = begin; i < end; ++i) path::append_setpoint(text, stream[i], format_, joints_);
      std::string why;
      try {
        why = write(text);
      } catch (const InvalidInput& error) {
        why = error.what();
      }
      text.clear();
      if (why.empty()) {
        const std::int64_t now_ns = clock.now_ns();
        written_.lines += end - begin;
        for (std::size_t i = begin; i < end; ++i) {
          const std::int64_t delay_ns = now_ns - stream[i].due_ns;
          written_.delay.add(delay_ns);
          if (delay_ns > period_ns) ++written_.late;
        }
      } else {
        failure_ = place_ + " cannot be written: " + why;
        stream.stop();
      }
    }
    stream.drop_before(end);
  }
}

void SetpointWriter::close() {
  if (file_) file_->commit();
}

}  // namespace robomill::app
