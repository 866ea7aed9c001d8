#include "robomill/jobs/joint.hpp"

#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"

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

}  // namespace

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

}  // namespace robomill::jobs
