#include "robomill/jobs/files/job_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/process/files/decide_toml.hpp"
#include "robomill/process/files/structure_schema.hpp"

namespace robomill::jobs {
namespace {

/// A part of the job in a file of its own, or in the job itself.
void read_part(io::TomlFile& file, const char* key, bool held, const Job& job, std::filesystem::path& part) {
  if (!file.path(key, part) && held) part = job.file;
}

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
  file.text("job.title", job.title);
  file.path("job.hits", job.hits);
  file.path("job.modes", job.modes);
  read_part(file, "job.lobes", file.has("lobes"), job, job.lobes);
  file.path("job.assembly", job.assembly);
  if (file.path("job.joint", job.joint) && job.assembly.empty()) {
    throw file.reject("job.joint", "goes with job.assembly", "It stands in place of the assembly's [joint]");
  }
  read_part(file, "job.forces", file.has("forces") || file.has("stock"), job, job.forces);
  const bool holds_arm = std::ranges::any_of(cell::arm_keys, [&](const char* key) { return file.has(key); });
  read_part(file, "job.cell", holds_arm, job, job.cell);
  file.path("job.program", job.program);
  if (job.forces.empty() && job.cell.empty() != job.program.empty()) {
    throw file.reject(job.cell.empty() ? "job.program" : "job.cell", "goes with job.forces, or cell with program",
                      "A program and a cell with [smoothing] make a trajectory");
  }
  const bool measured = file.path("job.measured", job.measured);
  file.paths("job.frf", job.frf);
  file.texts("job.frf_as", job.frf_as);
  std::vector<double> band;
  if (file.numbers("job.band_hz", "band_hz", 1.0, band)) {
    if (band.size() != 2) throw file.reject("job.band_hz", "must be [low, high]");
    job.band_low_hz = band[0];
    job.band_high_hz = band[1];
  }
  process::missing_directions_table().read(file, "job", job.directions);
  file.integer("job.fit_modes", "fit_modes", job.fit_modes);
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
  if (measured && job.assembly.empty()) {
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

void read_limits(io::TomlFile& file, Job& job) {
  file.number("tool.max_axial_depth_mm", "max_axial_depth_m", units::mm, job.recommend.max_axial_depth_m);
  file.number("spindle.max_speed_rpm", "max_spindle_speed_rad_per_s", units::rpm,
              job.recommend.max_spindle_speed_rad_per_s);
  file.number("spindle.min_speed_rpm", "min_spindle_speed_rad_per_s", units::rpm,
              job.recommend.min_spindle_speed_rad_per_s);
  file.number("safety.depth_margin", "depth_margin", 1.0, job.recommend.depth_margin);
  file.number("safety.speed_window", "speed_window", 1.0, job.recommend.speed_window);
  file.number("finishing.max_surface_error_um", "max_surface_error_m", units::um, job.finish.max_surface_error_m);
  file.number("finishing.max_deflection_um", "max_deflection_m", units::um, job.finish.max_deflection_m);
  for (std::size_t i = 0; i < file.tables("spindle.curve"); ++i) {
    const std::string row = "spindle.curve[" + std::to_string(i) + "].";
    decision::SpindleCapacity point;
    for (const char* key : {"speed_rpm", "torque_n_m", "power_kw"}) file.require(row + key);
    const std::string member = "spindle[" + std::to_string(i + 1) + "].";
    file.number(row + "speed_rpm", member + "spindle_speed_rad_per_s", units::rpm, point.spindle_speed_rad_per_s);
    file.number(row + "torque_n_m", member + "torque_n_m", 1.0, point.torque_n_m);
    file.number(row + "power_kw", member + "power_w", units::kw, point.power_w);
    job.recommend.spindle.push_back(point);
  }
}

void read_cuts(io::TomlFile& file, Job& job) {
  for (std::size_t i = 0; i < file.tables("cuts"); ++i) {
    const std::string row = "cuts[" + std::to_string(i) + "].";
    const std::string member = "cuts[" + std::to_string(i + 1) + "].";
    decision::TestCut cut;
    file.require(row + "spindle_speed_rpm");
    file.require(row + "axial_depth_mm");
    file.number(row + "spindle_speed_rpm", member + "spindle_speed_rad_per_s", units::rpm, cut.spindle_speed_rad_per_s);
    file.number(row + "axial_depth_mm", member + "axial_depth_m", units::mm, cut.axial_depth_m);
    file.choice(row + "result", decision::verdict_names, cut.result);
    file.numbers(row + "peaks_hz", member + "peaks_hz", 1.0, cut.peaks_hz);
    file.path(row + "file", cut.file);
    file.text(row + "column", cut.column);
    file.number(row + "scale", member + "scale", 1.0, cut.scale);
    file.number(row + "sample_rate_hz", member + "sample_rate_hz", 1.0, cut.sample_rate_hz);
    job.cuts.push_back(cut);
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
  Job job{.file = source.path};
  read_sources(file, job);
  read_limits(file, job);
  job.decide = process::read_decide(file, job.judges_blocks());
  read_cuts(file, job);
  std::filesystem::path more_cuts;
  if (file.path("job.cuts", more_cuts)) {
    io::TomlFile cuts(more_cuts);
    cuts.locate([&] {
      Job only_cuts;
      read_cuts(cuts, only_cuts);
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
