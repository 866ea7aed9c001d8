#pragma once
#include <cstdint>
#include <mutex>

namespace robomill::live {

/// Which of two threads published the state that holds: the session's own, or the watchdog while that one hangs.
/// Neither waits for what the other publishes. So where both do at once nobody knows which came last, and the session
/// has to publish its state again.
class PublishedState {
 public:
  /// The session publishes a state, between begin() and end(). @param overloaded  BlindReason::overloaded
  void begin(bool overloaded);
  void end();
  /// The watchdog: whether it is to publish the state of an overload, until end_stall(). Not where that holds already.
  [[nodiscard]] bool begin_stall();
  void end_stall();

  /// Of the session, what the watchdog has done since it asked last.
  struct Stall {
    bool was = false;        ///< it found one
    bool published = false;  ///< and its state is the one that holds
  };
  [[nodiscard]] Stall take_stall();
  /// Whether the state is to be published again, whatever it is.
  [[nodiscard]] bool take_doubt();

 private:
  std::mutex mutex_;
  Stall stall_;
  bool overloaded_ = false;               ///< the state that was published last
  bool publishing_ = false;               ///< the session
  bool doubt_ = false;                    ///< about which state that is
  std::uint64_t begun_ = 0;               ///< by the session
  std::uint64_t begun_before_stall_ = 0;  ///< and ended, when the watchdog began
};

}  // namespace robomill::live
