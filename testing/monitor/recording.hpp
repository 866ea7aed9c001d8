#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/simulation/drilling.hpp"
#include "robomill/simulation/simulation.hpp"

/// Recordings of simulated cuts whose chatter is known, for tests and programs in bench/.
namespace robomill::monitor::testing {

inline constexpr double corpus_rate_hz = 10240.0;

/// Even in its logarithm.
[[nodiscard]] double log_uniform(double low, double high, Random& random);

/// What is true of a recording. The chatter component c(t) is taken from noise-free simulation: the acceleration of the
/// cut (nonlinear, with loss of contact) less that of the same cut without regeneration (the forced vibration, which
/// cannot chatter), of which the change from one revolution to the next is kept, c(φ) - c(φ - 2π): what runout makes
/// regeneration add to the forced vibration repeats every revolution, chatter does not; the gain 2 |sin(πf/f_rot)| that
/// this has at the chatter frequency is divided out. (Where chatter is locked to the
/// spindle by design that last step is left out, and there is no runout.) Its amplitude is the root of the mean square
/// over both channels and a centred window of one tooth period or one period of the chatter's displacement, whichever
/// is longer; its final amplitude the median of those amplitudes that are above half of the largest.
struct Truth {
  bool chatter = false;
  /// From then to t10 the amplitude is above a fiftieth of the final one or a tenth of the reference level, whichever
  /// is less: chatter is there.
  double start_s = 0.0;
  double t10_s = 0.0;  ///< from then on it is above a tenth, until it has reached half
  double end_s = 0.0;  ///< below a tenth after it was last above half; else the end of the recording
  bool ends = false;   ///< whether that is before the recording's end
  double final_m_per_s2 = 0.0;
  double comb_gain = 1.0;  ///< of the change per revolution at frequency_hz; amplitudes are divided by it
  /// Strongest line of c where its amplitude is above half the final one; and all lines within 10 dB of it.
  double frequency_hz = 0.0;
  std::vector<double> lines_hz = {};
  double displacement_hz = 0.0;                ///< strongest line of the displacement: the mode's, not its sideband's
  std::vector<float> amplitude_m_per_s2 = {};  ///< one a frame
  std::vector<float> speed_rad_per_s = {};     ///< of the spindle, one a frame
  /// Where the frequency moves: of the strongest line, one a frame; the other lines keep their distance from it. Empty:
  /// frequency_hz holds throughout.
  std::vector<float> course_hz = {};
};

struct RecordedCut {
  std::string kind = {};    ///< "milling low", "milling high", "drilling", …
  std::string course = {};  ///< "ramp", "step", "abrupt" or "stable"
  int noise = 0;            ///< 0, 1, 2
  double sample_rate_hz = corpus_rate_hz;
  int channels = 2;                 ///< x, y
  std::vector<int> sensors = {};    ///< of each channel its sensor, from 0; empty: one
  std::vector<float> samples = {};  ///< interleaved [m/s²]
  int tachometer_channel = -1;      ///< of these, from 0: pulses of 0 or 5 V; -1: none
  int pulses_per_revolution = 1;    ///< of it
  double hint_rad_per_s = 0.0;      ///< the spindle speed as given, off by up to five percent
  int teeth = 0;
  Truth truth;
  [[nodiscard]] double seconds() const { return static_cast<double>(samples.size()) / channels / sample_rate_hz; }
};

/// A cut with a schedule from entry to exit; time 0 is where its simulation starts.
struct CutPlan {
  bool drilling = false;
  simulation::MillingCut milling;
  simulation::DrillingCut drill;
  double seconds = 3.0;        ///< of the simulation
  double idle_before_s = 0.3;  ///< silence put before it
  double idle_after_s = 0.2;
  bool locked = false;  ///< chatter that repeats every revolution: see Truth
  [[nodiscard]] double speed_rad_per_s() const;
  [[nodiscard]] int teeth() const { return drilling ? drill.lips : milling.milling.tool.teeth; }
  [[nodiscard]] double runout_m() const { return drilling ? drill.runout_m : milling.milling.tool.runout_m; }
  [[nodiscard]] const simulation::Schedule& schedule() const { return drilling ? drill.schedule : milling.schedule; }
  [[nodiscard]] const modal::TipModes& structure() const { return drilling ? drill.structure : milling.structure; }
};

/// A plan without noise: x and y, rows of corpus_rate_hz, idle times included.
struct CleanCut {
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 2>;
  Columns acceleration_m_per_s2;                  ///< of the cut
  Columns forced_m_per_s2;                        ///< of the same without regeneration
  Columns regenerated_m;                          ///< displacement of the one less that of the other
  Columns displacement_m, forced_displacement_m;  ///< of the one and the other
  Columns force_n, forced_force_n;                ///< on the tool
  std::vector<double> rotation_rad = {};          ///< of the spindle, from 0; one a row
  std::vector<float> speed_rad_per_s = {};        ///< one a row
  std::vector<float> depth_share = {};
  bool diverged = false;
};
[[nodiscard]] CleanCut simulate(const CutPlan& plan);
[[nodiscard]] Truth truth_of(const CutPlan& plan, const CleanCut& clean, bool chatter);
/// Truth's c(t), x and y: what of the acceleration is chatter.
[[nodiscard]] CleanCut::Columns chatter_of(const CutPlan& plan, const CleanCut& clean, const Truth& truth);
/// Fills the final amplitude and the times from the amplitudes at corpus_rate_hz.
void find_times(Truth& truth, double reference_level_m_per_s2);
/// x at a row that need not be whole, by a sinc under a Hann window of 24 rows; 0 outside.
[[nodiscard]] Eigen::RowVector2d at_row(const CleanCut::Columns& x, double row);

/// Root mean square of the forced vibration while cutting, over both channels, at least 0.5 m/s², drilling
/// 5 m/s²: what drills do beside what is simulated.
[[nodiscard]] double reference_level(const CutPlan& plan, const CleanCut& clean);

/// What a recording has beside the cut, as shares of its reference level.
struct Disturbance {
  double noise = 0.05;        ///< rms of the noise: white, red, and of two resonances while cutting
  double hum = 0.03;          ///< amplitude at 50 Hz; less at 100, 150 and 250 Hz
  double unbalance = 0.03;    ///< amplitude at the rotation
  double gain_swing = 0.1;    ///< of the gain about 1
  double knocks_per_s = 0.4;  ///< impulses on the structure, 1 to 10 times the rms at their peak
};
/// The resonances that colour a channel's noise while cutting.
struct NoiseResonances {
  double structure_hz = 0.0, local_hz = 0.0;
};
/// Interleaved samples.
/// @param drawn  where not null, the resonances that were drawn
[[nodiscard]] std::vector<float> disturbed(const CutPlan& plan, const CleanCut& clean, const Disturbance& disturbance,
                                           Random& random, std::array<NoiseResonances, 2>* drawn = nullptr);
/// Power per hertz of the noise of one channel while cutting, one-sided, as a share of (reference level x
/// Disturbance::noise)²; its integral from 0 to half of corpus_rate_hz is its variance.
[[nodiscard]] double noise_density_per_hz(const NoiseResonances& of, double frequency_hz);
/// Adds a knock to interleaved samples of two channels: the structure's acceleration after a blow, and a short ring of
/// the accelerometer's surroundings.
void add_knock(const modal::TipModes& structure, double peak_m_per_s2, double time_s, Random& random,
               std::vector<float>& samples);

}  // namespace robomill::monitor::testing
