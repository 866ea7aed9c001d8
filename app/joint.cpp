#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/frf_files.hpp"
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

/// An error about the measured FRFs names their file, any other the assembly's.
InvalidInput located(const InvalidInput& error, const JointCommand& command) {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty()) return error;
  const bool measured = parts.field == "measured";
  parts.where = measured ? command.measured.front().string() : command.input.string();
  if (measured) parts.field.clear();
  return InvalidInput(std::move(parts));
}

coupling::JointFitResult find_joint(const coupling::AssemblyFile& file, const modal::FrfSet& measured,
                                    const JointCommand& command, const Common& common, Progress& progress) {
  coupling::JointFitOptions options = file.search;
  options.method = command.method == "ga" ? coupling::JointMethod::ga : coupling::JointMethod::hybrid;
  if (!command.mutation.empty()) {
    options.mutation = command.mutation == "adaptive" ? coupling::Mutation::adaptive : coupling::Mutation::uniform;
  }
  options.axis = command.axis == "y" ? modal::Axis::y : modal::Axis::x;
  options.seed = common.seed;
  try {
    return coupling::fit_joint(file.assembly, coupling::lines_between(measured, file.low_hz, file.high_hz), options,
                               progress);
  } catch (const InvalidInput& error) {
    throw located(error, command);
  }
}

}  // namespace

Exit run(const JointCommand& command, const Common& common, Progress& progress) {
  if (!common.output.empty() && !common.to_stdout() && io::format_of(common.output) != io::Format::json) {
    throw InvalidInput(common.output, "joints are written as .json");
  }
  const coupling::AssemblyFile file = coupling::read_assembly(command.input, {.joint_sought = true});
  const modal::FrfFile measured = modal::read_frfs(command.measured, command.as);
  if (measured.added_decay_per_s > 0.0) {
    throw InvalidInput(command.measured.front().string(), "still holds the damping of an exponential window",
                       "It would be taken for the joint's: estimate the FRFs with remove_added_damping");
  }
  const coupling::JointFitResult fit = find_joint(file, measured.set, command, common, progress);
  if (common.to_stdout()) {
    fmt::print("{}", coupling::joint_json(fit));
  } else if (!common.output.empty()) {
    io::write_file(common.output, coupling::joint_json(fit));
  }
  if (common.wants_summary()) {
    std::vector<std::string> notes = file.notes;
    notes.insert(notes.end(), measured.notes.begin(), measured.notes.end());
    if (file.holder) notes.insert(notes.end(), file.holder->notes.begin(), file.holder->notes.end());
    print_summary(fit, notes);
  }
  if (fit.status == coupling::JointFitResult::Status::converged) return done;
  fmt::print(stderr, "robomill: the joint was not found to convergence\n");
  return not_reached;
}

}  // namespace robomill::app
