#include "robomill/modal/tip.hpp"

#include <cmath>
#include <numeric>
#include <set>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace {

bool in_plane(const Dof& dof) {
  return dof.axis == Axis::x || dof.axis == Axis::y;
}

/// 0, 1, 2 for x, y, z; -1 for a rotation.
int row_of(const Dof& dof) {
  switch (dof.axis) {
    case Axis::x:
      return 0;
    case Axis::y:
      return 1;
    case Axis::z:
      return 2;
    default:
      return -1;
  }
}

int tip_point(const ModalModel& model) {
  std::set<int> points;
  for (const auto* dofs : {&model.excitations, &model.responses}) {
    for (const Dof& dof : *dofs) {
      if (in_plane(dof)) points.insert(dof.point);
    }
  }
  if (points.empty()) throw InvalidInput("modes", "must know x or y at the tool tip");
  if (points.size() > 1 && !points.contains(0)) {
    throw InvalidInput("modes", "name several points, none of them the tool tip", "The tip carries no number");
  }
  return *points.begin();
}

/// The entries of a vector over dofs that move the point; zero where there is none.
Eigen::Vector3cd at_point(const Eigen::VectorXcd& vector, const std::vector<Dof>& dofs, int point) {
  Eigen::Vector3cd xyz = Eigen::Vector3cd::Zero();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    const int row = row_of(dofs[i]);
    if (dofs[i].point == point && row >= 0) xyz(row) = vector(static_cast<Eigen::Index>(i));
  }
  return xyz;
}

std::vector<int> kept(const ModalModel& model, const std::vector<int>& keep_modes) {
  const int count = static_cast<int>(model.modes.size());
  std::set<int> seen;
  for (const int number : keep_modes) {
    if (number < 1 || number > count) {
      throw InvalidInput("keep_modes", number, "", "must be a mode's number, 1 to " + std::to_string(count));
    }
    if (!seen.insert(number).second) throw InvalidInput("keep_modes", number, "", "is named twice");
  }
  if (!keep_modes.empty()) return keep_modes;
  std::vector<int> all(model.modes.size());
  std::iota(all.begin(), all.end(), 1);
  return all;
}

}  // namespace

TipModes tip_modes(const ModalModel& model, const std::vector<int>& keep_modes, double feed_direction_rad,
                   ModeOwner owner) {
  const int point = tip_point(model);
  const double c = std::cos(feed_direction_rad);
  const double s = std::sin(feed_direction_rad);
  Eigen::Matrix3d to_feed;
  to_feed << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;

  TipModes tip;
  for (const int number : kept(model, keep_modes)) tip.id.push_back({number, owner});
  const Eigen::Index n = static_cast<Eigen::Index>(tip.id.size());
  tip.pole.resize(n);
  tip.right.resize(3, n);
  tip.left.resize(3, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Mode& mode = model.modes[static_cast<std::size_t>(tip.id[static_cast<std::size_t>(k)].number - 1)];
    const Eigen::Vector3cd right = to_feed * at_point(mode.right, model.responses, point);
    const Eigen::Vector3cd left = to_feed * at_point(mode.left, model.excitations, point);
    const double size = 2.0 * right.norm();
    const double scale = size > 0.0 ? size : 1.0;
    tip.pole(k) = pole(mode);
    tip.right.col(k) = right / scale;
    tip.left.col(k) = left * scale;
  }

  tip.compliance.setZero();
  for (const Residual& residual : model.residuals) {
    const auto& [response, excitation] = residual.name;
    const bool here = response.point == point && excitation.point == point;
    if (!here || row_of(response) < 0 || row_of(excitation) < 0) continue;
    tip.compliance(row_of(response), row_of(excitation)) = residual.stiffness.real();
  }
  tip.compliance = (to_feed * tip.compliance * to_feed.transpose()).eval();
  return tip;
}

TipModes turned(const TipModes& modes, const Eigen::Matrix3d& turn) {
  TipModes other = modes;
  other.right = turn * modes.right;
  other.left = turn * modes.left;
  other.compliance = turn * modes.compliance * turn.transpose();
  return other;
}

const std::vector<Dof>& tip_axes() {
  static const std::vector<Dof> axes = {{.axis = Axis::x}, {.axis = Axis::y}, {.axis = Axis::z}};
  return axes;
}

ModalModel turned(const ModalModel& model, const Eigen::Matrix3d& turn) {
  const int point = tip_point(model);
  ModalModel out{.excitations = tip_axes(), .responses = tip_axes(), .modes = model.modes};
  for (std::size_t k = 0; k < out.modes.size(); ++k) {
    Mode& mode = out.modes[k];
    mode.right = turn * at_point(model.modes[k].right, model.responses, point);
    mode.left = turn * at_point(model.modes[k].left, model.excitations, point);
    normalise(mode);
  }
  if (model.residuals.empty()) return out;
  Eigen::Matrix3cd mass = Eigen::Matrix3cd::Zero();
  Eigen::Matrix3cd stiffness = Eigen::Matrix3cd::Zero();
  for (const Residual& residual : model.residuals) {
    const auto& [response, excitation] = residual.name;
    const bool here = response.point == point && excitation.point == point;
    if (!here || row_of(response) < 0 || row_of(excitation) < 0) continue;
    mass(row_of(response), row_of(excitation)) = residual.mass;
    stiffness(row_of(response), row_of(excitation)) = residual.stiffness;
  }
  mass = (turn * mass * turn.transpose()).eval();
  stiffness = (turn * stiffness * turn.transpose()).eval();
  for (const Dof& excitation : tip_axes()) {
    for (const Dof& response : tip_axes()) {
      const Eigen::Index row = row_of(response);
      const Eigen::Index column = row_of(excitation);
      out.residuals.push_back(
          {.name = {response, excitation}, .mass = mass(row, column), .stiffness = stiffness(row, column)});
    }
  }
  return out;
}

TipModes joined(const TipModes& one, const TipModes& other) {
  TipModes both = one;
  const Eigen::Index n = one.pole.size();
  const Eigen::Index m = other.pole.size();
  both.pole.conservativeResize(n + m);
  both.right.conservativeResize(3, n + m);
  both.left.conservativeResize(3, n + m);
  both.pole.tail(m) = other.pole;
  both.right.rightCols(m) = other.right;
  both.left.rightCols(m) = other.left;
  both.compliance += other.compliance;
  both.id.insert(both.id.end(), other.id.begin(), other.id.end());
  return both;
}

}  // namespace robomill::modal
