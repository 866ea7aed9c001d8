#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/files/job_parts.hpp"
#include "robomill/serve/files/plan_results.hpp"
#include "robomill/serve/http/server.hpp"

// Method: robomill/serve/README.md, "Overview"

namespace robomill::serve {

/// The stages of a job, in the order of the data.
enum class StageName { hits, frfs, modes, cut, lobes, robot, program, decision, monitor };
inline constexpr Name<StageName> stage_names[] = {
    {"hits", StageName::hits},       {"frfs", StageName::frfs},         {"modes", StageName::modes},
    {"cut", StageName::cut},         {"lobes", StageName::lobes},       {"robot", StageName::robot},
    {"program", StageName::program}, {"decision", StageName::decision}, {"monitor", StageName::monitor}};

enum class StageState {
  given,      ///< by documents that can be read
  guessed,    ///< given, but some values are samples or guesses
  missing,    ///< a file or a key
  wrong,      ///< a document cannot be read
  ready,      ///< to be computed
  waiting,    ///< to be computed once what it needs is there
  done,       ///< computed
  unreached,  ///< computed, without the answer
  outdated,   ///< computed of other inputs than those that are there
  unused      ///< no part of this job
};
inline constexpr Name<StageState> stage_states[] = {
    {"given", StageState::given},  {"guessed", StageState::guessed},     {"missing", StageState::missing},
    {"wrong", StageState::wrong},  {"ready", StageState::ready},         {"waiting", StageState::waiting},
    {"done", StageState::done},    {"unreached", StageState::unreached}, {"outdated", StageState::outdated},
    {"unused", StageState::unused}};

/// What to do next about a stage.
enum class StageStep { none, edit, add, run, tap, lobes, program, report, monitor };
inline constexpr Name<StageStep> stage_steps[] = {
    {"none", StageStep::none},       {"edit", StageStep::edit},     {"add", StageStep::add},
    {"run", StageStep::run},         {"tap", StageStep::tap},       {"lobes", StageStep::lobes},
    {"program", StageStep::program}, {"report", StageStep::report}, {"monitor", StageStep::monitor}};

/// An input that is newer than what was computed of it.
struct NewerInput {
  std::filesystem::path file = {};
  std::filesystem::file_time_type time = {};
};

struct Stage {
  StageName name = StageName::hits;
  StageState state = StageState::unused;
  std::string says = {};                   ///< its number, or what it waits for; empty: none
  std::filesystem::path file = {};         ///< the document that gives it; empty: none
  std::optional<InvalidInput> error = {};  ///< of missing and wrong
  std::optional<NewerInput> newer = {};    ///< of outdated: the newest
  std::size_t guesses = 0;                 ///< values
  int line = 0;                            ///< of the first guess
  StageStep next = StageStep::none;
};

struct Overview {
  std::filesystem::path job = {};
  std::string title = {};
  std::optional<InvalidInput> error = {};  ///< of the job's document as a whole
  std::filesystem::path results = {};      ///< the folder of its plan; empty: none
  std::vector<std::string> names = {};     ///< keys of [job]
  std::vector<Stage> stages = {};          ///< all, in their order
  std::optional<std::size_t> next = {};    ///< the stage to go on with; none: nothing is left to do
};

/// How a job is. No document is run: what was computed is read from its plan.json.
/// @param written  folders of runs of this job that have ended
/// @param plans    keeps what it reads
[[nodiscard]] Overview overview_of(const std::filesystem::path& job, const std::vector<std::filesystem::path>& written,
                                   PlanReader& plans);

/// The same for the page; paths are those below root.
[[nodiscard]] io::Json overview_object(const Overview& overview, const std::filesystem::path& root);

/// GET /api/overview.
/// @param body  {"file", "written": outputs of its runs that have ended}
/// @throws InvalidInput if a path leads out of the folder, io::Json::exception if the body is none
[[nodiscard]] HttpResponse answer_overview(const Folder& folder, PlanReader& plans, const std::string& body);

}  // namespace robomill::serve
