#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "command_line.hpp"
#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/system/output_places.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

using OwnRun = Exit (*)(const jobs::VerbJob&, const Common&, Progress&);
constexpr Name<OwnRun> own_runs[] = {{"init", &run_init},   {"monitor", &run_monitor}, {"smooth --stream", &run_stream},
                                     {"serve", &run_serve}, {"schema", &run_schema},   {"completion", &run_completion},
                                     {"man", &run_man}};

/// The verb's work, and what it came to: to standard output, the terminal and --report.
Exit run(const jobs::VerbJob& job, const Common& common, Progress& progress) {
  const jobs::Verb& verb = job.verb;
  if (verb.run == nullptr) return value_in(own_runs, verb.name).value()(job, common, progress);
  if (verb.document && !job.output.empty()) jobs::require_output(*verb.document, job.output);
  const jobs::Outcome outcome = verb.run(job, progress);
  if (common.to_stdout()) fmt::print("{}", outcome.json);
  if (!common.report.empty()) {
    const page::Report page = outcome.page();
    write_report(common.report, page, verb.report != nullptr ? page.*verb.report : std::string());
  }
  if (common.wants_summary()) fmt::print("{}", outcome.summary);
  return exit_of(outcome.shortfall);
}

int report_error(const char* text, int exit) {
  std::fprintf(stderr, "robomill: %s\n", printable_lines(text).c_str());
  return exit;
}

/// By errno.
int report_unwritten() {
  const std::string why = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  return report_error(("standard output cannot be written" + why).c_str(), bad_input);
}

int run_chosen(int argc, char** argv) {
  CommandLine line;
  if (const std::optional<Exit> ended = line.parse(argc, argv)) return *ended;
  try {
    const Asked asked = line.asked();
    const Common& common = asked.common;
    require_report_place(common.report);
    const io::OutputPlaces outputs(asked.outputs);
    set_thread_count(common.threads);
    set_cost_limit(common.allow_large ? no_cost_limit : CostLimit{.way_out = "--allow-large takes it"});
    ProgressBar bar(common.quiet);
    return run(asked.job, common, bar.progress());
  } catch (const InvalidInput& error) {
    return report_error(error.what(), bad_input);
  } catch (const Interrupted&) {
    return report_error("interrupted", exit_of_signal());
  } catch (const std::bad_alloc&) {
    return report_error("not enough memory for this input", bad_input);
  } catch (const std::system_error& error) {
    errno = error.code().value();
    return std::ferror(stdout) != 0 ? report_unwritten() : report_error(error.what(), bad_input);
  } catch (const std::exception& error) {
    return report_error(error.what(), bad_input);
  }
}

/// Closes standard output, where a full disk behind a redirection shows at the latest.
int end_with(int exit) {
  const bool said = exit != done && exit != not_reached;
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return said ? exit : report_unwritten();
  // One that was closed before took nothing; all was flushed where a signal interrupts closing.
  return std::fclose(stdout) == 0 || errno == EBADF || errno == EINTR || said ? exit : report_unwritten();
}

}  // namespace
}  // namespace robomill::app

int main(int argc, char** argv) {
  try {
    // No verb: nobody but `robomill serve` starts it.
    if (argc == 2 && robomill::app::serve_worker == argv[1]) return robomill::app::work_for_server();
    return robomill::app::end_with(robomill::app::run_chosen(argc, argv));
  } catch (...) {
    // Thrown before there is a verb to blame, or by the report of another error.
    std::fputs("robomill: cannot run\n", stderr);
    return robomill::app::bad_input;
  }
}
