#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

// Method: robomill/modal/README.md, "Hits out of a stream"

namespace robomill::modal {

/// When a record of a hit begins, and how long it is.
struct HitTriggerOptions {
  double sample_rate_hz = 0.0;  ///< > 0; required
  int channels = 0;             ///< of the stream, interleaved; >= 1; required
  int force_channel = 0;        ///< from 0
  double force_factor = 1.0;    ///< [N] per 1 of the stream; finite, not 0; may be negative
  double level_n = 0.0;         ///< a force further than this from its offset is a hit; 0: found from what comes
  double record_s = 1.0;        ///< of a record; at least 512 frames
  /// @throws InvalidInput naming the member
  void validate() const;
  [[nodiscard]] std::size_t record_frames() const;
  /// Of a record before the trigger: 5 % of it, at least 256, at most a quarter.
  [[nodiscard]] std::size_t pre_frames() const;

  static constexpr std::size_t fewest_frames = 512;
  static constexpr std::size_t most_values = std::size_t{1} << 21;  ///< frames × channels of a record
};

/// What was cut out of the stream.
struct HitRecord {
  std::uint64_t first_frame = 0;    ///< counted from the stream's begin; frames that were lost count
  std::uint64_t trigger_frame = 0;  ///< the first one beyond the level
  std::vector<float> samples = {};  ///< channels interleaved, as they came
};

/// Cuts records of hits out of a stream that never ends. What it holds does not grow: after the constructor it
/// allocates nothing. The result does not depend on how the stream is parted into calls of add.
class HitTrigger {
 public:
  struct Calls {
    std::function<void()> triggered = {};                  ///< a record has begun
    std::function<void(const HitRecord&)> record = {};     ///< it is complete; valid during the call
    std::function<void(const HitRecord&)> discarded = {};  ///< samples were lost in it; has no samples
  };
  /// @throws InvalidInput as HitTriggerOptions::validate
  HitTrigger(const HitTriggerOptions& options, Calls calls);

  /// Whole frames; samples that are not finite were lost.
  void add(std::span<const float> samples);
  /// Frames that were lost and are not in what add is given.
  void gap(std::uint64_t frames);

  [[nodiscard]] bool recording() const { return recording_; }
  /// The level in force [N]; NaN: not enough was seen yet.
  [[nodiscard]] double level_n() const;
  [[nodiscard]] const HitTriggerOptions& options() const { return options_; }

 private:
  static constexpr std::size_t stretches = 64, fewest_stretches = 8;

  void take(const float* frame);
  void learn(double force_n);
  void end_stretch();
  void begin();
  void end();
  void discard();

  HitTriggerOptions options_;
  Calls calls_;
  std::size_t channels_, record_frames_, pre_frames_, hold_off_frames_, stretch_frames_;
  std::uint64_t frame_ = 0;        ///< of the one that comes
  std::uint64_t sound_since_ = 0;  ///< none was lost since this one
  std::uint64_t held_until_ = 0;
  std::vector<float> before_;  ///< the last pre_frames_ frames, as a ring by frame_
  HitRecord record_;
  bool recording_ = false, beyond_ = false;
  double highest_n_ = 0.0;                       ///< in this record
  double last_peak_n_ = 0.0, last_frame_ = 0.0;  ///< of the last record, and where it was triggered

  // Of stretches of 5 ms without a hit: mean, standard deviation and greatest excursion.
  std::array<double, stretches> means_n_ = {}, deviations_n_ = {}, excursions_n_ = {};
  std::size_t stretch_count_ = 0;
  std::size_t in_stretch_ = 0;
  double origin_n_ = 0.0, sum_n_ = 0.0, squares_n2_ = 0.0, low_n_ = 0.0, high_n_ = 0.0;
  double offset_n_ = 0.0, level_n_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace robomill::modal
