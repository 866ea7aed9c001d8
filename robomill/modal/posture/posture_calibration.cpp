#include "robomill/modal/posture/posture_calibration.hpp"

#include <complex>

#include "robomill/base/digest.hpp"
#include "robomill/version.hpp"

namespace robomill::modal {
namespace {

/// Raised whenever a calibration of the same inputs comes to other numbers.
constexpr int method = 1;

// Structured bindings name every member: one that is added must be decided upon here.

void add(Digest& out, const Eigen::Ref<const Eigen::VectorXd>& values) {
  out.count(static_cast<std::uint64_t>(values.size()));
  for (const double value : values) out.number(value);
}

void add(Digest& out, const Eigen::Ref<const Eigen::VectorXcd>& values) {
  add(out, Eigen::VectorXd(values.real()));
  add(out, Eigen::VectorXd(values.imag()));
}

void add(Digest& out, const Eigen::Isometry3d& pose) {
  const Eigen::Matrix4d& matrix = pose.matrix();
  add(out, Eigen::Map<const Eigen::VectorXd>(matrix.data(), matrix.size()));
}

void add(Digest& out, const robot::Link& link) {
  const auto& [mass_kg, center_m, inertia_kg_m2] = link;
  out.number(mass_kg);
  add(out, center_m);
  add(out, Eigen::Map<const Eigen::VectorXd>(inertia_kg_m2.data(), inertia_kg_m2.size()));
}

void add(Digest& out, const robot::Joint& joint) {
  const auto& [name, prismatic, before, axis, min_position, max_position, max_velocity, max_acceleration, max_jerk,
               stiffness, damping, rotor_inertia, max_torque, link] = joint;
  out.count(prismatic ? 1 : 0);
  add(out, before);
  add(out, axis);
  for (const double value : {stiffness, damping, rotor_inertia}) out.number(value);
  add(out, link);
}

void add(Digest& out, const FrfName& name) {
  for (const Dof& dof : {name.response, name.excitation}) {
    out.count(static_cast<std::uint64_t>(dof.point));
    out.count(static_cast<std::uint64_t>(dof.axis));
  }
}

void add(Digest& out, const FrfSet& set) {
  add(out, set.frequency_hz);
  out.count(set.frfs.size());
  for (const Frf& frf : set.frfs) {
    const auto& [name, receptance, coherence, deviation] = frf;
    add(out, name);
    add(out, receptance);
  }
}

void add(Digest& out, const Mode& mode) {
  const auto& [frequency_hz, damping_ratio, left, right, frequency_std_hz, damping_ratio_std, residue_std_ratio, weak] =
      mode;
  out.number(frequency_hz);
  out.number(damping_ratio);
  add(out, left);
  add(out, right);
}

void add(Digest& out, const ModalModel& model) {
  const auto& [excitations, responses, modes, residuals] = model;
  out.count(excitations.size());
  for (const Dof& dof : excitations) add(out, FrfName{dof, dof});
  out.count(responses.size());
  for (const Dof& dof : responses) add(out, FrfName{dof, dof});
  out.count(modes.size());
  for (const Mode& mode : modes) add(out, mode);
  out.count(residuals.size());
  for (const auto& [name, mass, stiffness] : residuals) {
    add(out, name);
    for (const double value : {mass.real(), mass.imag(), stiffness.real(), stiffness.imag()}) out.number(value);
  }
}

void add(Digest& out, const MeasuredPosture& posture) {
  const auto& [name, joints, frfs, modes] = posture;
  add(out, joints);
  out.count(modes ? 1 : 0);
  modes ? add(out, *modes) : add(out, frfs);
}

}  // namespace

std::string calibration_fingerprint(const robot::Cell& cell, const std::optional<robot::Link>& payload,
                                    const std::vector<MeasuredPosture>& measured, const PostureModelOptions& options) {
  const auto& [arm, workpiece, tool_length_m] = cell;
  const auto& [all_joints, flange] = arm;
  const auto& [band_low_hz, band_high_hz] = options;
  Digest out;
  out.text(ROBOMILL_VERSION);
  out.count(method);
  out.count(all_joints.size());
  for (const robot::Joint& joint : all_joints) add(out, joint);
  add(out, flange);
  out.number(tool_length_m);
  out.count(payload ? 1 : 0);
  if (payload) add(out, *payload);
  out.count(measured.size());
  for (const MeasuredPosture& posture : measured) add(out, posture);
  out.number(band_low_hz);
  out.number(band_high_hz);
  return out.hex();
}

}  // namespace robomill::modal
