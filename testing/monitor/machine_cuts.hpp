#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "robomill/base/names.hpp"
#include "testing/monitor/recording.hpp"

/// Cuts with what recordings of real machines show and the corpus of corpus.hpp lacks. What was taken from recordings,
/// and the models: testing/monitor/README.md.
namespace robomill::monitor::testing {

enum class MachineClass {
  abrupt,       ///< simulated; nine tenths of the final amplitude within 0.1 s of the tool's entry
  drifting,     ///< modelled; the frequency moves by 50 to 500 Hz/s
  hopping,      ///< modelled; the chatter changes from one mode of two or three to another and back
  microphone,   ///< simulated; one or two microphones at 44.1 or 48 kHz, the room's tones, echoes and noise, 16 bits
  aliased,      ///< simulated, half of those that chatter modelled at 900 to 3,500 Hz; three channels at 1,650 Hz,
                ///< without a filter before the converter
  tones,        ///< simulated; tones of the machine at no multiple of rotation, in air and cut
  run_up_down,  ///< simulated; the spindle stands, runs up, idles, cuts, idles, runs down
  air,          ///< the spindle idles: its drive, tones that start and end, knocks; never chatter
  pulses        ///< simulated; a channel with 1 to 1,024 pulses a revolution, as the converter sees them
};
inline constexpr Name<MachineClass> machine_class_names[] = {{"abrupt", MachineClass::abrupt},
                                                             {"drifting", MachineClass::drifting},
                                                             {"hopping", MachineClass::hopping},
                                                             {"microphone", MachineClass::microphone},
                                                             {"aliased", MachineClass::aliased},
                                                             {"tones", MachineClass::tones},
                                                             {"run-up-down", MachineClass::run_up_down},
                                                             {"air", MachineClass::air},
                                                             {"pulses", MachineClass::pulses}};

inline constexpr double aliased_rate_hz = 1650.0;

/// Seeds of each class: 1 to 20 are for tests and for what is reported, 1001 on for tuning, 5001 on are held out: for
/// one look at the end, and nothing is fitted to them. Odd seeds chatter, even ones (and all of `air`) do not; the
/// noise is 3, 10 or 30 % of the reference level. The hint is exact in a fifth of the cuts and off by up to 5 % in the
/// others. Amplitudes and times of Truth are as it says, where the recording is sampled otherwise at its frames; those
/// of modelled chatter are of the model. Frequencies are those in the recording: what lies above half its rate is
/// folded. kind: the class's name; course: "ramp", "step", "abrupt", "model" or "stable".
[[nodiscard]] RecordedCut machine_cut(MachineClass kind, std::uint64_t seed);

/// A cut, and what stands before the sensors.
struct MachineCut {
  RecordedCut recorded;
  CutPlan plan;
  CleanCut clean;        ///< of corpus_rate_hz; with modelled chatter
  double entry_s = 0.0;  ///< first contact; NaN: none
  Truth at_corpus_rate;  ///< of `clean`: nothing folded
  int upward_edges = 0;  ///< of the tachometer's channel, as its angle has them
  double gain = 0.0;     ///< of a microphone; 0: by its loudest sample
};
[[nodiscard]] MachineCut draw_machine_cut(MachineClass kind, std::uint64_t seed);

/// A cut, and other recordings of the same machine with the same sensors: the spindle turns as in the cut and nothing
/// is cut. Its tones and drives are the cut's, noise and knocks are drawn anew.
struct MachineWithAir {
  RecordedCut cut;
  std::vector<RecordedCut> air;
};
[[nodiscard]] MachineWithAir machine_with_air(MachineClass kind, std::uint64_t seed, int recordings);

/// Where a converter without a filter shows a frequency: its distance to the nearest multiple of the rate.
[[nodiscard]] double folded_hz(double frequency_hz, double rate_hz);

struct PulseTrain {
  int pulses_per_revolution = 1;
  double duty = 0.5;      ///< share of a pulse's angle at its high level
  bool inverted = false;  ///< high and low exchanged
};
/// Adds a channel, the last, of 0 and 5 V with 5 mV of noise, whose level at each sample is that of the spindle's angle
/// then: the integral of truth.speed_rad_per_s from a random angle.
/// @return the number of upward edges, inverted or not, that the samples show
int add_tachometer(RecordedCut& cut, const PulseTrain& train, Random& random);

}  // namespace robomill::monitor::testing
