#include "robomill/robot/files/stiffness_files.hpp"

#include <fmt/format.h>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/json.hpp"

namespace robomill::robot {
namespace {

const char* unit_of(const Joint& joint) {
  return joint.prismatic ? "N/m" : "N m/rad";
}

}  // namespace

std::string stiffness_json(const IdentifiedStiffness& result, const Arm& arm, const LoadsFile& file) {
  io::Json stiffness = io::Json::array(), deviation = io::Json::array(), identifiable = io::Json::array(),
           reason = io::Json::array(), unit = io::Json::array();
  io::Json compliance = io::Json::array(), compliance_deviation = io::Json::array();
  for (const Joint& joint : arm.joints) unit.push_back(unit_of(joint));
  for (const IdentifiedJoint& joint : result.joints) {
    stiffness.push_back(joint.identifiable ? io::number(joint.stiffness) : io::Json());
    deviation.push_back(io::number(joint.deviation));
    compliance.push_back(io::number(joint.compliance));
    compliance_deviation.push_back(io::number(joint.compliance_deviation));
    identifiable.push_back(joint.identifiable);
    reason.push_back(joint.reason.empty() ? io::Json() : io::Json(joint.reason));
  }
  io::Json residual = io::Json::array(), displacement = io::Json::array();
  for (Eigen::Index k = 0; k < result.residual_m.cols(); ++k)
    residual.push_back(io::numbers_in(units::mm, result.residual_m.col(k)));
  for (const Load& load : file.loads) displacement.push_back(io::numbers_in(units::mm, load.displacement_m));
  io::Json json;
  json["joint_stiffness_n_m_per_rad"] = stiffness;
  json["unit"] = unit;
  json["std"] = deviation;
  json["identifiable"] = identifiable;
  json["reason"] = reason;
  json["joint_compliance_rad_per_n_m"] = compliance;
  json["compliance_std"] = compliance_deviation;
  json["line"] = file.line;
  json["displacement_mm"] = displacement;
  json["residual_mm"] = residual;
  json["rms_mm"] = io::number(result.rms_m / units::mm);
  json["r_squared"] = io::number(result.r_squared);
  json["condition_number"] = io::number(result.condition_number);
  const bool converged = result.status == IdentifiedStiffness::Status::converged;
  json["convergence"] = {{"status", converged ? "converged" : "not converged"}, {"iterations", result.iterations}};
  return io::dump(json);
}

std::string stiffness_csv(const IdentifiedStiffness& result, const Arm& arm) {
  std::string out = "joint,stiffness,std,unit,identifiable,reason\n";
  for (std::size_t i = 0; i < result.joints.size(); ++i) {
    const IdentifiedJoint& joint = result.joints[i];
    io::add_csv_row(out,
                    {std::to_string(i + 1), joint.identifiable ? io::csv_number(joint.stiffness) : "",
                     io::csv_number(joint.deviation), unit_of(arm.joints[i]), joint.identifiable ? "true" : "false",
                     joint.reason.empty() ? "" : io::csv_text(joint.reason)});
  }
  return out;
}

std::string stiffness_toml(const IdentifiedStiffness& result, const Arm& arm) {
  std::string values, comments, unknown;
  for (std::size_t i = 0; i < result.joints.size(); ++i) {
    const IdentifiedJoint& joint = result.joints[i];
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

}  // namespace robomill::robot
