#include "robomill/report/monitor.hpp"

#include "robomill/base/error.hpp"
#include "robomill/report/checks.hpp"

namespace robomill::report {
namespace {

void validate_spectrogram(const Spectrogram& spectrogram) {
  if (spectrogram.level_db.size() == 0) return;
  require_axis("spectrogram.frequency_hz", spectrogram.frequency_hz);
  require_length("spectrogram.level_db", spectrogram.level_db.rows(), spectrogram.frequency_hz.size(), false);
  require_all_finite("spectrogram.level_db", spectrogram.level_db);
  require_positive("spectrogram.step_s", spectrogram.step_s, "s");
}

}  // namespace

void MonitorRun::validate() const {
  if (channels.empty()) throw InvalidInput("channels", "must hold at least one");
  const Eigen::Index waves = channels.front().wave.low.size();
  if (waves > 0) require_positive("wave_run_s", wave_run_s, "s");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    require_band(member("channels", i, "wave"), channels[i].wave, waves, false);
  }
  validate_spectrogram(spectrogram);
  const Eigen::Index runs = score.low.size();
  if (runs > 0) require_positive("decision_run_s", decision_run_s, "s");
  require_band("score", score, runs, false);
  require_band("threshold", threshold, runs, false);
  require_band("energy_entropy", energy_entropy, runs, true);
  require_band("spindle_speed_rad_per_s", spindle_speed_rad_per_s, runs, true);
}

}  // namespace robomill::report
