#pragma once
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/io/json.hpp"
#include "robomill/live/advisor.hpp"
#include "robomill/live/session.hpp"
#include "robomill/serve/files/monitor_input.hpp"
#include "robomill/serve/monitor/frame.hpp"
#include "robomill/serve/monitor/history.hpp"
#include "robomill/serve/monitor/live_spectrum.hpp"
#include "robomill/serve/serve.hpp"

// Method: robomill/serve/README.md, "Monitor"

namespace robomill::serve {

/// A spindle that is monitored: a session of the monitor on a thread of its own, and what the page shows of it, in
/// memory that does not grow with the stream.
class MonitorSession {
 public:
  struct Options {
    int id = 0;
    std::string config = {};          ///< for the client
    double speed = 1.0;               ///< of a recording, times its own; 0: as fast as it goes
    std::filesystem::path root = {};  ///< does not appear in messages
    OpenStream open_stream = {};      ///< none: there are no streams
  };
  using Publish = std::function<void(std::string_view event, std::string_view data)>;
  /// @param publish  is given "monitor" with a frame, at most ten a second, and "monitors" where the status changed;
  ///     from another thread
  /// @throws InvalidInput if there are no streams and the input is one
  MonitorSession(Options options, MonitorInput input, Publish publish);
  /// Waits until it has ended.
  ~MonitorSession();
  MonitorSession(const MonitorSession&) = delete;
  MonitorSession& operator=(const MonitorSession&) = delete;

  /// Asks it to end, and lets its input go; does not wait. From then on nothing is published.
  void stop();
  /// Whether it has ended: the recording is over, or something failed.
  [[nodiscard]] bool over() const;
  /// What it is, how it stands, and the last frame without its spectrum.
  [[nodiscard]] io::Json summary() const;
  /// Also what was assumed, what its files are warned of, the history of alarms, the edges of the bands, and the frames
  /// of the last ten minutes.
  [[nodiscard]] io::Json all() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Status { starting, running, done, failed };

  void run(const std::stop_token& stop);
  void receive(const std::stop_token& stop);
  [[nodiscard]] live::SessionOutputs outputs(const live::Advisor& advisor);
  void decide(const monitor::Decision& decision, double time_s, double compute_s);
  void take(const monitor::MonitorEvent& event);
  void take_overload(const monitor::MonitorEvent& event);
  void put(const MonitorFrame& frame);
  void show(live::Session* session);
  [[nodiscard]] io::Json counts() const;
  void publish_due(bool last = false);
  void publish_rest();
  void send(std::string_view event, const std::string& data);
  void set_status(Status status, io::Json error = nullptr);
  [[nodiscard]] double clock_s() const;
  [[nodiscard]] double pace(const MonitorFrame& frame);

  const Options options_;
  const Publish publish_;
  MonitorInput input_;
  const bool is_stream_;
  const Clock::time_point begin_ = Clock::now();
  const std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
  std::mutex publishing_;
  std::atomic<bool> stop_{false};  ///< changes under it

  // Of the session's thread alone.
  LiveSpectrum spectrum_;
  std::optional<MonitorFrame> pending_ = {};  ///< since the last one was published
  MonitorFrame advised_ = {};                 ///< holds the advice on the chatter that lasts
  Clock::time_point published_ = {};
  double pace_ = NAN, pace_clock_s_ = 0.0, pace_time_s_ = 0.0;

  mutable std::mutex mutex_;  ///< of the rest
  Status status_ = Status::starting;
  io::Json error_ = nullptr;
  live::Session* session_ = nullptr;  ///< while there is one …
  io::Json counts_;                   ///< … and what its counts were at its end
  double ended_s_ = NAN;
  int teeth_ = 0;
  std::vector<Assumption> assumed_ = {};
  std::vector<std::string> warnings_ = {};  ///< on what its files say
  FrameRing frames_;
  MonitorHistory history_;
  std::jthread thread_;
};

}  // namespace robomill::serve
