#pragma once
#include <atomic>
#include <filesystem>
#include <string>

#include "robomill/base/progress.hpp"
#include "robomill/page/report.hpp"
#include "verbs.hpp"

namespace robomill::app {

/// Set by Ctrl-C (SIGINT), SIGTERM and SIGHUP. A verb that has not ended 0.8 s later, whatever it is at, is ended with
/// exit_of_signal() and without its temporary files; a second signal does so at once.
const std::atomic<bool>& stop_on_signal();

[[nodiscard]] bool is_html(const std::filesystem::path& path);
/// @throws InvalidInput unless the path is empty or ends in .html or .json
void require_report_place(const std::filesystem::path& path);
/// The page, or where the path ends in .json this document; without one, the page's data.
void write_report(const std::filesystem::path& path, const page::Report& page, const std::string& json = {});

/// Says on standard error why the answer was not reached; empty: it was.
[[nodiscard]] Exit exit_of(const std::string& shortfall);

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
