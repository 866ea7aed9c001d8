#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/monitor/README.md, "Machines that were learnt"

namespace robomill::monitor {

/// What a machine shows without chatter at one speed: in cells of Machine::cell_hz, from 0 on, the energy [input's
/// unit²] that one hop in a hundred exceeds.
struct LearntRow {
  double rotation_hz = 0.0;         ///< the mean; 0: in air, or at a speed that was not known
  int hops = 0;                     ///< that it was learnt from
  std::vector<double> beside = {};  ///< beside the multiples of rotation; empty where the speed is not known
  std::vector<double> all = {};     ///< of everything
};

/// A tone of the machine, of its drives or of the room: for people to read.
struct LearntTone {
  double frequency_hz = 0.0;
  double level = 0.0;  ///< rms where it stands, all channels together [input's unit]
  double share = 0.0;  ///< of the hops
};

/// Impulses: for people to read.
struct LearntKnocks {
  double per_minute = 0.0;
  double strongest = 0.0;     ///< rms of a hop, all channels together [input's unit]
  double frequency_hz = 0.0;  ///< of what rings, median; 0: none
  double decay_per_s = 0.0;   ///< of its amplitude, median; 0: not known
};

/// What a machine shows without chatter. It holds for the sensor, unit and gain that it was learnt with: nothing is
/// normalised.
struct Machine {
  static constexpr double cell_hz = 10.0;

  double sample_rate_hz = 0.0;
  int channels = 0;                    ///< of vibration
  double seconds = 0.0;                ///< that were learnt
  double quietest_energy = 0.0;        ///< the least of all energy in 0.3 s while the spindle turns [input's unit²]
  LearntRow air = {};                  ///< where no speed was known; without hops: it always was
  std::vector<LearntRow> rows = {};    ///< by rotation, rising
  std::vector<LearntTone> tones = {};  ///< the loudest first
  LearntKnocks knocks = {};
  std::vector<Machine> others = {};  ///< what further sensors show (MonitorOptions::sensors), each without others

  [[nodiscard]] std::size_t sensors() const noexcept { return 1 + others.size(); }
  /// From 0 on. @throws std::out_of_range
  [[nodiscard]] const Machine& of_sensor(std::size_t sensor) const {
    return sensor == 0 ? *this : others.at(sensor - 1);
  }
  /// @throws InvalidInput naming the member
  ROBOMILL_API void validate() const;
};

/// A recording without chatter.
struct CalmRecording {
  std::string name = {};
  std::vector<float> samples = {};       ///< of all channels, interleaved
  double spindle_speed_rad_per_s = 0.0;  ///< a hint; 0: that of the options
};

/// Learns a machine from recordings without chatter (the spindle idles, runs up, cuts stably), of any length.
class ROBOMILL_API MachineLearner {
 public:
  /// @param options  of the default detector; a machine among them is left out
  /// @throws InvalidInput as MonitorOptions::validate
  explicit MachineLearner(const MonitorOptions& options);
  ~MachineLearner();
  MachineLearner(MachineLearner&&) noexcept;
  MachineLearner& operator=(MachineLearner&&) noexcept;
  MachineLearner(const MachineLearner&) = delete;
  MachineLearner& operator=(const MachineLearner&) = delete;

  /// Another recording. @param spindle_speed_rad_per_s  a hint; 0: that of the options
  void begin(double spindle_speed_rad_per_s = 0.0);
  /// As ChatterMonitor::set_spindle_speed.
  void set_spindle_speed(double rad_per_s);
  /// Frames of the recording that began last.
  /// @return when the monitor raised an alarm in it [s]: it seems to contain chatter, and is no use
  std::optional<double> push(std::span<const float> samples);
  /// @throws InvalidInput where less than a second was learnt
  [[nodiscard]] Machine finish() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The same of recordings that are held.
/// @throws InvalidInput naming recording and time where one seems to contain chatter, or as MachineLearner
/// @throws Interrupted when progress asks to stop
[[nodiscard]] ROBOMILL_API Machine learn_machine(std::span<const CalmRecording> recordings,
                                                 const MonitorOptions& options, Progress& progress = Progress::none());

/// The error about a recording in which the monitor raises an alarm.
[[nodiscard]] ROBOMILL_API InvalidInput chatter_in(const std::string& recording, double alarm_s);

}  // namespace robomill::monitor
