#include "robomill/process/vibration_text.hpp"

#include <fmt/format.h>

#include "robomill/base/units.hpp"
#include "robomill/modal/mode_id.hpp"

namespace robomill::process {

std::string vibration_text(const stability::ForcedVibration& vibration, double share) {
  std::string text = fmt::format(
      "the tip moves {:.3g} µm to either side of its mean position, {:.0f} % of the feed per tooth. The largest part, "
      "{:.3g} µm, is {} × {} ({:.1f} Hz)",
      vibration.amplitude_m / units::um, 100.0 * share, vibration.harmonic_m / units::um, vibration.harmonic,
      vibration.of_tooth_passing ? "tooth passing" : "the rotation", vibration.frequency_hz);
  if (vibration.mode.known()) {
    text += fmt::format(", in which {} ({:.1f} Hz) moves most", to_string(vibration.mode), vibration.mode_frequency_hz);
  }
  return text;
}

}  // namespace robomill::process
