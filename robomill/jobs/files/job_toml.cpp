#include "robomill/jobs/files/job_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/decision/files/limits_schema.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/files/job_schema.hpp"
#include "robomill/process/files/decide_toml.hpp"
#include "robomill/process/files/structure_schema.hpp"

namespace robomill::jobs {
namespace {

using io::declared;
using io::Holds;
using io::key;
using io::Schema;

}  // namespace

const Schema<Job>& job_table() {
  static const Schema<Job> table(
      "job", "what is planned, and the files of its parts",
      {key("title", &Job::title, "heading of the report"),
       key("hits", &Job::hits, "hits.toml: the structure from a tap test at the tool's tip"),
       key("frf", &Job::frf, "or from measured FRFs, one file or several").or_one(),
       key("frf_as", &Job::frf_as, "names of the FRFs in files that do not name them: xx, yy, …").or_one(),
       key("modes", &Job::modes, "or from modes: modes.json"),
       key("assembly", &Job::assembly, "or predicted: assembly.toml"),
       key("joint", &Job::joint,
           "joint.json, whose values replace those of the assembly's [joint], with a note; a warning names those that "
           "are not identifiable"),
       key("measured", &Job::measured,
           "FRFs of the tip, compared with the prediction of the assembly; a warning where they differ by more than 20 "
           "% of the measured"),
       key("lobes", &Job::lobes, "lobes.toml: the cut, where the job does not contain it"),
       key("forces", &Job::forces, "forces.toml, where the job has neither [stock] nor [forces]: forces are reported"),
       key("cell", &Job::cell, "cell.toml, where the job has no [robot]: the robot that the cut deflects"),
       key("program", &Job::program, "NC program: forces along it, and its trajectory where the cell has [smoothing]"),
       declared<Job>("cuts", Holds::path, "a file of [[cuts]]"),
       key("band_hz", &Job::band_hz, "from, to: of the fit").no_default().at_least(0.0).entries(2),
       key("fit_modes", &Job::fit_modes, "exactly so many modes; 0: the fit chooses").at_least(0.0),
       declared<Job>("equal_directions", Holds::boolean, "a direction that was not measured is like the other"),
       declared<Job>("rigid_directions", Holds::word, "directions that were not measured and do not move", 1)
           .words({"x", "y"})
           .or_one()});
  return table;
}

namespace {

/// The structure of [dynamics], where the job names no other.
void read_dynamics(io::TomlFile& file, Job& job) {
  process::DynamicsTable table = process::read_dynamics(file);
  if (!table.structure.own.modes.empty()) process::keep_named_directions(file, table.structure.own);
  job.modes = std::move(table.structure.modes);
  if (!table.structure.frf.empty()) job.frf.push_back(std::move(table.structure.frf));
  job.own_modes = std::move(table.structure.own);
  const auto says = [](const modal::MissingDirections& said) { return said.equal || !said.rigid.empty(); };
  if (says(job.directions) && says(table.directions)) {
    throw file.reject("dynamics", "and [job] both say what a direction is taken for", "Leave one of the two out");
  }
  if (says(table.directions)) job.directions = std::move(table.directions);
}

void read_sources(io::TomlFile& file, Job& job) {
  job_table().read(file, "job", job);
  const auto contained = [&](std::filesystem::path& part, bool held) {
    if (part.empty() && held) part = job.file;
  };
  contained(job.lobes, file.has("lobes"));
  contained(job.forces, file.has("forces") || file.has("stock"));
  contained(job.cell, std::ranges::any_of(cell::arm_keys, [&](const char* key) { return file.has(key); }));
  if (!job.joint.empty() && job.assembly.empty()) {
    throw file.reject("job.joint", "goes with job.assembly", "It stands in place of the assembly's [joint]");
  }
  if (job.forces.empty() && job.cell.empty() != job.program.empty()) {
    throw file.reject(job.cell.empty() ? "job.program" : "job.cell", "goes with job.forces, or cell with program",
                      "A program and a cell with [smoothing] make a trajectory");
  }
  process::missing_directions_table().read(file, "job", job.directions);
  if (!job.has_structure() && !job.lobes.empty()) read_dynamics(file, job);
  const int sources = (job.hits.empty() ? 0 : 1) + (job.frf.empty() ? 0 : 1) + (job.modes.empty() ? 0 : 1) +
                      (job.assembly.empty() ? 0 : 1) + (job.own_modes.modes.empty() ? 0 : 1);
  if (sources > 1 || (sources == 0 && !job.judges_blocks())) {
    throw file.reject(
        "job", "must name exactly one of hits, frf, modes and assembly",
        sources == 0
            ? "None is given, nor modes, frf, x and y in [dynamics]; forces, cell and program together need none"
            : "Several are given");
  }
  if (!job.measured.empty() && job.assembly.empty()) {
    throw file.reject("job.measured", "goes with job.assembly", "FRFs to start from are job.frf");
  }
  for (const char* key : {"job.equal_directions", "job.rigid_directions"}) {
    if (!job.assembly.empty() && file.has(key)) {
      throw file.reject(key, "must not stand beside job.assembly", "Both directions of an assembly are predicted");
    }
  }
  if (!job.judges_blocks() && job.lobes.empty()) file.require("job.lobes", "It names the cut: lobes.toml");
  if (sources == 0 && !job.lobes.empty()) {
    throw file.reject("job.lobes", "needs one of hits, frf, modes and assembly",
                      "Without lobes the blocks of the program are judged with what the cell knows");
  }
}

void read_cuts(io::TomlFile& file, std::vector<decision::TestCut>& cuts) {
  for (std::size_t i = 0; i < file.tables("cuts"); ++i) {
    decision::test_cut_table().read(file, "cuts[" + std::to_string(i) + "]", cuts.emplace_back(),
                                    "cuts[" + std::to_string(i + 1) + "].");
  }
}

}  // namespace

void Job::validate() const {
  recommend.validate();
  finish.validate();
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const std::string path = "cuts[" + std::to_string(i + 1) + "].";
    cutting::require_spindle_speed(path + "spindle_speed_rad_per_s", cuts[i].spindle_speed_rad_per_s);
    require_positive((path + "axial_depth_m").c_str(), cuts[i].axial_depth_m, "m");
    require_non_negative((path + "sample_rate_hz").c_str(), cuts[i].sample_rate_hz, "Hz");
    for (const double peak_hz : cuts[i].peaks_hz) require_positive((path + "peaks_hz").c_str(), peak_hz, "Hz");
  }
}

Job read_job(const io::TomlSource& source) {
  io::TomlFile file(source);
  Job job{.file = source.path, .settings = source.settings};
  read_sources(file, job);
  for (const auto* table : {&decision::edges_table(), &decision::spindle_table(), &decision::safety_table()})
    table->read(file, table->info().name, job.recommend);
  decision::finishing_table().read(file, "finishing", job.finish);
  job.decide = process::read_decide(file, job.judges_blocks());
  read_cuts(file, job.cuts);
  std::filesystem::path more_cuts;
  if (file.path("job.cuts", more_cuts)) {
    io::TomlFile cuts(more_cuts);
    cuts.locate([&] {
      Job only_cuts;
      read_cuts(cuts, only_cuts.cuts);
      only_cuts.validate();
      job.cuts.insert(job.cuts.end(), only_cuts.cuts.begin(), only_cuts.cuts.end());
    });
    job.notes = cuts.done();
  }
  std::ranges::move(file.done(), std::back_inserter(job.notes));
  job.assumed = io::sample_values(file);
  file.locate([&] { job.validate(); });
  return job;
}

decision::CutSignal read_cut_signal(const decision::TestCut& cut) {
  const io::Record record = io::read_record(cut.file, {.scale = cut.scale});
  const std::size_t place = record.place(cut.column);
  decision::CutSignal out = {.acceleration = record.columns[place], .notes = record.notes};
  const std::string unit = record.unit(place);
  const io::SiFactor si = io::parse_unit(unit);
  if (si.quantity == io::Quantity::acceleration && !si.is_ratio) {
    out.acceleration *= si.factor;
  } else if (io::is_unit(unit) && unit != "-") {
    out.notes.push_back(fmt::format("{}{}: column {} is in {}, and is read in m/s².", io::warning_label,
                                    cut.file.string(), cut.column, unit));
  }
  out.sample_rate_hz = io::rate_of(record, cut.sample_rate_hz, "sample_rate_hz", out.notes);
  if (out.sample_rate_hz > 0.0) return out;
  throw InvalidInput(cut.file.string(), "has no time column", "Give sample_rate_hz beside the file in [[cuts]]");
}

}  // namespace robomill::jobs
