#include "robomill/serve/jobs/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/output_places.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/path/options.hpp"
#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/files/named_files.hpp"
#include "robomill/serve/jobs/verb_options.hpp"
#include "robomill/serve/jobs/verb_runs.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;
using jobs::Document;

struct Verb {
  std::string_view name;                  ///< as on the command line, with the option that makes it another
  std::string_view does;                  ///< on a button
  std::vector<std::string_view> inputs;   ///< kinds of files
  bool several = false;                   ///< of them
  std::string_view output;                ///< a name for it
  std::optional<Document> document = {};  ///< none: a folder, or what the job itself knows the endings of
  JobOutcome (*run)(const VerbJob&, Progress&);
  std::vector<VerbOption> options;
};

const VerbOption seed_option = {
    .name = "seed", .does = "Seed of random numbers (1)", .takes = Takes::whole, .at_least = 0};
const VerbOption as_option = {
    .name = "as", .does = "Names of headerless FRFs, one a file: xx, yy", .takes = Takes::texts};

VerbOption flag_option(std::string_view name, std::string_view does) {
  return {.name = name, .does = does};
}
VerbOption file_option(std::string_view name, std::string_view does, std::vector<std::string_view> kinds,
                       bool required = false) {
  return {.name = name, .does = does, .takes = Takes::file, .required = required, .kinds = std::move(kinds)};
}

const std::vector<VerbOption> modes_options = {
    {.name = "method", .does = "Method (hybrid)", .takes = Takes::word, .words = words_of(modal::fit_method_names)},
    {.name = "band_hz", .does = "Band: low, high (Hz)", .takes = Takes::numbers, .count = 2},
    {.name = "modes", .does = "Exactly this many modes", .takes = Takes::whole, .at_least = 1, .at_most = 1000},
    as_option,
    file_option("config", "Every option of the fit", {"fit"}),
    flag_option("accept_fit", "Take modes that do not describe the FRFs"),
    seed_option};

const std::vector<VerbOption> joint_options = {
    {.name = "measured",
     .does = "FRFs measured at the tip",
     .takes = Takes::files,
     .required = true,
     .kinds = {"frf", "record"}},
    {.name = "method",
     .does = "Method (hybrid)",
     .takes = Takes::word,
     .words = words_of(coupling::joint_method_names)},
    {.name = "axis", .does = "Which FRF is fitted: xx or yy (x)", .takes = Takes::word, .words = {"x", "y"}},
    {.name = "mutation",
     .does = "Mutation of ga (the assembly's)",
     .takes = Takes::word,
     .words = words_of(coupling::mutation_names)},
    as_option,
    seed_option};

const std::vector<VerbOption> simulate_options = {
    {.name = "at", .does = "Spindle speed (rpm), axial depth (mm)", .takes = Takes::point, .required = true},
    {.name = "seconds", .does = "How long to cut (2 s)", .takes = Takes::number, .above = 0},
    {.name = "sample_rate_hz", .does = "Sample rate of the output (10240 Hz)", .takes = Takes::number, .above = 0},
    flag_option("linear", "Without loss of contact, as lobes take the cut"),
    seed_option};

const std::vector<VerbOption> explain_options = {
    {.name = "peaks_hz", .does = "Frequencies of the peaks (Hz)", .takes = Takes::numbers, .required = true},
    {.name = "rpm",
     .does = "Spindle speed (rpm)",
     .takes = Takes::number,
     .required = true,
     .above = 0,
     .at_most = 1e6},
    {.name = "teeth",
     .does = "Teeth of the cutter",
     .takes = Takes::whole,
     .required = true,
     .at_least = 1,
     .at_most = 1000},
    {.name = "tolerance_hz",
     .does = "How far a peak may lie from its cause (1 Hz)",
     .takes = Takes::number,
     .above = 0},
    {.name = "speed_tolerance_percent",
     .does = "By how much the true speed may differ (0.2 %)",
     .takes = Takes::number,
     .at_least = 0,
     .at_most = 5},
    file_option("lobes", "lobes.toml of the cut: is its chatter regenerative?", {"lobes"}),
    {.name = "at", .does = "Spindle speed (rpm), axial depth (mm) of the cut", .takes = Takes::point}};

const std::vector<VerbOption> smooth_options = {
    file_option("cell", "Cell: the robot, its joints' limits", {"cell"}, true),
    {.name = "method", .does = "Method (the cell's)", .takes = Takes::word, .words = words_of(path::method_names)},
    flag_option("compare", "All other methods beside it"),
    flag_option("keep_violations", "Write the trajectory even where it breaks a limit"),
    {.name = "program_period_ms",
     .does = "Longest time between points of a joint program (ms)",
     .takes = Takes::number,
     .above = 0}};

const Verb plan_verb = {
    .name = "plan",
    .does = "Run the job",
    .inputs = {"job"},
    .output = "out",
    .run = &run_plan,
    .options = {flag_option("accept_fit", "Go on with modes that do not describe the FRFs"), seed_option}};

const Verb frf_verb = {.name = "frf",
                       .does = "Estimate FRFs",
                       .inputs = {"hits"},
                       .output = "tip.uff",
                       .document = Document::frfs,
                       .run = &run_frf,
                       .options = {flag_option("binary", "Write .uff as data set 58b")}};

const Verb modes_verb = {.name = "modes",
                         .does = "Fit modes",
                         .inputs = {"frf", "record"},
                         .several = true,
                         .output = "modes.json",
                         .document = Document::modes,
                         .run = &run_modes,
                         .options = modes_options};

const Verb couple_verb = {
    .name = "couple",
    .does = "Predict the tip's FRFs",
    .inputs = {"assembly"},
    .output = "tip.uff",
    .document = Document::frfs,
    .run = &run_couple,
    .options = {flag_option("rotations", "Also rotations and moments at the tip"),
                {.name = "holder_out", .does = "Keep the measured holder's receptances in", .takes = Takes::new_file}}};

const Verb tools_verb = {
    .name = "couple --tools",
    .does = "Compare a list of tools",
    .inputs = {"assembly"},
    .output = "tools.json",
    .document = Document::tools,
    .run = &run_tools,
    .options = {file_option("tools", "The list of tools", {"tools"}, true),
                file_option("lobes", "The cut that each is to make", {"lobes"}),
                {.name = "frfs", .does = "Folder for the FRFs at each tip", .takes = Takes::new_folder},
                seed_option}};

const Verb joint_verb = {.name = "joint",
                         .does = "Find the joint",
                         .inputs = {"assembly"},
                         .output = "joint.json",
                         .document = Document::joint,
                         .run = &run_joint,
                         .options = joint_options};

const Verb lobes_verb = {
    .name = "lobes",
    .does = "Compute lobes",
    .inputs = {"lobes"},
    .output = "lobes.json",
    .document = Document::lobes,
    .run = &run_lobes,
    .options = {{.name = "at", .does = "Points: spindle speed (rpm), depth (mm or °); …", .takes = Takes::points},
                flag_option("compare", "The limits by every method"),
                seed_option}};

const Verb simulate_verb = {.name = "simulate",
                            .does = "Simulate the cut",
                            .inputs = {"lobes"},
                            .output = "vibration.csv",
                            .document = Document::simulation,
                            .run = &run_simulate,
                            .options = simulate_options};

const Verb explain_verb = {.name = "explain",
                           .does = "Explain measured peaks",
                           .inputs = {"modes"},
                           .output = "explain.json",
                           .document = Document::explanation,
                           .run = &run_explain,
                           .options = explain_options};

const Verb forces_verb = {.name = "forces",
                          .does = "Compute forces",
                          .inputs = {"forces"},
                          .output = "forces.csv",
                          .document = Document::forces,
                          .run = &run_forces,
                          .options = {file_option("program", "Along a program", {"program"}),
                                      file_option("cell", "Cell: the robot that the cut bends", {"cell"})}};

const Verb coefficients_verb = {
    .name = "coefficients",
    .does = "Identify coefficients",
    .inputs = {"slots"},
    .output = "coefficients.toml",
    .document = Document::coefficients,
    .run = &run_coefficients,
    .options = {
        {.name = "teeth", .does = "Teeth of the cutter (4)", .takes = Takes::whole, .at_least = 1, .at_most = 100}}};

const Verb stiffness_verb = {.name = "stiffness",
                             .does = "Identify joint stiffness",
                             .inputs = {"loads"},
                             .output = "stiffness.json",
                             .document = Document::stiffness,
                             .run = &run_stiffness,
                             .options = {file_option("cell", "Cell: the robot and its tool", {"cell"}, true),
                                         {.name = "point_mm",
                                          .does = "Where the load attacks, in the flange frame: x, y, z (mm)",
                                          .takes = Takes::numbers,
                                          .count = 3}}};

const Verb cell_check_verb = {.name = "cell check",
                              .does = "Check the cell",
                              .inputs = {"cell"},
                              .output = "check.json",
                              .document = Document::cell_check,
                              .run = &run_cell_check,
                              .options = {file_option("program", "A program that the tool must follow", {"program"}),
                                          {.name = "joints",
                                           .does = "Show this position too: q1, q2, … (°, mm where joints slide)",
                                           .takes = Takes::numbers}}};

const Verb posture_modes_verb = {
    .name = "modes --cell",
    .does = "Predict a posture's modes",
    .inputs = {"cell"},
    .output = "modes.json",
    .document = Document::modes,
    .run = &run_posture_modes,
    .options = {{.name = "joints_deg", .does = "Joints of the posture (°)", .takes = Takes::numbers, .required = true},
                {.name = "axes",
                 .does = "Axes that the modes are written in (base)",
                 .takes = Takes::word,
                 .words = words_of(cell::posture_axes_names)}}};

const Verb smooth_verb = {.name = "smooth",
                          .does = "Smooth the program",
                          .inputs = {"program"},
                          .output = "trajectory.csv",
                          .run = &run_smooth,
                          .options = smooth_options};

/// In the order of the page's buttons.
const std::vector<Verb>& verbs() {
  static const std::vector<Verb> table = {plan_verb,       frf_verb,           modes_verb,        couple_verb,
                                          tools_verb,      joint_verb,         lobes_verb,        simulate_verb,
                                          explain_verb,    forces_verb,        coefficients_verb, stiffness_verb,
                                          cell_check_verb, posture_modes_verb, smooth_verb};
  return table;
}

const Verb& verb_of(std::string_view name) {
  const auto found = std::ranges::find(verbs(), name, &Verb::name);
  if (found != verbs().end()) return *found;
  std::vector<std::string_view> names;
  for (const Verb& verb : verbs()) names.push_back(verb.name);
  throw InvalidInput("verb", fmt::format("must be one of \"{}\"", fmt::join(names, "\", \"")));
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
    for (const fs::path& file : files_named_in(document)) io::require_no_output(file);
  }
}

}  // namespace

JobRequest read_job_request(const io::Json& body, const ResolvePath& resolve) {
  JobRequest request;
  request.verb = body.value("verb", request.verb);
  const Verb& verb = verb_of(request.verb);
  request.inputs = read_inputs(body);
  if (request.inputs.size() > 1 && !verb.several) {
    throw InvalidInput("input", fmt::format("{} takes one file", request.verb));
  }
  request.output = body.value("output", "");
  const auto require_inside = [&resolve](const std::string& path) { static_cast<void>(resolve(path)); };
  for (const std::string& input : request.inputs) require_inside(input);
  if (!request.output.empty()) {
    require_inside(request.output);
    if (verb.document) jobs::require_output(*verb.document, request.output);
  }
  request.options =
      checked_options(request.verb, verb.options, body.value("options", io::Json::object()), require_inside);
  require_places_apart(places_of(verb, request, resolve));
  return request;
}

JobOutcome run_verb(const JobRequest& request, const fs::path& root, Progress& progress) {
  require_folder(root);
  const VerbJob job(request, root);
  const auto in_root = [&root](const std::string& path) { return root / path; };
  const Verb& verb = verb_of(request.verb);
  const io::OutputPlaces outputs(places_of(verb, request, in_root).written);
  if (!request.output.empty()) io::make_folder(job.output().parent_path());
  return verb.run(job, progress);
}

io::Json verbs_json() {
  io::Json list = io::Json::array();
  for (const Verb& verb : verbs()) {
    io::Json options = io::Json::array();
    for (const VerbOption& option : verb.options) options.push_back(option_json(option));
    list.push_back({{"verb", verb.name},
                    {"does", verb.does},
                    {"inputs", verb.inputs},
                    {"several", verb.several},
                    {"output", verb.output},
                    {"options", std::move(options)}});
  }
  return list;
}

}  // namespace robomill::serve
