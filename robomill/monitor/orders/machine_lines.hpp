#pragma once
#include <cstddef>
#include <memory>
#include <utility>

#include "robomill/monitor/machine.hpp"

namespace robomill::monitor {

/// What a machine that was learnt shows about a frequency. Without one nothing is known.
class MachineLines {
 public:
  static constexpr double least_new = 4.0;  ///< of the energy: less was there before

  explicit MachineLines(std::shared_ptr<const Machine> machine) : machine_(std::move(machine)) {}
  [[nodiscard]] bool known() const noexcept { return machine_ != nullptr; }
  /// The cell of a frequency with two to each side.
  struct Band {
    double from_hz = 0.0, to_hz = 0.0;
  };
  [[nodiscard]] static Band band(double frequency_hz) noexcept;
  /// The energy that is exceeded there in one hop of a hundred.
  /// @param rotation_hz  of the spindle; 0: not known
  /// @param beside       what stands at multiples of rotation is left out
  [[nodiscard]] double shown(double frequency_hz, double rotation_hz, bool beside) const noexcept;

 private:
  std::shared_ptr<const Machine> machine_;
};

}  // namespace robomill::monitor
