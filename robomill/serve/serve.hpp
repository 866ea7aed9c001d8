#pragma once
#include <atomic>
#include <cstdint>
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
  std::string host = "127.0.0.1";      ///< an address, or localhost; another than loopback needs a token
  int port = 8437;                     ///< 0: any that is free
  /// Of at least 16 letters, digits, - or _: who asks has to know it. Empty: anybody on this machine may ask.
  std::string token = {};
  OpenStream open_stream = {};  ///< the library itself knows no broker; none: recordings alone
  /// A program that calls work_for_server(), and its arguments: jobs, live lobes, files that are looked at and spindles
  /// that are monitored run in processes of it, so that the server survives them. Empty: in this process.
  std::vector<std::string> worker = {};
  std::uint64_t memory_bytes = 0;  ///< that each such process may have; 0: half of the machine's
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

/// What ServeOptions::worker does: answers the server that started it, until the server ends. It opens nothing outside
/// the folder that is served but libraries, and no connection, where the kernel can see to that; one that monitors
/// spindles also the system's settings, and connections.
/// @param open_stream  ServeOptions', for spindles that are monitored
/// @return the program's exit code; 2 where no server started it
[[nodiscard]] ROBOMILL_API int work_for_server(OpenStream open_stream = {});

/// For a program that does nothing but serve, before it has a second thread: from here on it opens no file outside the
/// folder but those that belong to the system and to itself, whatever it is made to do, nor does what it starts.
/// False where the kernel has no Landlock: then the Server's own checks remain.
/// @throws InvalidInput if there is no such folder
ROBOMILL_API bool restrict_to_folder(const std::filesystem::path& folder);

}  // namespace robomill::serve
