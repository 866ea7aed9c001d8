#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/postures.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/jobs/verbs/records.hpp"

namespace robomill::jobs {
namespace {

VerbOption lobes_input() {
  return file_option("lobes", "lobes.toml, or a job.toml", {"lobes", "job"}, true);
}

Outcome run_lobes_verb(const VerbJob& job, Progress& progress) {
  return finished(
      job,
      run_lobes({.lobes = job.source(), .points = job.points("at"), .compare = job.flag("compare"), .seed = job.seed()},
                progress));
}

Outcome run_postures_verb(const VerbJob& job, Progress& progress) {
  if (!job.flag("postures")) {
    throw InvalidInput(job.named("postures"), "must be set: one chart of all [[postures]] is what a cell gives alone",
                       "For one posture give lobes.toml with dynamics.cell and joints_deg");
  }
  return finished(job, run_postures({.cell = job.input(), .cut = job.file("cut")}, progress));
}

Outcome run_simulate_verb(const VerbJob& job, Progress& progress) {
  SimulateJob wanted = {.lobes = job.source(), .point = job.point("at")};
  wanted.options.seconds = job.get("seconds", wanted.options.seconds);
  wanted.options.sample_rate_hz = job.get("sample_rate_hz", wanted.options.sample_rate_hz);
  wanted.options.loss_of_contact = !job.flag("linear");
  wanted.options.seed = job.seed();
  return finished(job, run_simulate(wanted, progress));
}

Outcome run_explain_verb(const VerbJob& job, Progress&) {
  if (job.has("lobes") != job.has("at")) {
    throw InvalidInput(job.named(job.has("at") ? "lobes" : "at"), "lobes and at go together",
                       "The cut says whether its chatter needs the delay");
  }
  const ExplainJob wanted = {.peaks = {job.numbers("peaks_hz"), job.get("rpm", 0.0) * units::rpm, job.get("teeth", 0)},
                             .options = {job.get("tolerance_hz", 1.0), job.get("speed_tolerance_percent", 0.2) / 100.0},
                             .modes = job.input(),
                             .lobes = job.file("lobes"),
                             .point = job.point("at")};
  if (wanted.point.axial_depth_m < 0.0) {
    throw InvalidInput(job.named("at"), wanted.point.axial_depth_m / units::mm, "mm", "must be >= 0");
  }
  return with_option(job, "tolerance_hz", "tolerance_hz", 1.0, [&] { return finished(job, run_explain(wanted)); });
}

process::ForcesResult forces_from(const VerbJob& job, Progress& progress) {
  if (!job.has("posture_deg")) return run_forces(job.source(), job.file("program"), job.file("cell"), progress);
  const std::filesystem::path program =
      job.has("program") ? job.file("program") : process::program_of_job(job.source());
  process::ForcesFile file = process::read_forces(job.source(), process::ForcesJob::program);
  if (job.has("cell")) file.cell = job.file("cell");
  if (file.cell.empty()) throw InvalidInput(job.named("posture_deg"), "goes with a robot", "Give " + job.named("cell"));
  cell::CellFile cell = cell::read_cell(file.cell);
  cell::ask_for_posture(cell, job.numbers("posture_deg"));
  return run_forces(file, program, std::move(cell), progress);
}

/// An error about a member of the record's options is one about the option.
InvalidInput about_record(const VerbJob& job, const InvalidInput& error) {
  InvalidInput out = job.about_option(error, "speed_tolerance", "speed_tolerance_percent", 0.01);
  for (const char* option : {"channels", "full_scale_n", "sample_rate_hz"})
    out = job.about_option(out, option, option, 1.0);
  for (const char* member : {"from_s", "to_s"}) out = job.about_option(out, member, "range_s", 1.0);
  return out;
}

cutting::ForceRecordOptions record_options(const VerbJob& job) {
  return {.channels = job.texts("channels"),
          .full_scale_n = job.get("full_scale_n", 0.0),
          .sample_rate_hz = job.get("sample_rate_hz", 0.0)};
}

process::RecordStretch record_stretch(const VerbJob& job) {
  process::RecordStretch out;
  if (job.has("speed_tolerance_percent")) out.speed_tolerance = 0.01 * job.get("speed_tolerance_percent", 0.0);
  if (const std::vector<double> range_s = job.numbers("range_s"); !range_s.empty()) {
    out.from_s = range_s[0];
    out.to_s = range_s[1];
  }
  return out;
}

process::ForcesResult measured_forces_from(const VerbJob& job, Progress& progress) {
  if (job.has("program")) throw InvalidInput(job.named("measured"), "goes with one revolution, not with a program");
  const MeasuredForceJob wanted = {
      .record = job.file("measured"), .reading = record_options(job), .stretch = record_stretch(job)};
  try {
    return run_measured_forces(job.input(), wanted, job.file("cell"), progress);
  } catch (const InvalidInput& error) {
    throw about_record(job, error);
  }
}

Outcome run_forces_verb(const VerbJob& job, Progress& progress) {
  if (job.has("measured")) return finished(job, measured_forces_from(job, progress), progress);
  return with_posture(job, [&] { return finished(job, forces_from(job, progress), progress); });
}

Outcome run_coefficients_verb(const VerbJob& job, Progress&) {
  return finished(job, run_coefficients({.slots = job.input(), .teeth = job.get("teeth", 0)}));
}

Outcome run_signal_verb(const VerbJob& job, Progress&) {
  try {
    return finished(job, run_signal_coefficients({.record = job.input(),
                                                  .cut = job.file("cut"),
                                                  .reading = record_options(job),
                                                  .stretch = record_stretch(job),
                                                  .degree = job.get("degree", 0)}));
  } catch (const InvalidInput& error) {
    throw about_record(job, error);
  }
}

Verb lobes_verb() {
  return {.name = "lobes",
          .button = "Compute lobes",
          .purpose = "modes or FRFs and a cut to stability lobes",
          .more =
              "With error estimates. --at evaluates one point, --compare every method. Of a ball end, a bull nose or a "
              "drill in three directions, with sweeps of lead, tilt or step-over.",
          .example = "lobes lobes.toml --at 6500,0.8 -o lobes.json",
          .readme = "robomill/stability/README.md",
          .input = lobes_input(),
          .output = "lobes.json",
          .document = Document::lobes,
          .varies = true,
          .options = {plain_option("at",
                                   "points RPM,MM (degrees where an angle is swept): spectral radius there; may be "
                                   "repeated",
                                   Takes::points),
                      flag_option("compare", "the limits by every method: error against collocation and time"),
                      seed_option()},
          .run = &run_lobes_verb};
}

Verb postures_verb() {
  return {
      .name = "lobes --cell",
      .button = "Compare postures",
      .purpose = "the limits of a cut in each posture that a cell was measured in",
      .more = "In one chart, and how far they lie apart by direction: x, y, z of the tip, a turn about its axis.",
      .example = "lobes --cell cell.toml --postures --cut cut.toml -o postures.json",
      .readme = "robomill/stability/README.md",
      .input = {.name = "cell",
                .meaning = "cell.toml with [[postures]]",
                .takes = Takes::file,
                .required = true,
                .flag = "--cell",
                .kinds = {"cell"}},
      .output = "postures.json",
      .document = Document::postures,
      .options = {flag_option("postures", "each of its [[postures]]"),
                  file_option("cut", "lobes.toml of the cut, whose structure does not count", {"lobes", "job"}, true)},
      .run = &run_postures_verb};
}

Verb simulate_verb() {
  return {.name = "simulate",
          .button = "Simulate the cut",
          .purpose = "a cut in the time domain: vibration, forces, the wall, stable or chatter",
          .example = "simulate lobes.toml --at 6500,0.6 --seconds 2 -o vibration.csv",
          .readme = "robomill/simulation/README.md",
          .input = lobes_input(),
          .output = "vibration.csv",
          .document = Document::simulation,
          .varies = true,
          .options = {{.name = "at",
                       .meaning = "RPM,MM: spindle speed and axial depth",
                       .takes = Takes::point,
                       .required = true},
                      positive_option("seconds", "how long to cut (default: 2 s)", "s"),
                      positive_option("sample_rate_hz", "sample rate of the output (default: 10240 Hz)", "Hz"),
                      flag_option("linear", "no loss of contact, as lobes take the cut"),
                      seed_option()},
          .run = &run_simulate_verb};
}

std::vector<VerbOption> explain_options() {
  return {{.name = "peaks_hz",
           .meaning = "frequencies of the peaks in Hz: F,F,…",
           .takes = Takes::numbers,
           .required = true,
           .flag = "--peaks",
           .unit = "Hz",
           .above = 0,
           .at_most = 1e6},
          {.name = "rpm", .meaning = "spindle speed in rpm", .takes = Takes::number, .required = true, .unit = "rpm"},
          {.name = "teeth",
           .meaning = "teeth of the cutter",
           .takes = Takes::whole,
           .required = true,
           .at_least = 1,
           .at_most = 100},
          positive_option("tolerance_hz",
                          "how far a peak may lie from what explains it, or half a mode's width where that is more "
                          "(default: 1 Hz)",
                          "Hz"),
          {.name = "speed_tolerance_percent",
           .meaning = "by how much the true speed may differ (default: 0.2 %)",
           .takes = Takes::number,
           .unit = "%",
           .at_least = 0,
           .at_most = 5},
          file_option("lobes", "lobes.toml of the cut: decides whether its chatter is regenerative", {"lobes"}),
          plain_option("at", "RPM,MM of the cut, with its lobes.toml", Takes::point)};
}

Verb explain_verb() {
  return {.name = "explain",
          .button = "Explain measured peaks",
          .purpose = "measured peaks to what they are: rotation, tooth passing, or chatter and its mode",
          .example = "explain --peaks 325,667 --rpm 6500 --teeth 3 --modes modes.json",
          .readme = "robomill/stability/README.md",
          .input = {.name = "modes",
                    .meaning = "modes.json or modes.toml",
                    .takes = Takes::file,
                    .required = true,
                    .flag = "--modes",
                    .kinds = {"modes"}},
          .output = "explain.json",
          .document = Document::explanation,
          .options = explain_options(),
          .run = &run_explain_verb};
}

/// How a force record is read. @param needs  the option that names it; empty: the input does
std::vector<VerbOption> record_reading(std::string_view needs) {
  std::vector<VerbOption> out = {
      plain_option("channels",
                   "its columns for x along the feed, y to its left, z to the spindle, by name or number: "
                   "--channels=-Fy,-Fx,none (default: by their names)",
                   Takes::texts),
      {.name = "range_s",
       .meaning = "A,B in s: the part of the record in the cut (default: found)",
       .takes = Takes::numbers,
       .flag = "--range",
       .unit = "s",
       .count = 2,
       .at_least = 0},
      {.name = "speed_tolerance_percent",
       .meaning = "how far its speed may lie from that of the cut (default: 1 %)",
       .takes = Takes::number,
       .unit = "%",
       .at_least = 0,
       .at_most = 10},
      positive_option("full_scale_n", "force that the full scale of a WAV means", "N"),
      positive_option("sample_rate_hz", "its sample rate, where the record does not state it", "Hz")};
  for (VerbOption& option : out) option.needs = needs;
  return out;
}

std::vector<VerbOption> forces_options() {
  std::vector<VerbOption> out = {
      file_option("program", "an NC program: a row a block in place of one revolution", {"program"}),
      file_option("cell", "cell.toml: the robot that the cut bends", {"cell"}), posture_option("program"),
      file_option("measured", "a dynamometer's record: measured beside predicted over one revolution", {"record"})};
  for (VerbOption& option : record_reading("measured")) out.push_back(std::move(option));
  return out;
}

Verb forces_verb() {
  return {.name = "forces",
          .button = "Compute forces",
          .purpose = "a cutter in its cut, or along a program, to cutting forces",
          .more =
              "Forces, torque, power and deflection over a revolution, or block by block. --measured compares a force "
              "record.",
          .example = "forces forces.toml -o forces.csv --report forces.html",
          .readme = "robomill/cutting/README.md",
          .input = file_option("forces", "forces.toml, or a job.toml", {"forces", "job"}, true),
          .output = "forces.csv",
          .document = Document::forces,
          .varies = true,
          .options = forces_options(),
          .run = &run_forces_verb};
}

Verb coefficients_verb() {
  return {.name = "coefficients",
          .button = "Identify coefficients",
          .purpose = "average forces of slots to cutting force coefficients",
          .more = "Coefficients with standard deviations.",
          .example = "coefficients slots.csv --teeth 4 -o coefficients.toml",
          .readme = "robomill/cutting/README.md",
          .input = file_option("slots", "slots.csv", {"slots"}, true),
          .output = "coefficients.toml",
          .document = Document::coefficients,
          .options = {whole_option("teeth", "teeth of the cutter (default: 4, listed as assumed)", 1, 100)},
          .run = &run_coefficients_verb};
}

Verb signal_verb() {
  std::vector<VerbOption> options = {
      file_option("cut", "forces.toml of the cut, [coefficients] not needed", {"forces"}, true),
      whole_option("degree", "of the cutting coefficients as polynomials in the axial position angle (default: 0)", 0,
                   6)};
  for (VerbOption& option : record_reading({})) options.push_back(std::move(option));
  return {.name = "coefficients --signal",
          .button = "Identify coefficients of a force record",
          .purpose = "the force record of one cut to cutting force coefficients",
          .more =
              "For any cutter in any cut, also as polynomials along a ball end's edge. With standard deviations, and "
              "the record beside the forces of what was found.",
          .example = "coefficients --signal record.csv --cut cut.toml -o coefficients.toml",
          .readme = "robomill/cutting/README.md",
          .input = {.name = "signal",
                    .meaning = "the force record of a steady cut",
                    .takes = Takes::file,
                    .required = true,
                    .flag = "--signal",
                    .kinds = {"record"}},
          .output = "coefficients.toml",
          .document = Document::signal_coefficients,
          .options = std::move(options),
          .run = &run_signal_verb};
}

}  // namespace

std::vector<Verb> cut_verbs() {
  return {lobes_verb(),  postures_verb(),     simulate_verb(), explain_verb(),
          forces_verb(), coefficients_verb(), signal_verb()};
}

}  // namespace robomill::jobs
