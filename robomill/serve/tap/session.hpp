#pragma once
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/serve/files/tap_files.hpp"
#include "robomill/serve/serve.hpp"
#include "robomill/serve/tap/folder.hpp"
#include "robomill/serve/tap/hits.hpp"
#include "robomill/serve/tap/settings.hpp"
#include "robomill/serve/tap/stream.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// A tap test while it is made: records that appear in a folder, or that are cut out of a stream, become hits, accepted
/// or rejected, and the FRFs of those that were accepted build up.
class TapSession {
 public:
  struct Options {
    std::filesystem::path hits = {};    ///< hits.toml
    std::string text = {};              ///< what it holds
    std::string name = {};              ///< of it, for the client
    std::filesystem::path watch = {};   ///< the folder in which records appear; not of a stream
    std::string stream = {};            ///< "mqtt://HOST[:PORT]/TOPIC"; empty: none
    std::string direction = {};         ///< of a stream's hits; empty: the first row's
    double level_n = 0.0;               ///< of a stream's trigger; 0: by itself
    double record_s = 0.0;              ///< of a stream's hits; 0: as hits.toml says
    int wanted = 0;                     ///< good hits; 0: five a direction
    int id = 0;                         ///< tells tests apart
    monitor::MqttSettings broker = {};  ///< of the stream: user, TLS and time-out
    std::filesystem::path config = {};  ///< the monitor.toml that they are of; empty: none
    std::filesystem::path root = {};    ///< does not appear in messages
    OpenStream open_stream = {};
  };
  using Publish = std::function<void(std::string_view event, std::string_view data)>;
  /// @param publish  is given "tap" with the state on every change, and "tap-stream" with that of the stream; from
  /// other
  ///     threads
  /// @throws InvalidInput as TapSettings, TapFolder and TapStream
  TapSession(const Options& options, Publish publish);
  /// Waits until it has ended.
  ~TapSession();
  /// Asks it to end; does not wait. From then on nothing is published.
  void stop();
  TapSession(const TapSession&) = delete;
  TapSession& operator=(const TapSession&) = delete;

  /// {"id", "revision", "hits", "stream", "force_direction", "running", "good", "wanted", "waiting", "taken", "frf",
  /// "peaks"}
  [[nodiscard]] std::string state() const;
  /// Of one hit, from 1: TapHits::about.
  [[nodiscard]] io::Json about(std::size_t number) const { return hits_.about(number); }
  /// False where there is no such hit. The average follows, and an event with it.
  /// @throws InvalidInput as TapHits::set_accepted
  [[nodiscard]] bool set_accepted(std::size_t number, bool accepted);
  /// Of the hits that come from now on. @throws InvalidInput if it is none, or there is no stream
  void set_direction(const std::string& direction);
  /// By the ending: .toml the accepted hits, else their FRFs.
  /// @throws InvalidInput if none was accepted, or as write_tap_hits and write_tap_frfs
  [[nodiscard]] TapWritten save(const std::filesystem::path& path, bool replace);

 private:
  void run(const std::stop_token& stop);
  [[nodiscard]] bool take_files();
  [[nodiscard]] bool take_record(const std::filesystem::path& file);
  void add_hits(const std::vector<std::filesystem::path>& files);
  [[nodiscard]] bool take_records();
  void send(std::string_view event, const std::string& data);
  void update();
  void wake();

  Options options_;
  TapSettings settings_;
  Publish publish_;
  std::mutex publishing_;
  bool ended_ = false;  ///< under it
  TapHits hits_;
  std::unique_ptr<TapFolder> folder_;  ///< not of a stream
  /// Files whose record has others that have not appeared yet, by folder and what their names have in common.
  std::map<std::string, std::vector<std::filesystem::path>> waiting_;
  mutable std::mutex mutex_;
  std::condition_variable_any woken_;
  bool due_ = false, changed_by_hand_ = false;
  io::Json state_;
  std::uint64_t revision_ = 0;
  std::unique_ptr<TapStream> stream_;  ///< none: files of a folder
  std::jthread thread_;
};

}  // namespace robomill::serve
