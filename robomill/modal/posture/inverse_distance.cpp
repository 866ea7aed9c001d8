#include "robomill/modal/posture/inverse_distance.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/modal/posture/assignment.hpp"

namespace robomill::modal {
namespace {

constexpr double matching_log_frequency = 0.2;  // frequencies this far apart are as bad as shapes without likeness
constexpr double no_match = 1.0;                // a pair that costs as much is none
constexpr double same_posture = 1e-9;           // [rad or m]

const std::vector<Dof>& tip_directions() {
  static const std::vector<Dof> dofs{
      {.point = 0, .axis = Axis::x}, {.point = 0, .axis = Axis::y}, {.point = 0, .axis = Axis::z}};
  return dofs;
}

/// A mode of one posture, its residue in the axes that are compared.
struct Member {
  std::size_t posture = 0;
  const Mode* mode = nullptr;
  Eigen::Matrix3cd residue = Eigen::Matrix3cd::Zero();
};
using Track = std::vector<Member>;  // the same mode in several postures

void check(const std::vector<PostureModes>& measured, const robot::Arm& arm, const Eigen::VectorXd& joints) {
  if (measured.empty()) throw InvalidInput("measured", "holds no posture");
  const auto check_joints = [&](const std::string& field, const Eigen::VectorXd& position) {
    if (position.size() != arm.size()) {
      throw InvalidInput(field, static_cast<double>(position.size()), "joints",
                         "must have one value a joint, " + std::to_string(arm.size()));
    }
    if (!position.allFinite()) throw InvalidInput(field, "holds a value that is not finite");
  };
  check_joints("joints", joints);
  for (std::size_t p = 0; p < measured.size(); ++p) {
    const std::string path = "measured[" + std::to_string(p + 1) + "].";
    check_joints(path + "joints", measured[p].joints);
    const ModalModel& model = measured[p].modes;
    try {
      model.validate();
    } catch (const InvalidInput& error) {
      throw within(path, error);
    }
    const std::vector<Dof>& dofs = tip_directions();
    if (model.responses != dofs || model.excitations.size() > dofs.size() ||
        !std::equal(model.excitations.begin(), model.excitations.end(), dofs.begin())) {
      throw InvalidInput(path + "modes",
                         "must have the responses x, y, z of the tip and excitations x, y, z or x, y or x");
    }
  }
}

/// R Lᵀ in the base axes; what was not excited follows by reciprocity.
Eigen::Matrix3cd residue_of(const Mode& mode) {
  Eigen::Vector3cd left = mode.right;
  const Eigen::Index known = mode.left.size();
  const double size = mode.right.head(known).squaredNorm();
  left *= size > 0.0 ? mode.right.head(known).dot(mode.left) / size : std::complex<double>(0.0);
  left.head(known) = mode.left;
  return mode.right * left.transpose();
}

double likeness(const Eigen::Matrix3cd& a, const Eigen::Matrix3cd& b) {
  const double size = a.squaredNorm() * b.squaredNorm();
  if (!(size > 0.0)) return 0.0;
  return std::norm((a.conjugate().array() * b.array()).sum()) / size;
}

double cost_of(const Member& a, const Member& b) {
  const double apart = std::abs(std::log(a.mode->frequency_hz / b.mode->frequency_hz)) / matching_log_frequency;
  return std::min(no_match, apart + 1.0 - likeness(a.residue, b.residue));
}

/// Gives every mode of a posture to the track that it continues, or starts one; a track is known by its first member,
/// which is of the nearest posture.
void continue_tracks(const std::vector<Member>& modes, std::vector<Track>& tracks) {
  const std::size_t before = tracks.size();
  std::vector<Eigen::Index> track_of(modes.size(), -1);
  if (before > 0 && !modes.empty()) {
    Eigen::MatrixXd cost(modes.size(), before);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      for (std::size_t j = 0; j < before; ++j) {
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = cost_of(modes[i], tracks[j].front());
      }
    }
    track_of = detail::assign(cost);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      if (track_of[i] >= 0 && cost(static_cast<Eigen::Index>(i), track_of[i]) >= no_match) track_of[i] = -1;
    }
  }
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (track_of[i] < 0) {
      tracks.push_back({modes[i]});
    } else {
      tracks[static_cast<std::size_t>(track_of[i])].push_back(modes[i]);
    }
  }
}

double own(double deviation) {
  return std::isfinite(deviation) ? deviation : 0.0;
}

/// The mean of a track, in the base axes at last.
/// @param weight    of each posture
/// @param to_base   from the axes of the residues
Mode mean_of(const Track& track, const Eigen::VectorXd& weight, const Eigen::Matrix3d& to_base) {
  double total = 0.0, log_frequency = 0.0, log_damping = 0.0;
  Eigen::Matrix3cd residue = Eigen::Matrix3cd::Zero();
  const auto weight_of = [&](const Member& member) { return weight(static_cast<Eigen::Index>(member.posture)); };
  for (const Member& member : track) total += weight_of(member);
  for (const Member& member : track) {
    const double w = weight_of(member) / total;
    log_frequency += w * std::log(member.mode->frequency_hz);
    log_damping += w * std::log(member.mode->damping_ratio);
    residue += w * member.residue;
  }
  double of_frequency = 0.0, of_damping = 0.0, of_residue = 0.0;  // relative variances
  for (const Member& member : track) {
    const double w = weight_of(member) / total;
    const Mode& mode = *member.mode;
    of_frequency += w * (std::pow(std::log(mode.frequency_hz) - log_frequency, 2) +
                         std::pow(own(mode.frequency_std_hz) / mode.frequency_hz, 2));
    of_damping += w * (std::pow(std::log(mode.damping_ratio) - log_damping, 2) +
                       std::pow(own(mode.damping_ratio_std) / mode.damping_ratio, 2));
    of_residue += w * ((member.residue - residue).squaredNorm() / std::max(residue.squaredNorm(), 1e-300) +
                       std::pow(own(mode.residue_std_ratio), 2));
  }
  const Eigen::Matrix3cd in_base = to_base.cast<std::complex<double>>() * residue * to_base.transpose();
  const linear_algebra::ComplexThinSvd svd = linear_algebra::thin_svd(Eigen::MatrixXcd(in_base));
  const double size = std::sqrt(svd.values(0));
  Mode out{.frequency_hz = std::exp(log_frequency),
           .damping_ratio = std::min(std::exp(log_damping), 0.99),
           .left = size * svd.v.col(0).conjugate(),
           .right = size * svd.u.col(0)};
  out.frequency_std_hz = out.frequency_hz * std::sqrt(of_frequency);
  out.damping_ratio_std = out.damping_ratio * std::sqrt(of_damping);
  out.residue_std_ratio = std::sqrt(of_residue);
  normalise(out);
  return out;
}

/// Residuals of a model as matrices, mass and stiffness; what was not excited by reciprocity, zz then as unknown: 0.
struct Residuals {
  Eigen::Matrix3cd mass = Eigen::Matrix3cd::Zero(), stiffness = Eigen::Matrix3cd::Zero();
};
Residuals residuals_of(const ModalModel& model) {
  Residuals out;
  const auto index = [](const Dof& dof) { return static_cast<Eigen::Index>(dof.axis) - 1; };
  for (const Residual& residual : model.residuals) {
    const Dof &to = residual.name.response, &from = residual.name.excitation;
    if (to.point != 0 || from.point != 0 || index(to) > 2 || index(from) > 2) continue;
    out.mass(index(to), index(from)) = residual.mass;
    out.stiffness(index(to), index(from)) = residual.stiffness;
    if (index(to) < static_cast<Eigen::Index>(model.excitations.size())) continue;
    out.mass(index(from), index(to)) = residual.mass;
    out.stiffness(index(from), index(to)) = residual.stiffness;
  }
  return out;
}

Eigen::Matrix3d axes_at(const robot::Arm& arm, const Eigen::VectorXd& joints, ResidueAxes axes) {
  return axes == ResidueAxes::flange ? Eigen::Matrix3d(robot::forward(arm, joints).linear())
                                     : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
}

/// 1 / d², of sum 1; a posture that is the one asked for has all of it.
Eigen::VectorXd weights(const std::vector<PostureModes>& measured, const Eigen::VectorXd& joints) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(measured.size()));
  for (std::size_t p = 0; p < measured.size(); ++p) {
    const double distance = (measured[p].joints - joints).norm();
    if (distance < same_posture) return Eigen::VectorXd::Unit(out.size(), static_cast<Eigen::Index>(p));
    out(static_cast<Eigen::Index>(p)) = 1.0 / (distance * distance);
  }
  return out / out.sum();
}

void add_residuals(const std::vector<Residuals>& residuals, const Eigen::VectorXd& weight,
                   const Eigen::Matrix3d& to_base, ModalModel& out) {
  Residuals mean;
  for (std::size_t p = 0; p < residuals.size(); ++p) {
    mean.mass += weight(static_cast<Eigen::Index>(p)) * residuals[p].mass;
    mean.stiffness += weight(static_cast<Eigen::Index>(p)) * residuals[p].stiffness;
  }
  if (mean.mass.isZero(0.0) && mean.stiffness.isZero(0.0)) return;
  const Eigen::Matrix3cd turn = to_base.cast<std::complex<double>>();
  const Eigen::Matrix3cd mass = turn * mean.mass * turn.transpose(), stiff = turn * mean.stiffness * turn.transpose();
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      out.residuals.push_back({.name = {.response = tip_directions()[static_cast<std::size_t>(i)],
                                        .excitation = tip_directions()[static_cast<std::size_t>(j)]},
                               .mass = mass(i, j),
                               .stiffness = stiff(i, j)});
    }
  }
}

}  // namespace

ModalModel inverse_distance(const std::vector<PostureModes>& measured, const robot::Arm& arm,
                            const Eigen::VectorXd& joints, ResidueAxes axes) {
  check(measured, arm, joints);
  const Eigen::VectorXd weight = weights(measured, joints);
  std::vector<std::size_t> order;  // the nearest first
  for (std::size_t p = 0; p < measured.size(); ++p) {
    if (weight(static_cast<Eigen::Index>(p)) > 0.0) order.push_back(p);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return weight(static_cast<Eigen::Index>(a)) > weight(static_cast<Eigen::Index>(b));
  });
  std::vector<Track> tracks;
  std::vector<Residuals> residuals(measured.size());
  for (const std::size_t p : order) {
    const ModalModel& model = measured[p].modes;
    const Eigen::Matrix3cd turn = axes_at(arm, measured[p].joints, axes).transpose().cast<std::complex<double>>();
    std::vector<Member> modes;
    for (const Mode& mode : model.modes) {
      modes.push_back({.posture = p, .mode = &mode, .residue = turn * residue_of(mode) * turn.transpose()});
    }
    continue_tracks(modes, tracks);
    const Residuals of = residuals_of(model);
    residuals[p] = {.mass = turn * of.mass * turn.transpose(), .stiffness = turn * of.stiffness * turn.transpose()};
  }
  ModalModel out;
  out.excitations = out.responses = tip_directions();
  const Eigen::Matrix3d to_base = axes_at(arm, joints, axes);
  for (const Track& track : tracks) {
    double known = 0.0;
    for (const Member& member : track) known += weight(static_cast<Eigen::Index>(member.posture));
    if (known >= 0.5) out.modes.push_back(mean_of(track, weight, to_base));
  }
  std::sort(out.modes.begin(), out.modes.end(),
            [](const Mode& a, const Mode& b) { return a.frequency_hz < b.frequency_hz; });
  add_residuals(residuals, weight, to_base, out);
  return out;
}

}  // namespace robomill::modal
