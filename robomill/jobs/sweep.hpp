#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/sweep/study.hpp"

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// study.toml and the folder that it is done in.
struct SweepJob {
  std::filesystem::path study = {};   ///< study.toml
  std::filesystem::path folder = {};  ///< is made; goes on where a run ended before
  /// This run does the chunks shard, shard + shards, …: 1 <= shard <= shards.
  int shard = 1, shards = 1;
  std::filesystem::path merge =
      {};                ///< a table of all points, .h5 or .csv, is written, and no chunk is done; empty: none
  bool dry_run = false;  ///< one point, and what all would take: nothing is written
  bool status = false;   ///< how far the folder is: nothing is done
  bool slurm = false;    ///< submits the shards to a Slurm cluster; with dry_run: its scripts alone
};

/// The jobs of a study on a cluster, and what became of the tasks of its array: each is a shard.
struct SweepTasks {
  std::string array = {}, merge = {};  ///< numbers of the jobs; empty: none was submitted
  std::string merge_state = {};        ///< in Slurm's words; empty: not known
  int tasks = 0;
  int done = 0, running = 0, waiting = 0;            ///< of them
  int failed = 0;                                    ///< that ended without all their chunks
  int idle = 0;                                      ///< that Slurm knows nothing of, and that are not done
  bool has_tables = false;                           ///< that the second job writes: results.csv is there
  std::vector<std::string> failures = {};            ///< the first ten, "7: OUT_OF_MEMORY"
  std::string array_script = {}, merge_script = {};  ///< of a dry run
};

/// How far a study is.
struct SweepResult {
  Study study = {};
  std::uint64_t points = 0, chunks = 0, chunk_points = 0;
  std::uint64_t done_chunks = 0, ran_chunks = 0;       ///< in the folder, of the run's shard alone; by this run
  std::uint64_t done = 0, short_of = 0, rejected = 0;  ///< points in the folder, by what became of them
  std::vector<std::uint64_t> damaged = {};             ///< chunks that were damaged, and are done again
  std::vector<std::string> reasons = {};               ///< of points that are not done: the first five, each once
  std::vector<std::string> processors = {};            ///< kinds that worked; of several the last bits may differ
  std::vector<std::string> absent = {};                ///< what is collected and no point has
  double point_s = 0.0;                                ///< that a point took here, of one thread [s]; 0: none was done
  /// What its boundary, its indices and its probabilities are, a line each; empty: it asks for none, or is not done.
  std::vector<std::string> findings = {};
  std::string statistics_json = {};  ///< the same as a document, "statistics/1"
  /// Points to look at, "study_points/1": all of them, or an even choice; empty: they are not all done.
  std::string study_points_json = {};
  double left_s =
      0.0;  ///< of the points that are not done, by the threads at work [s]; 0: nothing is left, or none is at work
  double left_thread_s = 0.0;             ///< … of one thread [s]; 0: nothing is left, or no point was done
  std::vector<std::string> running = {};  ///< shards that processes work at now, "3/16"
  SweepTasks tasks = {};
  std::vector<std::string> written = {};  ///< files

  [[nodiscard]] bool complete() const { return chunks > 0 && done_chunks == chunks; }
};

/// Does a study, chunk by chunk, each on all threads; what is there already stays. Results do not depend on threads,
/// shards or what was interrupted: the same bytes on one kind of processor.
/// With `merge` no chunk is done: the table is written of those that are there.
/// @throws InvalidInput with file, line, key and value; if the folder is of another study, another run has the same
///     chunks, a table is asked for before all chunks are done, or the cluster does not take the jobs
/// @throws Interrupted  when progress asks to stop: whole chunks stay
[[nodiscard]] ROBOMILL_API SweepResult run_sweep(const SweepJob& job, Progress& progress = Progress::none());

}  // namespace robomill::jobs
