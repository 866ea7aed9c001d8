#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "robomill/jobs/sweep/study.hpp"

// Method: robomill/jobs/README.md, "Clusters"

namespace robomill::jobs {

/// What the scripts of a study name; whole paths, which all machines of the cluster see.
struct SlurmPlaces {
  std::string program = {};  ///< robomill: a path, or a name on PATH
  std::filesystem::path study = {}, folder = {};
};

struct SlurmScripts {
  std::string array = {}, merge = {};
};

/// The scripts of a study: a job array of its shards, and the job that writes its tables after them.
/// @param shards  tasks, >= 1
/// @throws InvalidInput naming the folder if a line of such a script cannot name it
[[nodiscard]] SlurmScripts slurm_scripts(const SlurmSettings& settings, const SlurmPlaces& places, int shards);

/// A text as one word of a shell.
[[nodiscard]] std::string shell_word(std::string_view text);

/// The states of a job array's tasks, by their numbers, in Slurm's words: "RUNNING", "OUT_OF_MEMORY".
using SlurmStates = std::map<int, std::string>;

/// @param text  of squeue --array --format=%K|%T; what is no such line is left out
[[nodiscard]] SlurmStates states_of_squeue(std::string_view text);
/// @param text  of sacct --parsable2 --format=JobID,State: 12_3|RUNNING, 12_[4-6,9%2]|PENDING, 12_7|CANCELLED by 0
[[nodiscard]] SlurmStates states_of_sacct(std::string_view text);

/// What became of a task, or what it does.
enum class TaskState {
  done,  ///< all its chunks are there
  running,
  waiting,  ///< in the queue
  failed,   ///< ended without some of its chunks
  idle      ///< no job has it: never submitted, or ended too long ago for Slurm to know
};
/// @param state  Slurm's word, of a task whose chunks are not all there
[[nodiscard]] TaskState task_state(std::string_view state);

}  // namespace robomill::jobs
