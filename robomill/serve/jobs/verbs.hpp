#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/io/json.hpp"

// Method: robomill/serve/README.md, "Jobs"

namespace robomill::jobs {
struct PlanResult;
}

namespace robomill::serve {

/// What a client asked to run. Paths are below the folder that is served.
struct JobRequest {
  std::string verb = "plan";
  std::vector<std::string> inputs = {};
  std::string output = {};                ///< empty: nothing is written
  io::Json options = io::Json::object();  ///< of the verb, by name: only such as were checked
};

/// What a job came to.
struct JobOutcome {
  std::string shortfall = {};                         ///< why its answer was not reached; empty: it was
  std::string summary = {}, report = {};              ///< in lines of text; the data of its page
  std::shared_ptr<const jobs::PlanResult> plan = {};  ///< of a job whose program's blocks were judged
};

/// Where a path of a request's leads. Throws InvalidInput if that is out of the folder.
using ResolvePath = std::function<std::filesystem::path(const std::string&)>;

/// Reads {"verb", "input": a path or a list of them, "output", "options"}. That the files are there is not asked; those
/// that are, and what documents among them name, are not overwritten.
/// @throws InvalidInput naming the field if there is no such verb, a path is not allowed, an option is unknown, missing
///     or outside its range, the verb writes no file of the output's ending, or would write over what it reads
[[nodiscard]] JobRequest read_job_request(const io::Json& body, const ResolvePath& resolve);

/// Runs a request that was checked, and writes its output.
/// @param root  the folder that is served
/// @throws InvalidInput as the job; Interrupted
[[nodiscard]] JobOutcome run_verb(const JobRequest& request, const std::filesystem::path& root, Progress& progress);

/// Every verb for the page: "verb", "does" (on a button), "inputs" (kinds of files), "several" (inputs), "output" (a
/// name for it), "options" of "name", "does", "takes", "required", and where they have some "words", "kinds" (of
/// files), "count" (of numbers).
[[nodiscard]] io::Json verbs_json();

}  // namespace robomill::serve
