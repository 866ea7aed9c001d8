#include "robomill/jobs/learn.hpp"

#include <utility>

#include "robomill/monitor/files/machine_recordings.hpp"

namespace robomill::jobs {

LearnResult run_learn(const std::filesystem::path& monitor_toml, const std::vector<std::filesystem::path>& recordings,
                      Progress& progress) {
  monitor::MonitorFile file = monitor::read_monitor(monitor_toml);
  LearnResult out{.machine = monitor::learn_recordings(file, recordings, progress)};
  out.notes = std::move(file.notes);
  return out;
}

}  // namespace robomill::jobs
