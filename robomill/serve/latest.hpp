#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "robomill/base/progress.hpp"

// Method: robomill/serve/README.md, "The latest request wins"

namespace robomill::serve {

/// Requests of which the newest alone counts: those of one channel of one client follow each other by their sequence. A
/// newer one stops the older where it is computed, and takes its place where it waits. One thread computes one request
/// at a time, in parallel inside; channels take turns.
class Latest {
 public:
  /// How a request ended.
  struct Outcome {
    enum class Kind {
      answered,    ///< `answer` holds
      failed,      ///< `error` holds what the computation threw
      superseded,  ///< a newer one came, before this one or while it waited or was computed
      full         ///< too many channels wait
    } kind = Kind::superseded;
    std::string answer = {};
    std::exception_ptr error = {};
  };
  struct Request {
    std::string client, channel;
    std::uint64_t sequence = 0;
    /// On the thread that computes. Interrupted: superseded.
    std::function<std::string(Progress&)> compute;
    /// Called once, from any thread; throws nothing.
    std::function<void(Outcome)> done;
  };

  /// @param most_channels  of all clients together; those that have nothing to do are forgotten, the longest idle first
  explicit Latest(std::size_t most_channels = 64);
  /// What waits or is computed ends as superseded.
  ~Latest();
  Latest(const Latest&) = delete;
  Latest& operator=(const Latest&) = delete;

  /// Returns at once. A request with a sequence not above that of an earlier one of its channel is superseded.
  void submit(Request request);
  /// Channels that are known.
  [[nodiscard]] std::size_t channels() const;

 private:
  struct Channel {
    std::string client, name;
    std::optional<std::uint64_t> newest = {};  ///< highest sequence that came
    std::optional<Request> waits = {};         ///< the one to be computed next
    bool computing = false;
  };
  using Channels = std::list<Channel>;  ///< the one that was used last stands last
  Channels::iterator find(const Request& request);
  void work();

  const std::size_t most_channels_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Channels channels_;
  std::deque<Channels::iterator> turns_;  ///< of those that wait
  std::atomic<bool> stop_{false};         ///< what is computed now
  bool closing_ = false;
  std::jthread thread_;
};

}  // namespace robomill::serve
