#pragma once
#include <cstddef>
#include <vector>

namespace robomill::monitor {

/// Follows whether the tool cuts, enters or leaves, by the energies of all and of the multiples of rotation.
class CutState {
 public:
  /// @param quiet  the least energy that is known before; 0: none
  explicit CutState(double hop_s, double quiet = 0.0);
  struct Measured {
    double energy = 0.0;             ///< E, of all, in the last 0.3 s
    double synchronous = 0.0;        ///< of the multiples of rotation, in the window that they are followed in …
    double whole = 0.0;              ///< … and of all, there
    double teeth = 0.0;              ///< of the multiples of tooth passing, there
    double family = 0.0;             ///< of the strongest family beside the orders, there
    double short_synchronous = 0.0;  ///< of the multiples of rotation, in the shorter window
    double rotation_hz = 0.0;        ///< 0: not tracked
    double comb = 0.0;               ///< SpeedTracker::seen
    bool given = false;              ///< the speed was
    bool full = false;               ///< 0.3 s have been seen
  };
  /// A hop. @param chatter  no entry begins
  void step(const Measured& now, bool chatter) noexcept;
  void reset() noexcept;

  [[nodiscard]] double quiet() const noexcept {
    return quiet_;
  }  ///< the least E, forgotten over 10 s without chatter; 0: not known
  [[nodiscard]] double above_quiet() const noexcept;        ///< E to it
  [[nodiscard]] double synchronous_share() const noexcept;  ///< S/W
  /// S against what it must be for the speed to be right: 0.2 W; or half of what it was when it last held that in a
  /// cut, where chatter beside it holds the rest. >= 1: it is.
  [[nodiscard]] double anchored() const noexcept;
  [[nodiscard]] double cutting() const noexcept;       ///< >= 1: the tool cuts
  [[nodiscard]] double staying() const noexcept;       ///< E to the most of the last 0.4 s
  [[nodiscard]] double entered_s() const noexcept;     ///< since the tool entered
  [[nodiscard]] double swing() const noexcept;         ///< of the shorter window's S in 0.3 s
  [[nodiscard]] double speed_change() const noexcept;  ///< in 0.3 s, of the speed

 private:
  double hop_s_, first_quiet_;
  Measured now_;
  std::vector<double> energy_, teeth_, short_synchronous_, rotation_hz_;  // rings
  double usual_hz_ = 0.0;
  double usual_synchronous_ = 0.0;  // S while it holds the cut, slow; 0: not since the tool entered
  std::size_t hops_ = 0;
  std::size_t since_entry_ = 0;  // hops
  double quiet_ = 0.0;
};

}  // namespace robomill::monitor
