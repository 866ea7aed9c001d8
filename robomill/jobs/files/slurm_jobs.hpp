#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "robomill/io/schema.hpp"
#include "robomill/jobs/sweep/slurm.hpp"

// Method: robomill/jobs/README.md, "Clusters"

namespace robomill::jobs {

/// slurm/jobs.json: the jobs of a study that were submitted last.
struct SlurmJobs {
  std::string array = {}, merge = {};  ///< their numbers; merge is empty where it could not be submitted
  int shards = 0;                      ///< tasks of the array
};
[[nodiscard]] const io::Schema<SlurmJobs>& slurm_jobs_table();

/// The folder slurm in that of a study: its scripts, their outputs, the numbers of its jobs.
class SlurmFolder {
 public:
  explicit SlurmFolder(const std::filesystem::path& study_folder) : folder_(study_folder / "slurm") {}

  /// None where none were submitted. @throws InvalidInput if jobs.json is damaged
  [[nodiscard]] std::optional<SlurmJobs> jobs() const;
  /// Writes the scripts and submits them, the second to run after the first.
  /// @throws InvalidInput with what sbatch said if it is not there, or rejects one
  [[nodiscard]] SlurmJobs submit(const SlurmScripts& scripts, int shards) const;

  /// What squeue, or else sacct, says of a job's tasks; empty where neither knows any.
  [[nodiscard]] static SlurmStates states(const std::string& array);
  /// The same of a job without tasks; empty where neither knows it.
  [[nodiscard]] static std::string state(const std::string& job);

  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

/// The program that the scripts start: the one that the variable ROBOMILL names, else this one, else robomill of PATH.
[[nodiscard]] std::string slurm_program();

}  // namespace robomill::jobs
