#include "robomill/robot/files/stiffness_files.hpp"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/csv.hpp"

namespace robomill::robot {
namespace {

const char* unit_of(const Joint& joint) {
  return joint.prismatic ? "N/m" : "N m/rad";
}

using io::key;
using io::Row;
using io::Schema;
using View = StiffnessView;

/// A list with an entry a joint.
template <class F>
Row<View> of_joints(const std::string& name, F value, const std::string& meaning) {
  return key(
      name,
      [value](const View& view) {
        std::vector<decltype(value(view.found->joints.front()))> out;
        for (const IdentifiedJoint& joint : view.found->joints) out.push_back(value(joint));
        return out;
      },
      meaning);
}

const Schema<IdentifiedStiffness>& convergence_table() {
  using Status = IdentifiedStiffness::Status;
  static constexpr Name<Status> names[] = {{"converged", Status::converged}, {"not converged", Status::not_converged}};
  static const Schema<IdentifiedStiffness> table("convergence", "of the search",
                                                 {key("status", &IdentifiedStiffness::status, names, "how it ended"),
                                                  key("iterations", &IdentifiedStiffness::iterations, "how many")},
                                                 io::Use::written);
  return table;
}

std::vector<Row<View>> joint_keys() {
  return {of_joints(
              "joint_stiffness_n_m_per_rad",
              [](const IdentifiedJoint& joint) {
                return joint.identifiable ? std::optional(joint.stiffness) : std::nullopt;
              },
              "of each joint, in its unit; none: not identifiable")
              .nullable(),
          key(
              "unit",
              [](const View& view) {
                std::vector<std::string> out;
                for (const Joint& joint : view.arm->joints) out.emplace_back(unit_of(joint));
                return out;
              },
              "of each joint's stiffness")
              .words({"N m/rad", "N/m"}),
          of_joints(
              "std", [](const IdentifiedJoint& joint) { return joint.deviation; }, "of the stiffness")
              .nullable(),
          of_joints(
              "identifiable", [](const IdentifiedJoint& joint) { return joint.identifiable; }, "by the loads"),
          of_joints(
              "reason",
              [](const IdentifiedJoint& joint) {
                return joint.reason.empty() ? std::nullopt : std::optional(joint.reason);
              },
              "why not")
              .nullable(),
          of_joints(
              "joint_compliance_rad_per_n_m", [](const IdentifiedJoint& joint) { return joint.compliance; },
              "inverse of the stiffness")
              .nullable(),
          of_joints(
              "compliance_std", [](const IdentifiedJoint& joint) { return joint.compliance_deviation; },
              "of the compliance")
              .nullable()};
}

}  // namespace

const Schema<View>& stiffness_table() {
  static const Schema<View> table(
      "stiffness", "joint stiffness, from loads and the displacements measured",
      [] {
        std::vector<Row<View>> rows = joint_keys();
        const auto found = [](auto IdentifiedStiffness::*member) {
          return [member](const View& view) { return view.found->*member; };
        };
        add_rows(
            rows,
            {key(
                 "line", [](const View& view) { return view.loads->line; }, "of each load in its file"),
             key(
                 "displacement_mm",
                 [](const View& view) {
                   std::vector<Eigen::Vector3d> out;
                   for (const Load& load : view.loads->loads) out.emplace_back(load.displacement_m);
                   return out;
                 },
                 "measured, of each load")
                 .entries(3),
             key(
                 "residual_mm", [](const View& view) { return Eigen::MatrixXd(view.found->residual_m.transpose()); },
                 "measured less model, of each load")
                 .entries(3)
                 .nullable(),
             key("rms_mm", found(&IdentifiedStiffness::rms_m), "of the residuals").nullable(),
             key("r_squared", found(&IdentifiedStiffness::r_squared), "share of the displacements that is explained")
                 .nullable(),
             key("condition_number", found(&IdentifiedStiffness::condition_number), "of the least squares").nullable(),
             key(
                 "convergence", [](const View& view) { return view.found; }, convergence_table(), "of the search")});
        return rows;
      }(),
      io::Use::written, 1);
  return table;
}

std::string stiffness_json(const IdentifiedStiffness& result, const Arm& arm, const LoadsFile& file) {
  return io::dump(stiffness_table().write({.found = &result, .arm = &arm, .loads = &file}));
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
