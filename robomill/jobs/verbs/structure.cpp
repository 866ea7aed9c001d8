#include "robomill/coupling/joint_fit.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/jobs/verbs/records.hpp"
#include "robomill/modal/files/fit_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

VerbOption as_option() {
  return plain_option("as", "names of headerless FRFs, one a file: xx,yy", Takes::texts);
}

VerbOption assembly_input() {
  return file_option("assembly", "assembly.toml", {"assembly"}, true);
}

Outcome run_frf_verb(const VerbJob& job, Progress& progress) {
  return finished(job, run_frf(job.inputs, progress), modal::FrfWriteOptions{.binary_uff = job.flag("binary")});
}

Outcome run_modes_verb(const VerbJob& job, Progress& progress) {
  ModesJob wanted{.frfs = job.inputs, .as = job.texts("as"), .accept_fit = job.flag("accept_fit")};
  modal::FitOptions& options = wanted.options;
  if (job.has("config")) options = modal::read_fit_options(job.file("config"), wanted.notes);
  options.seed = job.seed();
  options.method = job.word("method", modal::fit_method_names).value_or(options.method);
  if (const std::vector<double> band = job.numbers("band_hz"); !band.empty()) {
    options.band_low_hz = band[0];
    options.band_high_hz = band[1];
  }
  options.modes = job.get("modes", options.modes);
  ModesResult result = run_modes(wanted, progress);
  const bool rejected = result.fit.status == modal::FitResult::Status::converged && !result.fit.usable();
  Outcome outcome = finished(job, std::move(result));
  if (rejected) outcome.shortfall += "; " + job.named("accept_fit") + " takes them all the same";
  return outcome;
}

Outcome run_couple_verb(const VerbJob& job, Progress& progress) {
  TipPrediction result = predict_tip(job.source(), {}, {.rotations = job.flag("rotations")}, progress);
  if (job.has("holder_out")) {
    require_holder(result, job.named("holder_out"));
    modal::write_frfs(job.file("holder_out"), result.holder);
  }
  return finished(job, std::move(result));
}

Outcome run_tools_verb(const VerbJob& job, Progress& progress) {
  ToolsResult result = run_tools(
      {.assembly = job.input(), .tools = job.file("tools"), .lobes = job.file("lobes"), .seed = job.seed()}, progress);
  if (job.has("frfs")) decision::write_tips(job.file("frfs"), result.tools);
  return finished(job, std::move(result));
}

Outcome run_joint_verb(const VerbJob& job, Progress& progress) {
  const JointJob wanted = {
      .assembly = job.input(),
      .measured = job.files("measured"),
      .as = job.texts("as"),
      .method = job.word("method", coupling::joint_method_names).value_or(coupling::JointMethod::hybrid),
      .mutation = job.word("mutation", coupling::mutation_names),
      .axis = job.text("axis") == "y" ? modal::Axis::y : modal::Axis::x,
      .seed = job.seed()};
  return finished(job, run_joint(wanted, progress));
}

Verb frf_verb() {
  return {.name = "frf",
          .button = "Estimate FRFs",
          .purpose = "hammer hits to frequency response functions",
          .more =
              "Hits are CSV, TXT, MAT, UFF, WAV, LVM, TDMS, HDF5 or NPY, named in hits.toml, or given in its place "
              "where their "
              "columns have names and units. Each hit of a record is judged, each FRF has a grade, and each fault a "
              "remedy.",
          .example = "frf hits.toml -o tip.uff",
          .readme = "robomill/modal/README.md",
          .input = {.name = "hits",
                    .meaning = "hits.toml, or records of hits",
                    .takes = Takes::files,
                    .required = true,
                    .kinds = {"hits", "record"}},
          .output = "tip.uff",
          .document = Document::frfs,
          .options = {flag_option("binary", "write .uff as data set 58b")},
          .run = &run_frf_verb};
}

Verb modes_verb() {
  return {.name = "modes",
          .button = "Fit modes",
          .purpose = "frequency response functions to modes",
          .more = "Modal parameters with standard deviations.",
          .example = "modes tip.uff --band 50,2000 -o modes.json",
          .readme = "robomill/modal/README.md",
          .input = {.name = "frfs",
                    .meaning = "FRF files: .uff .csv .txt .mat .json",
                    .takes = Takes::files,
                    .required = true,
                    .kinds = {"frf", "record"}},
          .output = "modes.json",
          .document = Document::modes,
          .options = {word_option("method", "method of the fit (default: hybrid)", words_of(modal::fit_method_names)),
                      {.name = "band_hz",
                       .meaning = "band to fit: low,high in Hz",
                       .takes = Takes::numbers,
                       .flag = "--band",
                       .unit = "Hz",
                       .count = 2},
                      whole_option("modes", "exactly this many modes", 1, 1000),
                      as_option(),
                      file_option("config", "modes.toml: every option of the fit", {"fit"}),
                      flag_option("accept_fit", "take modes whose relative error is 20 % or more"),
                      seed_option()},
          .run = &run_modes_verb};
}

Verb couple_verb() {
  return {.name = "couple",
          .button = "Predict the tip's FRFs",
          .purpose = "a tool in a holder to the FRFs at its tip, without a tap test",
          .more = "The assembly has the tool's drawing, its joint, and a holder that was measured once.",
          .example = "couple assembly.toml -o tip.uff",
          .readme = "robomill/coupling/README.md",
          .input = assembly_input(),
          .output = "tip.uff",
          .document = Document::frfs,
          .varies = true,
          .options = {flag_option("rotations", "also the rotations and moments at the tip"),
                      plain_option("holder_out",
                                   "keep the measured holder's receptances here, for every tool after: .uff .csv .mat "
                                   ".json",
                                   Takes::new_file)},
          .run = &run_couple_verb};
}

Verb tools_verb() {
  return {.name = "couple --tools",
          .button = "Compare a list of tools",
          .purpose = "a table of tools in one holder to each one's modes, best speed and depth",
          .example = "couple assembly.toml --tools tools.csv --lobes lobes.toml -o table.csv",
          .readme = "robomill/coupling/README.md",
          .input = assembly_input(),
          .output = "tools.json",
          .document = Document::tools,
          .options = {file_option("tools", "tools.csv: a table of tools, as .csv or .json", {"tools"}, true),
                      file_option("lobes", "lobes.toml: each tool's best speed and depth in this cut", {"lobes"}),
                      plain_option("frfs", "a folder for the FRFs at each tool's tip, N_TOOL.uff", Takes::new_folder),
                      seed_option()},
          .run = &run_tools_verb};
}

Verb joint_verb() {
  return {.name = "joint",
          .button = "Find the joint",
          .purpose = "a measured tip FRF to the stiffness and damping between tool and holder",
          .more = "Says which of them the FRF does not determine.",
          .example = "joint assembly.toml --measured tip.uff -o joint.json",
          .readme = "robomill/coupling/README.md",
          .input = assembly_input(),
          .output = "joint.json",
          .document = Document::joint,
          .options = {{.name = "measured",
                       .meaning = "FRFs at the tip: .uff .csv .txt .mat .json",
                       .takes = Takes::files,
                       .required = true,
                       .kinds = {"frf", "record"}},
                      word_option("method", "method of the search (default: hybrid)",
                                  words_of(coupling::joint_method_names)),
                      word_option("axis", "which FRF is fitted: x (xx) or y (yy) (default: x)", {"x", "y"}),
                      word_option("mutation", "mutation of ga (default: search.mutation, else uniform)",
                                  words_of(coupling::mutation_names)),
                      as_option(),
                      seed_option()},
          .run = &run_joint_verb};
}

}  // namespace

std::vector<Verb> structure_verbs() {
  return {frf_verb(), modes_verb(), couple_verb(), tools_verb(), joint_verb()};
}

}  // namespace robomill::jobs
