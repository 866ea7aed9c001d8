#include <fmt/format.h>

#include <array>
#include <cmath>

#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/jobs/joint.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

struct Row {
  coupling::JointUnknown unknown;
  double coupling::Joint::*value;
  const char* unit;
};
constexpr std::array<Row, coupling::joint_unknowns> rows = {{
    {coupling::JointUnknown::translational_stiffness, &coupling::Joint::translational_stiffness_n_per_m, "N/m"},
    {coupling::JointUnknown::translational_damping, &coupling::Joint::translational_damping_n_s_per_m, "N s/m"},
    {coupling::JointUnknown::rotational_stiffness, &coupling::Joint::rotational_stiffness_n_m_per_rad, "N m/rad"},
    {coupling::JointUnknown::rotational_damping, &coupling::Joint::rotational_damping_n_m_s_per_rad, "N m s/rad"},
}};

void print_summary(const coupling::JointFitResult& fit, const std::vector<std::string>& read_notes) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const coupling::JointKnowledge& knowledge = fit.knowledge[i];
    const std::string spread =
        std::isfinite(knowledge.deviation) ? fmt::format(" ± {:.2g}", knowledge.deviation) : std::string();
    fmt::print("{:<24} {:.6g}{} {}{}\n", to_string(rows[i].unknown), fit.joint.*rows[i].value, spread, rows[i].unit,
               knowledge.identifiable ? "" : "  not identifiable");
  }
  fmt::print("\n‖|H| - |H model|‖ = {:.6g} m/N, relative error {:.4g}, {} iterations\n", fit.objective_m_per_n,
             fit.relative_error, fit.iterations);
  for (const coupling::JointKnowledge& knowledge : fit.knowledge) {
    if (!knowledge.note.empty()) fmt::print("{}\n", knowledge.note);
  }
  print_notes(fit.notes, "");
  print_notes(read_notes, "Note: ");
}

jobs::JointJob job_of(const JointCommand& command, const Common& common) {
  jobs::JointJob job;
  job.assembly = command.input;
  job.measured = command.measured;
  job.as = command.as;
  job.method = value_in(coupling::joint_method_names, command.method).value();
  if (!command.mutation.empty()) job.mutation = value_in(coupling::mutation_names, command.mutation);
  job.axis = command.axis == "y" ? modal::Axis::y : modal::Axis::x;
  job.seed = common.seed;
  return job;
}

}  // namespace

Exit run(const JointCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::json}, "joints are written as .json");
  const jobs::JointResult found = jobs::run_joint(job_of(command, common), progress);
  const coupling::JointFitResult& fit = found.fit;
  write_output(common, [&](io::Format) { return coupling::joint_json(fit); });
  if (common.wants_summary()) print_summary(fit, found.notes);
  if (fit.status == coupling::JointFitResult::Status::converged) return done;
  fmt::print(stderr, "robomill: the joint was not found to convergence\n");
  return not_reached;
}

}  // namespace robomill::app
