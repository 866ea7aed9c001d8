#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace robomill::app {

/// What a stream of set-points can be told while it runs.
struct StreamCommand {
  enum class Kind { hold, resume, feed_override, stop, status };
  Kind kind = Kind::status;
  double share = 1.0;  ///< of feed_override
};

/// A line as a command: hold, resume, stop, status, override SHARE (0 to 1.5). Blanks around words do not count.
struct ParsedCommand {
  std::optional<StreamCommand> command = {};  ///< none, and no error: an empty line
  std::string error = {};                     ///< one line, printable
};
[[nodiscard]] ParsedCommand parse_command(std::string_view line);

/// Bytes of one sender as lines, whose memory is bounded.
class CommandLines {
 public:
  static constexpr std::size_t longest = 200;  ///< bytes of a line
  /// @param take  a line without its end, or nothing where it is longer: once each
  void add(std::string_view bytes, const std::function<void(std::optional<std::string_view>)>& take);
  /// The sender has ended, perhaps without ending its line.
  void end(const std::function<void(std::optional<std::string_view>)>& take);

 private:
  std::string line_ = {};
  bool skipping_ = false;  ///< the rest of a line that was too long
};

}  // namespace robomill::app
