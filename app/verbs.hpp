#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/verbs.hpp"

namespace robomill::app {

/// Exit codes of a verb that ended by itself; bad input and wrong usage are main's, what a signal ended is
/// exit_of_signal().
enum Exit : int { done = 0, bad_input = 1, wrong_usage = 2, not_reached = 3 };

/// What every verb takes.
struct Common {
  std::string output;            ///< path, "-" for JSON on standard output, empty for a summary alone
  std::filesystem::path report;  ///< .html or .json; empty: none
  bool quiet = false;
  int threads = 0;           ///< 0: one a core
  bool allow_large = false;  ///< work that takes long or much memory is not rejected before it begins

  [[nodiscard]] bool to_stdout() const { return output == "-"; }
  [[nodiscard]] bool wants_summary() const { return !quiet && !to_stdout(); }
};

/// What this program is asked for where it is to work for a server that it is too (ServeOptions::worker).
inline constexpr std::string_view serve_worker = "serve-worker";
/// The program's exit code.
[[nodiscard]] int work_for_server();

/// Records of the verbs that are no jobs: without a run.
[[nodiscard]] std::vector<jobs::Verb> own_verbs();
Exit run_init(const jobs::VerbJob& job, const Common& common, Progress& progress);
Exit run_monitor(const jobs::VerbJob& job, const Common& common, Progress& progress);
Exit run_stream(const jobs::VerbJob& job, const Common& common, Progress& progress);
Exit run_serve(const jobs::VerbJob& job, const Common& common, Progress& progress);
Exit run_schema(const jobs::VerbJob& job, const Common& common, Progress& progress);
Exit run_completion(const jobs::VerbJob& job, const Common& common, Progress& progress);
Exit run_man(const jobs::VerbJob& job, const Common& common, Progress& progress);

}  // namespace robomill::app
