#include "robomill/serve/jobs/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/output_places.hpp"
#include "robomill/jobs/files/named_files.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/verbs.hpp"
#include "robomill/page/report.hpp"
#include "robomill/serve/files/folder.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;
using jobs::Takes;
using jobs::Verb;
using jobs::VerbOption;

/// Those that the page runs.
std::vector<const Verb*> served_verbs() {
  std::vector<const Verb*> out;
  for (const Verb& verb : jobs::verbs()) {
    if (!verb.button.empty()) out.push_back(&verb);
  }
  return out;
}

const Verb& verb_of(std::string_view name) {
  std::vector<std::string_view> names;
  for (const Verb* const verb : served_verbs()) {
    if (verb->name == name) return *verb;
    names.push_back(verb->name);
  }
  throw InvalidInput("verb", fmt::format("must be one of \"{}\"", fmt::join(names, "\", \"")));
}

/// A label begins with a capital, unless with the name of a file.
std::string label_of(const VerbOption& option) {
  std::string label(option.meaning);
  const bool file = label.substr(0, label.find(' ')).find(".toml") != std::string::npos;
  if (!file && label.front() >= 'a' && label.front() <= 'z') label.front() = static_cast<char>(label.front() - 32);
  return label;
}

/// An option for the page.
io::Json option_json(const VerbOption& option) {
  io::Json json = {{"name", option.name},
                   {"does", label_of(option)},
                   {"takes", name_in(jobs::takes_names, option.takes)},
                   {"required", option.required}};
  if (!option.words.empty()) json["words"] = option.words;
  if (!option.kinds.empty()) json["kinds"] = option.kinds;
  if (option.count != 0) json["count"] = option.count;
  return json;
}

std::vector<std::string> read_inputs(const io::Json& body) {
  constexpr std::size_t most_inputs = 64;
  const io::Json& input = body.at("input");
  if (input.is_string()) return {input.get<std::string>()};
  const bool paths =
      input.is_array() && !input.empty() && std::ranges::all_of(input, [](const auto& one) { return one.is_string(); });
  if (!paths) throw InvalidInput("input", "must be a path or a list of paths");
  if (input.size() > most_inputs) throw InvalidInput("input", fmt::format("must have {} paths at most", most_inputs));
  return input.get<std::vector<std::string>>();
}

/// What a request reads and writes, each as far as it says itself.
struct Places {
  std::vector<fs::path> read = {}, written = {};
};

Places places_of(const Verb& verb, const JobRequest& request, const ResolvePath& resolve) {
  Places out;
  const auto add = [&resolve](std::vector<fs::path>& list, const std::string& path) { list.push_back(resolve(path)); };
  for (const std::string& input : request.inputs) add(out.read, input);
  if (!request.output.empty()) add(out.written, request.output);
  for (const VerbOption& option : verb.options) {
    const auto given = request.options.find(option.name);
    if (given == request.options.end()) continue;
    if (option.takes == Takes::file) add(out.read, given->get<std::string>());
    const bool is_written = option.takes == Takes::new_file || option.takes == Takes::new_folder;
    if (is_written) add(out.written, given->get<std::string>());
    if (option.takes != Takes::files) continue;
    for (const io::Json& one : *given) add(out.read, one.get<std::string>());
  }
  return out;
}

/// Before the work, of what can be known then; while it runs, run_verb asks the same of every file.
void require_places_apart(const Places& places) {
  const io::OutputPlaces outputs(places.written);
  for (const fs::path& document : places.read) {
    io::require_no_output(document);
    for (const fs::path& file : jobs::files_named_in(document)) io::require_no_output(file);
  }
}

}  // namespace

JobRequest read_job_request(const io::Json& body, const ResolvePath& resolve) {
  JobRequest request;
  request.verb = body.value("verb", request.verb);
  const Verb& verb = verb_of(request.verb);
  request.inputs = read_inputs(body);
  if (request.inputs.size() > 1 && verb.input.takes != Takes::files) {
    throw InvalidInput("input", fmt::format("{} takes one file", request.verb));
  }
  request.output = body.value("output", "");
  const auto require_inside = [&resolve](const std::string& path) { static_cast<void>(resolve(path)); };
  for (const std::string& input : request.inputs) require_inside(input);
  if (!request.output.empty()) {
    require_inside(request.output);
    if (verb.document) jobs::require_output(*verb.document, request.output);
  }
  request.options = jobs::checked_options(verb, jobs::AskedBy::request, request.inputs.front(),
                                          body.value("options", io::Json::object()), require_inside);
  require_places_apart(places_of(verb, request, resolve));
  return request;
}

JobOutcome run_verb(const JobRequest& request, const fs::path& root, Progress& progress) {
  require_folder(root);
  const Verb& verb = verb_of(request.verb);
  const auto in_root = [&root](const std::string& path) { return root / path; };
  jobs::VerbJob job = {.verb = verb, .options = request.options, .root = root, .wants_curves = true};
  std::ranges::transform(request.inputs, std::back_inserter(job.inputs), in_root);
  if (!request.output.empty()) job.output = in_root(request.output);
  const io::OutputPlaces outputs(places_of(verb, request, in_root).written);
  if (!request.output.empty()) io::make_folder(job.output.parent_path());
  jobs::Outcome outcome = verb.run(job, progress);
  return {.shortfall = std::move(outcome.shortfall),
          .summary = std::move(outcome.summary),
          .report = page::report_json(outcome.page()),
          .plan = std::move(outcome.plan)};
}

io::Json verbs_json() {
  io::Json list = io::Json::array();
  for (const Verb* const verb : served_verbs()) {
    io::Json options = io::Json::array();
    for (const VerbOption& option : verb->options) options.push_back(option_json(option));
    list.push_back({{"verb", verb->name},
                    {"does", verb->button},
                    {"inputs", verb->input.kinds},
                    {"several", verb->input.takes == Takes::files},
                    {"output", verb->output},
                    {"options", std::move(options)}});
  }
  return list;
}

}  // namespace robomill::serve
