#include "robomill/coupling/files/joint_json.hpp"

#include "robomill/coupling/files/segment_fields.hpp"
#include "robomill/io/json.hpp"

namespace robomill::coupling {

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

}  // namespace robomill::coupling
