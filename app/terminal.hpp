#pragma once
#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"

namespace robomill::app {

/// Set by Ctrl-C (SIGINT), SIGTERM and SIGHUP. A verb that has not ended 0.8 s later, whatever it is at, is ended with
/// exit_of_signal() and without its temporary files; a second signal does so at once.
const std::atomic<bool>& stop_on_signal();

/// Prints sentences, which may hold names out of files, a line each behind a label.
void print_notes(const std::vector<std::string>& notes, std::string_view label);

/// What a shell sees of a program that the signal ended: 130 (SIGINT), 143 (SIGTERM), 129 (SIGHUP).
[[nodiscard]] int exit_of_signal() noexcept;

/// After a signal: the verb saves what it has, which may take so much longer.
void take_time_to_end(double seconds) noexcept;

/// A bar on standard error with the time left, where that is a terminal and the work takes over a second.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  Progress& progress() { return progress_; }

 private:
  void draw(const std::string& task, double fraction);
  double started_s_ = 0.0;
  double drawn_s_ = 0.0;
  bool visible_ = false;
  Progress progress_;
};

}  // namespace robomill::app
