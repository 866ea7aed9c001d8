#include "robomill/coupling/files/joint_json.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "robomill/coupling/files/segment_fields.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::coupling {
namespace {

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

}  // namespace

std::string joint_json(const JointFitResult& result) {
  io::Json joint = io::Json::object(), deviation = io::Json::object(), identifiable = io::Json::object(),
           visible = io::Json::object();
  io::Json notes = io::Json::array();
  for (std::size_t i = 0; i < joint_unknowns; ++i) {
    const auto& [key, member, factor, value] = joint_fields[i];
    const JointKnowledge& knowledge = result.knowledge[i];
    joint[key] = io::number(result.joint.*value);
    deviation[key] = io::number(knowledge.deviation);
    identifiable[key] = knowledge.identifiable;
    if (i % 2 == 0) visible[key] = io::number(knowledge.visible_up_to);  // a stiffness
    if (!knowledge.note.empty()) notes.push_back(knowledge.note);
  }
  for (const std::string& note : result.notes) notes.push_back(note);
  io::Json best = io::Json::array();
  for (const double value : result.best) best.push_back(io::number(value));
  io::Json suspect = io::Json::array();
  for (const double line_hz : result.suspect_hz) suspect.push_back(io::number(line_hz));
  const bool converged = result.status == JointFitResult::Status::converged;
  io::Json json;
  json["joint"] = joint;
  json["objective"] = io::number(result.objective_m_per_n);
  json["relative_error"] = io::number(result.relative_error);
  json["std"] = deviation;
  json["identifiable"] = identifiable;
  json["visible_up_to"] = visible;
  json["convergence"] = {
      {"status", converged ? "converged" : "not converged"}, {"iterations", result.iterations}, {"best", best}};
  json["suspect_hz"] = suspect;
  json["notes"] = notes;
  return io::dump(json);
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
    out.warnings.push_back(fmt::format("{}: the search for the joint did not converge.", name));
  }
  return out;
}

}  // namespace robomill::coupling
