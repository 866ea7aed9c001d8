#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/page/report.hpp"
#include "verbs.hpp"

namespace robomill::app {

/// Set by Ctrl-C (SIGINT), SIGTERM and SIGHUP. A verb that has not ended 0.8 s later, whatever it is at, is ended with
/// exit_of_signal() and without its temporary files; a second signal does so at once.
const std::atomic<bool>& stop_on_signal();

/// Prints sentences, which may hold names out of files, a line each behind a label.
void print_notes(const std::vector<std::string>& notes, std::string_view label);

/// Before the work. @throws InvalidInput if -o names a file in which this document is not written
void require_output(const Common& common, jobs::Document document);
/// … with this rule if -o names a file of another format
void require_output(const Common& common, std::initializer_list<io::Format> formats, const char* rule);
/// After it: JSON to standard output, or the file that -o names, in its format; nothing without -o.
void write_output(const Common& common, const std::function<std::string(io::Format)>& text_of);

/// The same of a verb's result.
template <class Result>
void write_result(const Common& common, const Result& result) {
  if (!common.output.empty() && !common.to_stdout()) return jobs::write_document(common.output, result);
  write_output(common, [&](io::Format format) { return jobs::document(result, format); });
}

[[nodiscard]] bool is_html(const std::filesystem::path& path);
/// @throws InvalidInput unless the path is empty or ends in .html or .json
void require_report_place(const std::filesystem::path& path);
/// The summary where one is wanted, and where --report asks for it the page, or its data.
/// @param page  is made only then
void show(const Common& common, const std::string& summary, const std::function<page::Report()>& page);
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
