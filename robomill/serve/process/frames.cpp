#include "robomill/serve/process/frames.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace robomill::serve {
namespace {

/// Both ends are of one machine: the length is as it has numbers.
constexpr std::size_t head_bytes = 1 + sizeof(std::uint32_t);

bool send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace

bool send_frame(int socket, char kind, std::string_view body) {
  const auto length = static_cast<std::uint32_t>(body.size());
  std::array<char, head_bytes> head = {kind};
  std::memcpy(head.data() + 1, &length, sizeof(length));
  return send_all(socket, {head.data(), head.size()}) && send_all(socket, body);
}

HttpResponse response_of(std::string_view answer) {
  HttpResponse out = {.status = 500};
  const std::size_t blank = std::min(answer.find(' '), answer.size());
  std::from_chars(answer.data(), answer.data() + blank, out.status);
  out.body = answer.substr(std::min(blank + 1, answer.size()));
  return out;
}

std::optional<Frame> FrameReader::next() {
  if (bytes_.size() < head_bytes) return std::nullopt;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes_.data() + 1, sizeof(length));
  if (length > longest_) throw std::length_error("a message is longer than it may be");
  if (bytes_.size() < head_bytes + length) return std::nullopt;
  Frame frame = {.kind = bytes_.front(), .body = bytes_.substr(head_bytes, length)};
  bytes_.erase(0, head_bytes + length);
  return frame;
}

}  // namespace robomill::serve
