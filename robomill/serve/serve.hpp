#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/serve/README.md, "Method"

namespace robomill::live {
class HopQueue;
class Notices;
struct MetricValues;
}  // namespace robomill::live
namespace robomill::monitor {
struct MonitorFile;
}

namespace robomill::serve {

/// Where a stream's samples go, and what is said about it.
struct StreamSink {
  live::HopQueue& queue;
  live::Notices& notices;
  live::MetricValues& metrics;
};

/// Opens a stream of samples, for a session of the monitor or a tap test: those of file.mqtt go into the queue, until
/// what is returned is gone.
/// @param file  of it count mqtt, the channels, the sample rate, the hop and the timeout
/// @param stop  becomes true when nobody waits for it any more
/// @throws InvalidInput if there is no connection
using OpenStream = std::function<std::shared_ptr<void>(const monitor::MonitorFile& file, const StreamSink& sink,
                                                       const std::atomic<bool>& stop)>;

struct ROBOMILL_API ServeOptions {
  std::filesystem::path folder = ".";  ///< nothing outside it is read or written
  std::string host = "127.0.0.1";      ///< an address; another than loopback needs a token
  int port = 8437;                     ///< 0: any that is free
  /// Of at least 16 letters, digits, - or _: who asks has to know it. Empty: anybody on this machine may ask.
  std::string token = {};
  OpenStream open_stream = {};  ///< the library itself knows no broker; none: recordings alone
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The page and the jobs of one folder over HTTP, until it is destroyed. While it lives, no file outside the folder can
/// be read or written by the whole program (io::Confinement): one at a time in a program.
class ROBOMILL_API Server {
 public:
  /// Listens when it is there. @throws InvalidInput if the options are wrong, the folder is missing, the port is taken,
  /// or
  ///     another one lives
  explicit Server(const ServeOptions& options);
  /// Stops jobs and closes connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8437/", with the token where there is one.
  [[nodiscard]] std::string address() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::serve
