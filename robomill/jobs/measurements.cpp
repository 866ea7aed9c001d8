#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hit_files/bare_hits.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/usual_arm.hpp"

// From measurements to FRFs, modes, joints, coefficients and stiffness.

namespace robomill::jobs {
namespace {

/// An error about the measured FRFs names their file, any other the assembly's.
InvalidInput with_file(const InvalidInput& error, const JointJob& job) {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty()) return error;
  const bool measured = parts.field == "measured";
  parts.where = measured ? job.measured.front().string() : job.assembly.string();
  if (measured) parts.field.clear();
  return InvalidInput(std::move(parts));
}

constexpr int usual_teeth = 4;

/// What is unusual about the loads, and about the stiffness that they give.
void warn_of_loads(StiffnessResult& result) {
  const auto warn = [&](const std::string& text) {
    result.cell.notes.push_back(fmt::format("{}{}: {}", io::warning_label, result.loads.path.string(), text));
  };
  for (const std::string& text : robot::unusual_displacements(result.loads.loads)) warn(text);
  for (std::size_t k = 0; k < result.found.joints.size(); ++k) {
    const robot::IdentifiedJoint& joint = result.found.joints[k];
    if (!joint.identifiable || result.cell.robot.arm.joints[k].prismatic) continue;
    const auto unusual = io::unusual_value("joint_stiffness_n_m_per_rad", std::span(&joint.stiffness, 1));
    if (unusual)
      warn(fmt::format("joint {} comes out as {:.4g} N m/rad, which {}.", k + 1, joint.stiffness, unusual->rule));
  }
}

}  // namespace

FrfJobResult run_frf(const std::vector<std::filesystem::path>& inputs, Progress& progress) {
  const auto is_record = [](const std::filesystem::path& path) {
    return io::is_read_as_record(path) || !io::unread_record(path).what.empty();
  };
  const auto document = std::ranges::find_if_not(inputs, is_record);
  if (document != inputs.end() && inputs.size() > 1) {
    throw InvalidInput(document->string(), "is no record of hits, and stands beside others",
                       "Give one hits.toml, or records alone");
  }
  FrfJobResult out;
  out.file = document != inputs.end() ? modal::read_hits(*document) : modal::read_bare_hits(inputs);
  out.frfs = modal::estimate_frfs(out.file.hits, out.file.options, progress);
  return out;
}

ModesResult run_modes(const ModesJob& job, Progress& progress) {
  ModesResult out;
  out.measured = modal::read_frfs(job.frfs, job.as);
  out.measured.notes.insert(out.measured.notes.begin(), job.notes.begin(), job.notes.end());
  modal::FitOptions options = job.options;
  if (out.measured.added_decay_per_s > 0.0) options.exponential_decay_per_s = out.measured.added_decay_per_s;
  out.fit = modal::fit_modes(out.measured.set, options, progress);
  out.fit.accepted = job.accept_fit;
  return out;
}

modal::FrfSet fitted_frfs(const modal::ModalModel& model, const modal::FrfSet& measured) {
  const Eigen::VectorXd& lines = measured.frequency_hz;
  modal::FrfSet all = modal::synthesize(model, lines(0) == 0.0 ? lines.tail(lines.size() - 1).eval() : lines);
  std::erase_if(all.frfs, [&](const modal::Frf& frf) { return measured.find(frf.name) == nullptr; });
  return all;
}

JointResult run_joint(const JointJob& job, Progress& progress) {
  const coupling::AssemblyFile file = coupling::read_assembly(job.assembly, {.joint_sought = true});
  const modal::FrfFile measured = modal::read_frfs(job.measured, job.as);
  if (measured.added_decay_per_s > 0.0) {
    throw InvalidInput(job.measured.front().string(), "still holds the damping of an exponential window",
                       "It would be taken for the joint's: estimate the FRFs with remove_added_damping");
  }
  coupling::JointFitOptions options = file.search;
  options.method = job.method;
  options.mutation = job.mutation.value_or(options.mutation);
  options.axis = job.axis;
  options.seed = job.seed;
  JointResult out;
  try {
    out.measured = coupling::lines_between(measured.set, file.low_hz, file.high_hz);
    out.fit = coupling::fit_joint(file.assembly, out.measured, options, progress);
  } catch (const InvalidInput& error) {
    throw with_file(error, job);
  }
  out.notes = file.notes;
  out.notes.insert(out.notes.end(), measured.notes.begin(), measured.notes.end());
  if (file.holder) out.notes.insert(out.notes.end(), file.holder->notes.begin(), file.holder->notes.end());
  out.assumed = file.assumed;
  add_assumed(out.assumed, measured.assumed);
  return out;
}

CoefficientsResult run_coefficients(const CoefficientsJob& job) {
  CoefficientsResult out;
  out.file = cutting::read_slots(job.slots);
  const bool said = job.teeth > 0;
  try {
    out.fit = cutting::identify_from_slots(out.file.slots, {.teeth = said ? job.teeth : usual_teeth});
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.field == "slots") parts.where = job.slots.string();
    throw InvalidInput(std::move(parts));
  }
  if (!said) {
    out.assumed.push_back(
        {.what = "Teeth of the cutter",
         .taken = fmt::format("{}; with N teeth every coefficient is {}/N of these", usual_teeth, usual_teeth),
         .key = "--teeth"});
  }
  return out;
}

StiffnessResult run_stiffness(const StiffnessJob& job) {
  StiffnessResult out;
  out.output = job.output;
  cell::CellFile file = cell::read_cell(job.cell);
  out.cell = std::move(static_cast<cell::Cell&>(file));
  const robot::Cell& cell = out.cell.robot;
  out.loads = robot::read_loads(job.loads, cell.arm);
  out.cell.notes.insert(out.cell.notes.end(), out.loads.notes.begin(), out.loads.notes.end());
  const Eigen::Isometry3d mount = out.cell.mount();
  const Eigen::Vector3d point_m = job.point_m.value_or(mount * robot::tip_point(cell));
  out.found = robot::identify_joint_stiffness(cell.arm, mount.inverse() * point_m, out.loads);
  warn_of_loads(out);
  if (!job.point_m) {
    const Eigen::Vector3d mm = point_m / units::mm;
    out.assumed.push_back({.what = "Point that the loads attack and that moved",
                           .taken = fmt::format("the tool's tip, ({:.6g}, {:.6g}, {:.6g}) mm in the flange frame",
                                                mm.x(), mm.y(), mm.z()),
                           .key = "--point-mm"});
  }
  if (std::ranges::all_of(out.loads.loads, [](const robot::Load& load) { return load.deviation_m == 0.0; })) {
    out.assumed.push_back({.what = "Deviations of the displacements",
                           .taken = "all alike",
                           .key = "deviation_mm",
                           .file = job.loads.filename().string()});
  }
  return out;
}

}  // namespace robomill::jobs
