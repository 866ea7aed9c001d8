#include <robomill/modal/modes.hpp>

#include <cmath>
#include <cstdio>

// A mode's pole has the modulus of its undamped natural frequency.
int main() {
  robomill::modal::Mode mode;
  mode.frequency_hz = 100.0;
  mode.damping_ratio = 0.05;
  const double modulus = std::abs(robomill::modal::pole(mode));
  std::printf("|pole| / 2 pi = %.6f Hz\n", modulus / (2.0 * std::acos(-1.0)));
  return std::abs(modulus / (200.0 * std::acos(-1.0)) - 1.0) < 1e-12 ? 0 : 1;
}
