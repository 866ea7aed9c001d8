#include "robomill/serve/overview/overview.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/io/system/confinement.hpp"
#include "robomill/jobs/files/named_files.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/folder.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;
using State = StageState;
using Step = StageStep;

bool is_blocking(const Stage& stage) {
  return stage.state == State::missing || stage.state == State::wrong;
}

/// Rules about what is not there.
bool is_missing(const InvalidInput& error) {
  const std::string& rule = error.parts().rule;
  return rule.starts_with("is missing") || rule.starts_with("must name") || rule.starts_with("goes with");
}

/// The newest of some files that is newer than what was computed of them.
std::optional<NewerInput> newer_of(const std::vector<fs::path>& files, fs::file_time_type made) {
  std::optional<NewerInput> out;
  for (const fs::path& file : files) {
    try {
      io::require_inside(file);
    } catch (const InvalidInput&) {
      continue;  // the part that names it says so
    }
    std::error_code error;
    const fs::file_time_type time = fs::last_write_time(file, error);
    if (!error && time > made && (!out || time > out->time)) out = {.file = file, .time = time};
  }
  return out;
}

/// A document with the files that it names.
std::vector<fs::path> with_named(const fs::path& document) {
  if (document.empty()) return {};
  std::vector<fs::path> out = jobs::files_named_in(document);
  out.push_back(document);
  return out;
}

class Making {
 public:
  Making(const fs::path& job, JobParts parts, const PlanResults* results)
      : parts_(std::move(parts)), results_(results) {
    out_.job = job;
    out_.title = std::move(parts_.title);
    out_.error = std::move(parts_.error);
    out_.names = std::move(parts_.names);
    if (results_ == nullptr) return;
    out_.results = results_->folder;
    if (results_->error) results_ = nullptr;
  }

  Overview make(const PlanResults* read) {
    if (out_.error && out_.names.empty()) return unknown();
    find_newer();
    add_structure();
    add_cut();
    add_program();
    add_monitor();
    if (read != nullptr && read->error) put_unread(*read->error);
    out_.next = next();
    return std::move(out_);
  }

 private:
  /// Nothing is known before the job can be read.
  Overview unknown() {
    for (const auto& [text, name] : stage_names) {
      out_.stages.push_back({.name = name, .state = State::waiting, .says = "needs " + out_.job.filename().string()});
    }
    return std::move(out_);
  }
  void find_newer() {
    if (results_ == nullptr) return;
    try {
      std::vector<fs::path> files = with_named(parts_.hits.file);
      if (parts_.predicted) std::ranges::copy(with_named(parts_.frfs.file), std::back_inserter(files));
      std::ranges::copy(parts_.frf_files, std::back_inserter(files));
      of_hits_ = newer_of(files, results_->made);
      files.push_back(parts_.modes.file);
      files.push_back(out_.job);
      of_modes_ = newer_of(files, results_->made);
      if (parts_.cut.file != out_.job) {
        std::ranges::copy(with_named(parts_.cut.file), std::back_inserter(files));
      }
      of_lobes_ = newer_of(files, results_->made);
      of_all_ = newer_of(with_named(out_.job), results_->made);
    } catch (const InvalidInput& error) {  // more files than can be followed
      if (!out_.error) out_.error = error;
    }
  }

  /// As its documents say.
  [[nodiscard]] static Stage given(StageName name, const JobPart& part, Step next) {
    Stage out{.name = name, .says = part.says, .file = part.file, .error = part.error};
    if (part.error) {
      out.state = is_missing(*part.error) ? State::missing : State::wrong;
      out.next = part.error->parts().rule == no_such_file ? Step::add : Step::edit;
    } else if (!part.file.empty()) {
      out.state = State::given;
      out.next = next;
      add_guesses(out, part);
    }
    return out;
  }
  static void add_guesses(Stage& stage, const JobPart& part) {
    if (part.guesses.empty()) return;
    stage.state = State::guessed;
    stage.file = part.file;
    stage.guesses = part.guesses.size();
    stage.line = part.guesses.front().line;
    stage.next = Step::edit;
  }
  /// With what was computed of it.
  static void add_result(Stage& stage, const std::string& says, const std::optional<NewerInput>& newer) {
    if (says.empty() || is_blocking(stage) || stage.state == State::unused) return;
    stage.says = says;
    if (newer) {
      stage.state = State::outdated;
      stage.newer = newer;
      stage.next = Step::run;
    } else if (stage.state == State::given) {
      stage.state = State::done;
    }
  }
  /// What a run computes.
  [[nodiscard]] Stage computed(StageName name, const std::string& says, const std::optional<NewerInput>& newer,
                               bool reached, Step next) const {
    Stage out{.name = name};
    std::string needs;
    if (out_.error) needs = out_.job.filename().string();
    for (const Stage& stage : out_.stages) {
      if (is_blocking(stage)) needs += (needs.empty() ? "" : ", ") + std::string(name_in(stage_names, stage.name));
    }
    if (says.empty()) {
      out.state = needs.empty() ? State::ready : State::waiting;
      if (needs.empty()) {
        out.next = Step::run;
      } else {
        out.says = "needs " + needs;
      }
      return out;
    }
    out.says = says;
    out.state = newer ? State::outdated : reached ? State::done : State::unreached;
    out.newer = newer;
    out.next = !newer ? next : needs.empty() ? Step::run : Step::none;
    return out;
  }
  [[nodiscard]] std::string said(std::string PlanResults::*what) const {
    return results_ == nullptr ? std::string() : results_->*what;
  }

  void add_structure() {
    Stage hits = given(StageName::hits, parts_.hits, Step::tap);
    add_result(hits, said(&PlanResults::hits), of_hits_);
    out_.stages.push_back(std::move(hits));

    const bool measured = !parts_.hits.file.empty();
    Stage frfs = given(StageName::frfs, parts_.frfs, Step::edit);
    if (parts_.frfs.file.empty() && measured) {
      frfs = computed(StageName::frfs, said(&PlanResults::frfs), of_hits_, true, Step::none);
    } else if (parts_.predicted) {
      add_result(frfs, said(&PlanResults::frfs), of_hits_);
    } else if (!is_blocking(frfs)) {
      frfs.next = Step::none;
    }
    out_.stages.push_back(std::move(frfs));

    Stage modes = given(StageName::modes, parts_.modes, Step::none);
    const bool fitted = parts_.modes.file.empty() && (measured || !parts_.frfs.file.empty());
    if (fitted && !parts_.modes.error) {
      modes = computed(StageName::modes, said(&PlanResults::modes), of_modes_,
                       results_ == nullptr || results_->modes_usable, Step::report);
    }
    out_.stages.push_back(std::move(modes));
  }
  void add_cut() {
    out_.stages.push_back(given(StageName::cut, parts_.cut, parts_.recommends ? Step::lobes : Step::edit));
    Stage lobes{.name = StageName::lobes};
    if (parts_.recommends) lobes = computed(StageName::lobes, said(&PlanResults::lobes), of_lobes_, true, Step::lobes);
    out_.stages.push_back(std::move(lobes));
  }
  void add_program() {
    out_.stages.push_back(given(StageName::robot, parts_.robot, Step::edit));
    Stage program = given(StageName::program, parts_.program, Step::run);
    if (!said(&PlanResults::program).empty()) {
      if (program.state == State::given) program.next = Step::program;
      add_result(program, said(&PlanResults::program), of_all_);
    }
    out_.stages.push_back(std::move(program));

    Stage decision = given(StageName::decision, {.file = {}, .error = parts_.limits.error}, Step::none);
    if (!parts_.limits.error && (parts_.recommends || parts_.decides)) {
      const bool decided = results_ == nullptr || results_->decided;
      decision = computed(StageName::decision, said(&PlanResults::decision), of_all_, decided,
                          parts_.decides ? Step::program : Step::report);
      if (decision.state == State::done) add_guesses(decision, parts_.limits);
    }
    out_.stages.push_back(std::move(decision));
  }
  void add_monitor() {
    Stage monitor = given(StageName::monitor, parts_.monitor, Step::monitor);
    const bool planned = !out_.results.empty() && monitor.file.parent_path() == out_.results;
    if (planned && of_all_) add_result(monitor, monitor.says, of_all_);
    out_.stages.push_back(std::move(monitor));
  }
  /// Results that cannot be read are the decision's, or the program's where nothing is decided.
  void put_unread(const InvalidInput& error) {
    const auto is_of = [](const Stage& stage) {
      return stage.name == StageName::decision && stage.state != State::unused;
    };
    auto found = std::ranges::find_if(out_.stages, is_of);
    if (found == out_.stages.end()) found = std::ranges::find(out_.stages, StageName::program, &Stage::name);
    if (is_blocking(*found)) return;
    found->error = error;
    found->state = State::wrong;
    found->next = Step::run;
  }
  /// What stops the job, then what is to be computed, then what to check.
  [[nodiscard]] std::optional<std::size_t> next() const {
    constexpr std::array order = {State::missing, State::wrong,     State::outdated,
                                  State::ready,   State::unreached, State::guessed};
    for (const State state : order) {
      const auto found = std::ranges::find_if(
          out_.stages, [state](const Stage& stage) { return stage.state == state && stage.next != Step::none; });
      if (found != out_.stages.end()) return static_cast<std::size_t>(found - out_.stages.begin());
    }
    return std::nullopt;
  }

  JobParts parts_;
  const PlanResults* results_;
  Overview out_;
  std::optional<NewerInput> of_hits_, of_modes_, of_lobes_, of_all_;
};

io::Json path_below(const fs::path& path, const fs::path& root) {
  return path.empty() ? io::Json(nullptr) : io::Json(client_text(path.string(), root));
}

io::Json stage_object(const Stage& stage, const fs::path& root) {
  io::Json out = {{"stage", name_in(stage_names, stage.name)},
                  {"state", name_in(stage_states, stage.state)},
                  {"says", client_text(stage.says, root)},
                  {"file", path_below(stage.file, root)},
                  {"guesses", stage.guesses},
                  {"error", stage.error ? error_object(*stage.error, root) : io::Json(nullptr)},
                  {"newer", nullptr},
                  {"next", nullptr}};
  if (stage.newer)
    out["newer"] = {{"file", path_below(stage.newer->file, root)}, {"since", time_text(stage.newer->time)}};
  if (stage.next == Step::none) return out;
  io::Json file = out["file"], line = stage.line > 0 ? io::Json(stage.line) : io::Json(nullptr);
  if (stage.error && stage.next == Step::edit && !out["error"]["file"].is_null()) {
    file = out["error"]["file"];
    line = out["error"]["line"];
  }
  if (stage.next == Step::add) file = out["error"]["value"];
  out["next"] = {{"does", name_in(stage_steps, stage.next)}, {"file", std::move(file)}, {"line", std::move(line)}};
  return out;
}

}  // namespace

Overview overview_of(const fs::path& job, const std::vector<fs::path>& written, PlanReader& plans) {
  const fs::path folder = find_plan(job, written);
  const PlanResults* const results = folder.empty() ? nullptr : &plans.read(folder);
  return Making(job, read_job_parts(job, folder), results).make(results);
}

io::Json overview_object(const Overview& overview, const fs::path& root) {
  io::Json stages = io::Json::array();
  for (const Stage& stage : overview.stages) stages.push_back(stage_object(stage, root));
  return {{"file", path_below(overview.job, root)},
          {"title", client_text(overview.title, root)},
          {"error", overview.error ? error_object(*overview.error, root) : io::Json(nullptr)},
          {"results", path_below(overview.results, root)},
          {"names", overview.names},
          {"stages", std::move(stages)},
          {"next",
           overview.next ? io::Json(name_in(stage_names, overview.stages[*overview.next].name)) : io::Json(nullptr)}};
}

HttpResponse answer_overview(const Folder& folder, PlanReader& plans, const std::string& body) {
  const io::Json asked = io::parse_json(body, "request");
  const fs::path job = folder.resolve(asked.at("file").get<std::string>());
  std::error_code ignored;
  if (!fs::exists(job, ignored)) return error_response(404, "there is no such file");
  std::vector<fs::path> written;
  for (const io::Json& output : asked.at("written")) written.push_back(folder.resolve(output.get<std::string>()));
  return json_response(overview_object(overview_of(job, written, plans), folder.root()));
}

}  // namespace robomill::serve
