#include "robomill/jobs/dynamics_cache.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/jobs/files/named_files.hpp"
#include "robomill/jobs/planned_cut.hpp"

namespace robomill::jobs {
namespace fs = std::filesystem;

DynamicsCache::Key DynamicsCache::key_of(const LobesFile& file) {
  return {.files = {file.path, file.modes, file.frf, file.cell, file.workpiece_modes, file.workpiece_frf},
          .joints = file.joints,
          .axes = file.posture_axes,
          .equal = file.directions.equal,
          .rigid = file.directions.rigid,
          .in_three_directions = file.problem.in_three_directions(),
          .drilling = file.drilling};
}

std::vector<fs::path> DynamicsCache::watched_files(const LobesFile& file) {
  std::vector<fs::path> files = {file.modes, file.frf, file.cell, file.workpiece_modes, file.workpiece_frf};
  if (!file.cell.empty()) {
    const cell::CellFile cell = cell::read_cell(file.cell);
    for (const cell::PostureEntry& entry : cell.postures) files.insert(files.end(), {entry.frf, entry.modes});
    if (fs::path urdf; cell.document->path("robot.urdf", urdf)) files.push_back(urdf);
  }
  std::erase(files, fs::path());
  return files;
}

std::vector<DynamicsCache::Stamp> DynamicsCache::stamps_of(const std::vector<fs::path>& files) {
  std::vector<Stamp> stamps;
  for (const fs::path& file : files) {
    std::error_code missing;
    Stamp stamp;
    stamp.first = fs::file_size(file, missing);
    if (!missing) stamp.second = fs::last_write_time(file, missing);
    stamps.push_back(missing ? Stamp() : stamp);
  }
  return stamps;
}

void DynamicsCache::read(LobesFile& file, Progress& progress) {
  Structure fresh{.key = key_of(file), .watched = watched_files(file)};
  fresh.stamps = stamps_of(fresh.watched);  // before they are read: a change meanwhile is seen the next time
  const auto notes = static_cast<std::ptrdiff_t>(file.notes.size());
  const auto assumed = static_cast<std::ptrdiff_t>(file.assumed.size());
  load_dynamics(file, progress);
  ++reads_;
  fresh.dynamics = file.problem.dynamics;
  fresh.workpiece_dynamics = file.problem.workpiece_dynamics;
  fresh.measured = file.problem.measured;
  fresh.workpiece_measured = file.problem.workpiece_measured;
  fresh.posture = file.posture;
  fresh.notes.assign(file.notes.begin() + notes, file.notes.end());
  fresh.assumed.assign(file.assumed.begin() + assumed, file.assumed.end());
  kept_.push_front(std::move(fresh));
  if (kept_.size() > most_) kept_.pop_back();
}

void DynamicsCache::load(LobesFile& file, Progress& progress) {
  const bool in_the_document = !file.problem.dynamics.modes.empty() || !file.problem.workpiece_dynamics.modes.empty();
  if (in_the_document) return load_dynamics(file, progress);
  const auto known = std::ranges::find(kept_, key_of(file), &Structure::key);
  if (known == kept_.end()) return read(file, progress);
  if (stamps_of(known->watched) != known->stamps) {
    kept_.erase(known);
    return read(file, progress);
  }
  kept_.splice(kept_.begin(), kept_, known);
  file.problem.dynamics = known->dynamics;
  file.problem.workpiece_dynamics = known->workpiece_dynamics;
  file.problem.measured = known->measured;
  file.problem.workpiece_measured = known->workpiece_measured;
  file.posture = known->posture;
  file.notes.insert(file.notes.end(), known->notes.begin(), known->notes.end());
  add_assumed(file.assumed, known->assumed);
}

void DynamicsCache::load_plan(LobesFile& file, const fs::path& job, Progress& progress) {
  auto known = std::ranges::find(planned_, job, &Planned::job);
  if (known != planned_.end() && stamps_of(known->watched) != known->stamps) {
    planned_.erase(known);
    known = planned_.end();
  }
  if (known == planned_.end()) {
    Planned fresh{.job = job, .watched = files_named_in(job)};
    fresh.watched.push_back(job);
    fresh.stamps = stamps_of(fresh.watched);
    fresh.structure = std::make_shared<const PlanResult>(run_structure(job, default_seed, progress));
    ++reads_;
    planned_.push_front(std::move(fresh));
    if (planned_.size() > most_) planned_.pop_back();
    known = planned_.begin();
  }
  planned_.splice(planned_.begin(), planned_, known);
  take_plan(file, *known->structure);
}

}  // namespace robomill::jobs
