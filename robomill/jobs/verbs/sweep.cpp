#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <string>

#include "robomill/base/printable.hpp"
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

std::string summary_of(const SweepJob& job, const SweepResult& result) {
  std::string out;
  if (job.dry_run) {
    out = fmt::format("{}{} points. The one in the middle took {:.3g} s of one thread: {:.3g} h in all.\n",
                      result.study.boundary ? "At most " : "", result.points, result.point_s,
                      result.point_s * static_cast<double>(result.points) / 3600.0);
  } else {
    out = fmt::format("{} points in {} chunks of {}: {} chunks are done, {} by this run.\n", result.points,
                      result.chunks, result.chunk_points, result.done_chunks, result.ran_chunks) +
          points_text(result);
    if (result.point_s > 0.0) out += fmt::format("A point takes {:.3g} s of one thread.\n", result.point_s);
  }
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

Outcome run_sweep_verb(const VerbJob& job, Progress& progress) {
  SweepJob wanted = {.study = job.input(),
                     .folder = job.output,
                     .merge = job.file("merge"),
                     .dry_run = job.flag("dry_run"),
                     .status = job.flag("status")};
  if (job.has("shard")) read_shard(job, wanted);
  if (wanted.folder.empty() && !wanted.dry_run) {
    throw InvalidInput(job.named("output"), "is missing", "Give the folder of the study: -o study/");
  }
  const SweepResult result = run_sweep(wanted, progress);
  Outcome outcome = {.summary = summary_of(wanted, result)};
  if (result.done == 0 && result.rejected > 0) outcome.shortfall = "no point could be done";
  outcome.page = [notes = result.study.notes, summary = outcome.summary] {
    page::Report page;
    page.title = "Study";
    page.notes = notes;
    page.summary = summary;
    return page;
  };
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
                  flag_option("status", "how far the folder is; nothing is done"),
                  flag_option("dry_run", "one point, and what all would take; nothing is written"),
                  {.name = "merge",
                   .meaning = "write the points into this table, .h5 or .csv, once all are done",
                   .takes = Takes::new_file}},
      .run = &run_sweep_verb};
}

}  // namespace robomill::jobs
