#pragma once
#include <cstdint>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/modal/hits.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::examples {

/// A simulated hammer, its accelerometer and the recorder.
struct Hammer {
  double peak_force_n = 200.0;
  double pulse_s = 1.2e-3;  ///< length of the half sine
  double force_noise_n = 0.05;
  double response_noise = 0.005;  ///< in the SI unit of response
  modal::ResponseKind response = modal::ResponseKind::acceleration;
  double sample_rate_hz = 4096.0;
  double record_s = 5.0;
  double pretrigger_s = 0.05;
};

/// The record of one half-sine hit at `excitation` on a structure with these modes, at rest before.
///
/// Force and responses are made in the frequency domain, X(ω) = (iω)^p H(ω) F(ω) A(ω) with F the exact transform of a
/// half sine and A the recorder's low-pass filter on all channels (one up to 0.35 of the sample rate, zero from 0.45
/// on), over a time so long that the slowest mode has died. A measured model may have Σ 2 Re(R Lᵀ) ≠ 0: its
/// displacement then jumps when it is hit, its acceleration has no value at the jump, and only filtered acceleration
/// exists.
/// @throws InvalidInput if the model is not valid or excitation is none of its own
[[nodiscard]] modal::Hit simulate_hit(const modal::ModalModel& model, const modal::Dof& excitation,
                                      const Hammer& hammer, Random& random);

/// `count` hits for each excitation of the model; peak and length of the pulse scatter by `scatter` (standard
/// deviation, relative).
[[nodiscard]] std::vector<modal::Hit> simulate_hits(const modal::ModalModel& model, int count, double scatter,
                                                    const Hammer& hammer, std::uint64_t seed);

}  // namespace robomill::examples
