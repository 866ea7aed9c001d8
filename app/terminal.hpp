#pragma once
#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"

namespace robomill::app {

/// Set by Ctrl-C (SIGINT, SIGTERM); a second one ends the program at once.
const std::atomic<bool>& stop_on_signal();

/// Prints sentences, which may hold names out of files, a line each behind a label.
void print_notes(const std::vector<std::string>& notes, std::string_view label);

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
