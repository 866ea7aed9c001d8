#include "robomill/monitor/files/machine_recordings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/io/sample_source.hpp"

namespace robomill::monitor {

Machine learn_recordings(MonitorFile& file, std::span<const std::filesystem::path> recordings, Progress& progress) {
  constexpr std::size_t block_frames = 1 << 14;
  if (recordings.empty()) throw InvalidInput("--learn", "must name one recording at least");
  std::optional<MachineLearner> learner;
  progress.start("learning recordings", recordings.size());
  for (const std::filesystem::path& recording : recordings) {
    const auto source = io::open_samples(recording, file.columns);
    if (!learner) {
      if (file.options.sample_rate_hz <= 0.0) file.options.sample_rate_hz = source->sample_rate_hz();
      if (file.options.full_scale <= 0.0) file.options.full_scale = source->full_scale();
      validate(file);
      learner.emplace(file.options);
      if (source->sample_rate_hz() > 0.0) file.columns.sample_rate_hz = file.options.sample_rate_hz;
    }
    learner->begin();
    io::SampleBlock block;
    double speed_rad_per_s = std::numeric_limits<double>::quiet_NaN();
    while (source->next(block_frames, block)) {
      progress.check();
      if (std::isfinite(block.followed) && block.followed != speed_rad_per_s) {
        speed_rad_per_s = block.followed;
        learner->set_spindle_speed(speed_rad_per_s);
      }
      const std::optional<double> alarm_s = learner->push(block.samples);
      if (alarm_s) throw chatter_in(recording.string(), *alarm_s);
    }
    std::ranges::copy(source->notes(), std::back_inserter(file.notes));
    progress.advance();
  }
  return learner->finish();
}

}  // namespace robomill::monitor
