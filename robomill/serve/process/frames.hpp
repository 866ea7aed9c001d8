#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "robomill/serve/http/server.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// What goes between the server and a process that works for it: what it is, and its bytes.
struct Frame {
  /// To the process: what it may do, first of all; what it is asked; that it should stop.
  static constexpr char begin = 'b', job = 'j', program = 'p', lobes = 'l', check = 'c', inspect = 'i', overview = 'o',
                        monitors = 'm', stop = 's';
  /// From it: how far it is; an event for the pages; its answer.
  static constexpr char progress = 'f', event = 'e', answer = 'a';

  char kind = 0;
  std::string body = {};
};

inline constexpr std::size_t longest_question = std::size_t{4} << 20, longest_answer = std::size_t{256} << 20;

/// False where the other end is gone, or takes nothing for as long as the socket waits.
[[nodiscard]] bool send_frame(int socket, char kind, std::string_view body);

/// An answer's body: "200 {…}".
[[nodiscard]] HttpResponse response_of(std::string_view answer);

/// Frames out of bytes that come in any pieces.
class FrameReader {
 public:
  explicit FrameReader(std::size_t longest) : longest_(longest) {}
  /// The bytes that came next.
  void add(std::string_view bytes) { bytes_ += bytes; }
  /// The next whole frame, if it has come.
  /// @throws std::length_error if it says that it is longer than it may be
  [[nodiscard]] std::optional<Frame> next();

 private:
  std::size_t longest_;
  std::string bytes_;
};

}  // namespace robomill::serve
