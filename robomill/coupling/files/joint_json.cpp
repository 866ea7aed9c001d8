#include "robomill/coupling/files/joint_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "robomill/coupling/files/segment_fields.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::coupling {
namespace {

using io::key;
using io::Row;
using io::Schema;

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " and " : ", ";
    out += words[i];
  }
  return out;
}

/// The four in words, k_u and k_θ with their damping.
std::string values_text(const Joint& joint) {
  return fmt::format("{:.4g} N/m with {:.4g} N·s/m, {:.4g} N·m/rad with {:.4g} N·m·s/rad",
                     joint.translational_stiffness_n_per_m, joint.translational_damping_n_s_per_m,
                     joint.rotational_stiffness_n_m_per_rad, joint.rotational_damping_n_m_s_per_rad);
}

/// Names of the values that the file says are not identifiable.
std::vector<std::string> unidentifiable(const io::JsonNode& root) {
  std::vector<std::string> out;
  if (!root.has("identifiable")) return out;
  const io::JsonNode table = root.at("identifiable");
  for (std::size_t i = 0; i < joint_unknowns; ++i) {
    const char* const key = joint_fields[i].key;
    const io::JsonNode entry = table.at(key);
    if (!entry.json().is_boolean()) throw entry.reject("must be true or false");
    if (!entry.json().get<bool>()) out.push_back(to_string(static_cast<JointUnknown>(i)));
  }
  return out;
}

/// A table with a key for each of the four.
/// @param value  (const JointFitResult&, std::size_t) -> of the unknown
/// @param every  1: of each; 2: of the stiffnesses
template <class F>
Schema<JointFitResult> of_unknowns(const char* name, const char* meaning, F value, std::size_t every = 1) {
  std::vector<Row<JointFitResult>> rows;
  for (std::size_t i = 0; i < joint_unknowns; i += every) {
    rows.push_back(key(
        joint_fields[i].key, [value, i](const JointFitResult& result) { return value(result, i); },
        to_string(static_cast<JointUnknown>(i))));
    if (rows.back().key.holds == io::Holds::number) rows.back().nullable();
  }
  return {name, meaning, std::move(rows), io::Use::written};
}

const Schema<JointFitResult>& convergence_table() {
  static const Schema<JointFitResult> table(
      "convergence", "of the search",
      {key("status", &JointFitResult::status, joint_status_names,
           "how it ended; stalled: ga did not improve on its random start"),
       key("iterations", &JointFitResult::iterations, "generations and steps"),
       key("start", &JointFitResult::start, "the misfit of the best of the random start").nullable(),
       key("best", &JointFitResult::best, "the misfit after each").nullable()},
      io::Use::written);
  return table;
}

}  // namespace

const Schema<JointFitResult>& joint_table() {
  using Result = JointFitResult;
  static const Schema<Result> values =
      of_unknowns("joint_values", "the four values, in the keys of assembly.toml",
                  [](const Result& r, std::size_t i) { return r.joint.*joint_fields[i].value; });
  static const Schema<Result> deviations =
      of_unknowns("joint_std", "standard deviations; none: the FRF sets no upper bound",
                  [](const Result& r, std::size_t i) { return r.knowledge[i].deviation; });
  static const Schema<Result> identifiable =
      of_unknowns("joint_identifiable", "whether the FRF bounds each from both sides",
                  [](const Result& r, std::size_t i) { return r.knowledge[i].identifiable; });
  static const Schema<Result> visible = of_unknowns(
      "joint_visible", "stiffness beyond which the FRF cannot distinguish the joint from a rigid one",
      [](const Result& r, std::size_t i) { return r.knowledge[i].visible_up_to; }, 2);
  const auto whole = [](const Result& result) { return &result; };
  static const Schema<Result> table(
      "joint", "the joint between tool and holder, found from an FRF at the tip",
      {key("joint", whole, values, "in SI"),
       key(
           "points", [](const Result& result) { return result.joint.points; },
           "of the shank that have an equal share of it; 1: at the mouth"),
       key("objective", &Result::objective_m_per_n, "norm of |H| less |H model| over the lines, in m/N").nullable(),
       key("relative_error", &Result::relative_error, "norm of H - H model over that of H").nullable(),
       key("std", whole, deviations, "standard deviations"), key("identifiable", whole, identifiable, "by the FRF"),
       key("visible_up_to", whole, visible, "of the stiffnesses"),
       key("convergence", whole, convergence_table(), "of the search"),
       key("suspect_hz", &Result::suspect_hz, "lines where holder or tip would create energy"),
       key(
           "notes",
           [](const Result& result) {
             std::vector<std::string> notes;
             for (const JointKnowledge& knowledge : result.knowledge) {
               if (!knowledge.note.empty()) notes.push_back(knowledge.note);
             }
             notes.insert(notes.end(), result.notes.begin(), result.notes.end());
             return notes;
           },
           "sentences for the user")},
      io::Use::written, 1);
  return table;
}

std::string joint_json(const JointFitResult& result) {
  return io::dump(joint_table().write(result));
}

std::string joint_csv(const JointFitResult& result) {
  std::string out = "parameter,value,std,identifiable\n";
  for (std::size_t i = 0; i < joint_unknowns; ++i) {
    const JointKnowledge& knowledge = result.knowledge[i];
    io::add_csv_row(out, {joint_fields[i].key, io::csv_number(result.joint.*joint_fields[i].value),
                          io::csv_number(knowledge.deviation), knowledge.identifiable ? "true" : "false"});
  }
  return out;
}

namespace {

int points_of(const io::JsonNode& root) {
  if (!root.has("points")) return 1;
  const double points = root.at("points").number();
  if (!(points >= 1.0 && points <= 100.0 && points == std::floor(points))) {
    throw root.at("points").reject("must be a whole number in 1 ... 100");
  }
  return static_cast<int>(points);
}

}  // namespace

JointFile read_joint_json(const std::filesystem::path& path) {
  const io::Json json = io::read_json(path);
  JointFile out;
  std::vector<std::string> unusual;
  const io::JsonNode root(json, path.string(), unusual);
  const io::JsonNode values = root.at("joint");
  for (const io::Field<Joint>& field : joint_fields) {
    out.joint.*field.value = field.factor * values.at(field.key).number();
  }
  try {
    out.joint.validate();
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = within("joint.", error).parts();
    parts.where = path.string();
    throw InvalidInput(std::move(parts));
  }
  out.joint.points = points_of(root);
  out.warnings = io::take_warnings(unusual);
  const std::string name = path.filename().string();
  out.notes.push_back(
      fmt::format("The joint is that of {}, in place of the assembly's: {}.", name, values_text(out.joint)));
  const std::vector<std::string> unknown = unidentifiable(root);
  if (!unknown.empty()) {
    out.warnings.push_back(
        fmt::format("{}: {} {} not identifiable from the FRF that the joint was found with. What is predicted with "
                    "another tool may be wrong.",
                    name, listed(unknown), unknown.size() == 1 ? "is" : "are"));
  }
  if (root.has("convergence") && root.at("convergence").has("status") &&
      root.at("convergence").at("status").text() != "converged") {
    const bool stalled = root.at("convergence").at("status").text() == "stalled";
    out.warnings.push_back(fmt::format("{}: the search for the joint {}.", name,
                                       stalled ? "stalled at its random start" : "did not converge"));
  }
  return out;
}

}  // namespace robomill::coupling
