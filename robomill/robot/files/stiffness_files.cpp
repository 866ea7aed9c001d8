#include "robomill/robot/files/stiffness_files.hpp"

#include <fmt/format.h>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"

namespace robomill::formats {

std::string stiffness_json(const robot::IdentifiedStiffness& result) {
  Json stiffness = Json::array(), deviation = Json::array(), identifiable = Json::array(), reason = Json::array();
  Json compliance = Json::array(), compliance_deviation = Json::array();
  for (const robot::IdentifiedJoint& joint : result.joints) {
    stiffness.push_back(joint.identifiable ? number(joint.stiffness) : Json());
    deviation.push_back(number(joint.deviation));
    compliance.push_back(number(joint.compliance));
    compliance_deviation.push_back(number(joint.compliance_deviation));
    identifiable.push_back(joint.identifiable);
    reason.push_back(joint.reason.empty() ? Json() : Json(joint.reason));
  }
  Json residual = Json::array();
  for (Eigen::Index k = 0; k < result.residual_m.cols(); ++k) {
    residual.push_back({number(result.residual_m(0, k) / units::mm), number(result.residual_m(1, k) / units::mm),
                        number(result.residual_m(2, k) / units::mm)});
  }
  Json json;
  json["joint_stiffness_n_m_per_rad"] = stiffness;
  json["std"] = deviation;
  json["identifiable"] = identifiable;
  json["reason"] = reason;
  json["joint_compliance_rad_per_n_m"] = compliance;
  json["compliance_std"] = compliance_deviation;
  json["residual_mm"] = residual;
  json["rms_mm"] = number(result.rms_m / units::mm);
  json["r_squared"] = number(result.r_squared);
  json["condition_number"] = number(result.condition_number);
  const bool converged = result.status == robot::IdentifiedStiffness::Status::converged;
  json["convergence"] = {{"status", converged ? "converged" : "not converged"}, {"iterations", result.iterations}};
  return dump(json);
}

std::string stiffness_toml(const robot::IdentifiedStiffness& result, const robot::Arm& arm) {
  std::string values, comments, unknown;
  for (std::size_t i = 0; i < result.joints.size(); ++i) {
    const robot::IdentifiedJoint& joint = result.joints[i];
    const double value = joint.identifiable ? joint.stiffness : arm.joints[i].stiffness;
    if (!(value > 0.0)) unknown += fmt::format("{}{}", unknown.empty() ? "" : ", ", i + 1);
    if (!joint.identifiable) comments += fmt::format("# Joint {}, as before: {}.\n", i + 1, joint.reason);
    values += fmt::format("{}{:.6g}", values.empty() ? "" : ", ", value);
  }
  if (!unknown.empty()) {
    throw InvalidInput("joint_stiffness_n_m_per_rad", fmt::format("is not known of joint {}", unknown),
                       "Write .json, add loads that turn it, or give its stiffness in the cell");
  }
  return fmt::format("[robot]\n{}joint_stiffness_n_m_per_rad = [{}]\n", comments, values);
}

}  // namespace robomill::formats
