#include "robomill/coupling/files/joint_json.hpp"

#include <array>

#include "robomill/io/json.hpp"

namespace robomill::coupling {
namespace {

/// An unknown's key, as in assembly.toml; SI in the file too.
struct UnknownKey {
  const char* key;
  double Joint::*value;
  bool is_stiffness;
};
constexpr std::array<UnknownKey, joint_unknowns> rows = {{
    {"translational_stiffness_n_per_m", &Joint::translational_stiffness_n_per_m, true},
    {"translational_damping_n_s_per_m", &Joint::translational_damping_n_s_per_m, false},
    {"rotational_stiffness_n_m_per_rad", &Joint::rotational_stiffness_n_m_per_rad, true},
    {"rotational_damping_n_m_s_per_rad", &Joint::rotational_damping_n_m_s_per_rad, false},
}};

}  // namespace

std::string joint_json(const JointFitResult& result) {
  io::Json joint = io::Json::object(), deviation = io::Json::object(), identifiable = io::Json::object(),
           visible = io::Json::object();
  io::Json notes = io::Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const JointKnowledge& knowledge = result.knowledge[i];
    joint[rows[i].key] = io::number(result.joint.*rows[i].value);
    deviation[rows[i].key] = io::number(knowledge.deviation);
    identifiable[rows[i].key] = knowledge.identifiable;
    if (rows[i].is_stiffness) visible[rows[i].key] = io::number(knowledge.visible_up_to);
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

}  // namespace robomill::coupling
