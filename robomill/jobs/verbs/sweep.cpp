#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <string>

#include "robomill/base/printable.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/sweep.hpp"
#include "robomill/jobs/verbs/records.hpp"

namespace robomill::jobs {
namespace {

/// "3/16". @throws InvalidInput naming the option
void read_shard(const VerbJob& job, SweepJob& wanted) {
  const std::string text = job.text("shard");
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, wanted.shard);
  if (first == std::errc() && slash != end && *slash == '/') {
    const auto [last, second] = std::from_chars(slash + 1, end, wanted.shards);
    if (second == std::errc() && last == end && wanted.shard >= 1 && wanted.shard <= wanted.shards) return;
  }
  throw InvalidInput(job.named("shard"), fmt::format("\"{}\" must be i/n with 1 <= i <= n", printable(text)),
                     "As 3/16");
}

std::string points_text(const SweepResult& result) {
  std::string out = fmt::format("{} points done", result.done);
  if (result.short_of > 0) out += fmt::format(", {} without the answer of their job", result.short_of);
  if (result.rejected > 0) out += fmt::format(", {} rejected", result.rejected);
  return out + "\n";
}

std::string time_in_words(double time_s) {
  if (time_s < 60.0) return fmt::format("{:.2g} s", time_s);
  return time_s < 3600.0 ? fmt::format("{:.3g} min", time_s / 60.0) : fmt::format("{:.3g} h", time_s / 3600.0);
}

/// "3 running, 1 failed"
std::string tasks_text(const SweepTasks& tasks) {
  std::string out;
  const auto add = [&](int count, const char* what) {
    if (count > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, what);
  };
  add(tasks.done, "done");
  add(tasks.running, "running");
  add(tasks.waiting, "waiting");
  add(tasks.failed, "failed");
  add(tasks.idle, "that Slurm does not know");
  return out;
}

/// Of --status.
std::string progress_text(const SweepJob& job, const SweepResult& result) {
  std::string out;
  const SweepTasks& tasks = result.tasks;
  if (!tasks.array.empty()) {
    out += fmt::format("Job {} of Slurm has {} tasks: {}.\n", tasks.array, tasks.tasks, tasks_text(tasks));
    for (const std::string& failure : tasks.failures) {
      const std::string number = failure.substr(0, failure.find(':'));
      out += fmt::format("  task {} ({})\n", printable(failure),
                         printable((job.folder / "slurm" / (number + ".out")).string()));
    }
    if (tasks.failed + tasks.idle > 0) out += "  The same command with --slurm submits what is missing.\n";
    if (!tasks.merge_state.empty()) {
      out += fmt::format("Job {}, which writes the tables: {}.\n", tasks.merge, printable(tasks.merge_state));
    } else if (!tasks.has_tables) {
      out += fmt::format("No job that Slurm knows will write the tables: sbatch {}\n",
                         printable((job.folder / "slurm" / "merge.sh").string()));
    }
  }
  if (!result.running.empty()) out += fmt::format("At work here: {}.\n", fmt::join(result.running, ", "));
  if (result.left_s > 0.0) {
    out += fmt::format("Time left: {}.\n", time_in_words(result.left_s));
  } else if (result.left_thread_s > 0.0) {
    out += fmt::format("Time left: {} of one thread; none is at work.\n", time_in_words(result.left_thread_s));
  }
  return out;
}

std::string submitted_text(const SweepResult& result) {
  const SweepTasks& tasks = result.tasks;
  const std::string head = fmt::format("{} points in {} chunks of {}, {} tasks.\n", result.points, result.chunks,
                                       result.chunk_points, tasks.tasks);
  if (tasks.array.empty())
    return head + fmt::format("\nslurm/array.sh:\n{}\nslurm/merge.sh:\n{}", tasks.array_script, tasks.merge_script);
  return head + fmt::format("Job {} of Slurm does them, job {} writes the tables. --status shows how far they are.\n",
                            tasks.array, tasks.merge);
}

std::string summary_of(const SweepJob& job, const SweepResult& result) {
  std::string out;
  if (job.slurm) {
    out = submitted_text(result);
  } else if (job.dry_run) {
    out = fmt::format("{}{} points. The one in the middle took {:.3g} s of one thread: {:.3g} h in all.\n",
                      result.study.boundary ? "At most " : "", result.points, result.point_s,
                      result.point_s * static_cast<double>(result.points) / 3600.0);
  } else {
    out = fmt::format("{} points in {} {} of {}: {} done{}, {} by this run.\n", result.points, result.chunks,
                      result.chunks == 1 ? "chunk" : "chunks", result.chunk_points, result.done_chunks,
                      job.shards > 1 ? fmt::format(" of shard {}/{}", job.shard, job.shards) : "", result.ran_chunks) +
          points_text(result);
    if (result.point_s > 0.0) out += fmt::format("A point takes {:.3g} s of one thread.\n", result.point_s);
  }
  if (job.status) out += progress_text(job, result);
  for (const std::uint64_t chunk : result.damaged) {
    out += fmt::format("Warning: chunk {} was damaged, and was done again.\n", chunk);
  }
  for (const std::string& reason : result.reasons) out += "  " + printable(reason) + "\n";
  for (const std::string& name : result.absent) {
    out += fmt::format("Warning: no point has {}.\n", printable(name));
  }
  if (result.processors.size() > 1) {
    out += "Warning: several kinds of processors worked: the last bits of their results may differ:\n";
    for (const std::string& processor : result.processors) out += "  " + printable(processor) + "\n";
  }
  for (const std::string& line : result.findings) out += line + "\n";
  for (const std::string& file : result.written) out += "wrote " + printable(file) + "\n";
  return out;
}

page::Report page_of(const SweepResult& result, const std::string& summary) {
  page::Report page;
  page.title = "Study";
  page.created = created_now();
  page.notes = result.study.notes;
  page.summary = summary;
  page.statistics = result.statistics_json;
  page.study_points = result.study_points_json;
  return page;
}

Outcome run_sweep_verb(const VerbJob& job, Progress& progress) {
  SweepJob wanted = {.study = job.input(),
                     .folder = job.output,
                     .merge = job.file("merge"),
                     .dry_run = job.flag("dry_run"),
                     .status = job.flag("status"),
                     .slurm = job.flag("slurm")};
  if (job.has("shard")) read_shard(job, wanted);
  if (wanted.folder.empty() && !wanted.dry_run) {
    throw InvalidInput(job.named("output"), "is missing", "Give the folder of the study: -o study/");
  }
  const SweepResult result = run_sweep(wanted, progress);
  Outcome outcome = {.summary = summary_of(wanted, result)};
  if (result.done == 0 && result.rejected > 0) outcome.shortfall = "no point could be done";
  outcome.page = [result, summary = outcome.summary] { return page_of(result, summary); };
  for (const std::string& note : result.study.notes) outcome.summary += printable(note) + "\n";
  return outcome;
}

}  // namespace

Verb sweep_verb() {
  return {
      .name = "sweep",
      .purpose = "a job done for many values of its document's keys",
      .more =
          "Grids, lists, tables and samples; in chunks that survive a kill: the same command goes on. The folder has "
          "results.csv and results.h5 when all points are done.",
      .example = "sweep study.toml -o study/",
      .readme = "robomill/jobs/README.md",
      .input = file_option("study", "study.toml: a job, its document, what varies and what is kept", {"study"}, true),
      .options = {{.name = "shard", .meaning = "do each n-th chunk from the i-th on: i/n", .takes = Takes::text},
                  {.name = "status", .meaning = "how far the folder is; nothing is done", .excludes = "slurm"},
                  flag_option("dry_run", "one point, and what all would take; nothing is written"),
                  {.name = "slurm",
                   .meaning = "submit the shards as a job array of Slurm, by [slurm] of the study; with --dry-run only "
                              "show its scripts",
                   .excludes = "shard"},
                  {.name = "merge",
                   .meaning = "write the points into this table, .h5 or .csv; no chunk is done",
                   .takes = Takes::new_file,
                   .excludes = "slurm"}},
      .run = &run_sweep_verb};
}

}  // namespace robomill::jobs
