#pragma once
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "robomill/io/file.hpp"
#include "robomill/io/system/descriptor.hpp"
#include "robomill/path/files/setpoint_lines.hpp"
#include "robomill/path/files/stream_json.hpp"
#include "robomill/path/setpoint_stream.hpp"

namespace robomill::app {

/// Writes the set-points of a stream as lines as soon as they are handed over: to standard output, a pipe or a device;
/// a regular file appears whole by close().
class SetpointWriter {
 public:
  /// @param place   empty or "-": standard output
  /// @param joints  1 to 6
  /// @throws InvalidInput if the place cannot be written
  SetpointWriter(const std::string& place, int joints);
  SetpointWriter(const SetpointWriter&) = delete;
  SetpointWriter& operator=(const SetpointWriter&) = delete;

  /// A thread's work, until the stream ends. Where nothing more can be written it stops the stream and takes the rest
  /// of the set-points without writing them: `failure` says why.
  void run(path::SetpointStream& stream, double period_s);
  /// From any thread: a reader that takes nothing is no longer waited for.
  void give_up() noexcept { given_up_ = true; }
  /// A regular file takes its place. After run(). @throws InvalidInput if that fails
  void close();

  [[nodiscard]] const path::WrittenLines& written() const { return written_; }
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  /// Empty, or why not.
  [[nodiscard]] std::string write(std::string_view text);

  std::string place_;
  path::SetpointFormat format_;
  int joints_;
  std::optional<io::PendingFile> file_ = {};
  io::Descriptor special_ = {};
  int to_ = -1;
  path::WrittenLines written_ = {};
  std::string failure_ = {};
  std::atomic<bool> given_up_{false};
};

}  // namespace robomill::app
