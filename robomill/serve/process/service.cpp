#include "robomill/serve/process/service.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <exception>
#include <string_view>
#include <utility>

namespace robomill::serve {

Service::Service(const WorkerOptions& options, Publish publish, std::function<void()> died)
    : program_(options), publish_(std::move(publish)), died_(std::move(died)), listener_([this] { listen(); }) {}

Service::~Service() {
  end();
  listener_.join();
}

void Service::end() {
  const std::lock_guard lock(mutex_);
  ending_ = true;
  end_because("");
}

/// Shutting the socket down wakes the listener, which ends the process. mutex_ is held.
void Service::end_because(const char* reason) {
  if (fate_) return;
  if (reason_.empty()) reason_ = reason;
  ::shutdown(program_.socket(), SHUT_RDWR);
}

void Service::take(const Frame& frame) {
  if (frame.kind == Frame::answer) {
    const std::lock_guard lock(mutex_);
    answer_ = response_of(frame.body);
    changed_.notify_all();
  } else if (frame.kind == Frame::event) {  // its name, a line's end, its data
    const std::string_view body = frame.body;
    const std::size_t line_end = std::min(body.find('\n'), body.size());
    const std::string_view data = body.substr(std::min(line_end + 1, body.size()));
    const bool whole = line_end < body.size() && data.find_first_of("\r\n") == std::string_view::npos;
    if (whole) publish_(body.substr(0, line_end), data);
  }
}

/// Until the process ends.
void Service::listen() {
  std::array<char, 1 << 16> block = {};
  FrameReader frames(longest_answer);
  try {
    for (;;) {
      const ssize_t count = ::recv(program_.socket(), block.data(), block.size(), 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      frames.add({block.data(), static_cast<std::size_t>(count)});
      while (const std::optional<Frame> frame = frames.next()) take(*frame);
    }
  } catch (const std::exception&) {
    const std::lock_guard lock(mutex_);
    end_because("its process said what cannot be understood, or kept");
  }
  bool tells = false;
  {
    const std::lock_guard lock(mutex_);
    const std::string end = program_.end(false);
    fate_ = reason_.empty() ? end : reason_;
    tells = !ending_;
    changed_.notify_all();
  }
  if (tells) died_();
}

HttpResponse Service::ask(char kind, std::string_view body) {
  constexpr std::chrono::minutes most(1);
  std::unique_lock lock(mutex_);
  if (fate_) throw WorkerEnded(*fate_);
  answer_.reset();
  if (send_frame(program_.socket(), kind, body)) {
    const bool told = changed_.wait_for(lock, most, [this] { return answer_ || fate_; });
    if (answer_) return *std::exchange(answer_, std::nullopt);
    if (told) throw WorkerEnded(*fate_);
    end_because("its process did not answer for a minute and was ended");
  } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
    end_because("its process took no question for 10 s and was ended");
  } else {
    end_because("");
  }
  changed_.wait(lock, [this] { return fate_.has_value(); });
  throw WorkerEnded(*fate_);
}

std::optional<std::string> Service::fate() const {
  const std::lock_guard lock(mutex_);
  return fate_;
}

}  // namespace robomill::serve
