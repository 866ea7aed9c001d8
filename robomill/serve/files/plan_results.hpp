#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"

// Method: robomill/serve/README.md, "Overview"

namespace robomill::serve {

/// What the plan of a job came to, stage by stage in words. A stage that it has not is empty.
struct PlanResults {
  std::filesystem::path folder = {};
  std::filesystem::file_time_type made = {};
  std::optional<InvalidInput> error = {};  ///< why its plan.json cannot be read
  std::string hits = {}, frfs = {}, modes = {}, lobes = {}, program = {}, decision = {};
  bool modes_usable = true;  ///< they describe the FRFs
  bool decided = true;       ///< conditions or a recommendation within every limit
};

/// The folder with the newest plan.json of a job: among the folders that its runs wrote to, and the folders beside it.
/// Where other jobs are beside it too, only folders whose names begin with the job's; of job.toml also out and plan.
/// Empty: there is none.
/// @param written  folders of runs that have ended
[[nodiscard]] std::filesystem::path find_plan(const std::filesystem::path& job,
                                              const std::vector<std::filesystem::path>& written);

/// Reads plan.json files, and keeps what the last ones said until they change.
class PlanReader {
 public:
  /// @param folder  with a plan.json
  [[nodiscard]] const PlanResults& read(const std::filesystem::path& folder);

 private:
  static constexpr std::size_t most_kept = 32;
  std::map<std::filesystem::path, PlanResults> kept_ = {};
};

}  // namespace robomill::serve
