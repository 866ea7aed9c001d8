#include "robomill/coupling/joint_knowledge.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace robomill::coupling::detail {
namespace {

using Eigen::Index;
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, joint_unknowns>;

/// A model that misses more than this share of what was measured says nothing.
constexpr double no_fit = 0.3;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::array<const char*, joint_unknowns> units = {"N/m", "N s/m", "N m/rad", "N m s/rad"};

/// By flexibility, damping, flexibility, damping.
Jacobian jacobian(const JointModel& model, const JointValues& joint, const JointData& data) {
  JointModel::Response response;
  model.sensitivity(joint, response);
  const Index n = model.lines();
  Jacobian out(2 * n, joint_unknowns);
  for (Index j = 0; j < 2; ++j) {
    const std::size_t k = static_cast<std::size_t>(j);
    const double slope = joint[2 * k] * joint[2 * k];
    const Eigen::ArrayXd real = response.along_real[k].head(n) / data.deviation;
    const Eigen::ArrayXd imag = response.along_imag[k].head(n) / data.deviation;
    out.col(2 * j).head(n) = slope * real;
    out.col(2 * j).tail(n) = slope * imag;
    out.col(2 * j + 1).head(n) = model.omega() * imag;
    out.col(2 * j + 1).tail(n) = -model.omega() * real;
  }
  return out;
}

/// How many neighbouring lines carry the same information: 1 + 2 Σ ρ over the lags until ρ is lost in the noise.
double correlation_length(const Eigen::VectorXd& residual) {
  const Index n = residual.size() / 2;
  const double square = residual.squaredNorm();
  if (square <= 0.0) return 1.0;
  double length = 1.0;
  for (Index lag = 1; lag < n; ++lag) {
    const double product = residual.head(n - lag).dot(residual.segment(lag, n - lag)) +
                           residual.tail(n).head(n - lag).dot(residual.tail(n - lag));
    const double correlation = product / square;
    if (correlation < 2.0 / std::sqrt(static_cast<double>(n))) break;
    length += 2.0 * correlation;
  }
  return length;
}

/// Standard deviations of flexibilities and dampings; infinite where a column says nothing.
std::array<double, joint_unknowns> deviations(const Jacobian& columns, const std::array<bool, joint_unknowns>& free,
                                              double variance) {
  std::vector<Index> used;
  for (Index i = 0; i < joint_unknowns; ++i) {
    if (free[static_cast<std::size_t>(i)] && columns.col(i).norm() > 0.0) used.push_back(i);
  }
  std::array<double, joint_unknowns> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = free[i] ? infinite : 0.0;
  if (used.empty()) return out;
  const Eigen::VectorXd scale = columns(Eigen::all, used).colwise().norm().transpose();
  const Eigen::MatrixXd scaled = columns(Eigen::all, used) * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = Eigen::FullPivLU<Eigen::MatrixXd>(scaled.transpose() * scaled).inverse();
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Index at = static_cast<Index>(i);
    const double square = inverse(at, at) * variance;
    if (square >= 0.0 && std::isfinite(square)) out[static_cast<std::size_t>(used[i])] = std::sqrt(square) / scale(at);
  }
  return out;
}

/// By how much a step of Gauss and Newton in the unknowns that no bound holds would lower Σ |residual|².
double decrement(const Jacobian& columns, const std::array<bool, joint_unknowns>& moves,
                 const Eigen::VectorXd& residual) {
  std::vector<Index> used;
  for (Index i = 0; i < joint_unknowns; ++i) {
    if (moves[static_cast<std::size_t>(i)] && columns.col(i).norm() > 0.0) used.push_back(i);
  }
  if (used.empty()) return 0.0;
  const Eigen::VectorXd scale = columns(Eigen::all, used).colwise().norm().transpose();
  const Eigen::MatrixXd scaled = columns(Eigen::all, used) * scale.cwiseInverse().asDiagonal();
  const Eigen::VectorXd gradient = scaled.transpose() * residual;
  return gradient.dot((scaled.transpose() * scaled).completeOrthogonalDecomposition().solve(gradient));
}

bool at_bound(double value, double bound) {
  return std::abs(value - bound) <= 1e-6 * std::abs(bound);
}

/// What the FRF says of a stiffness that it does not bound from both sides.
/// @param bound  where it ends; 0: at none
std::string note_of_stiffness(std::size_t i, double value, const JointKnowledge& known, double bound) {
  const std::string name = to_string(static_cast<JointUnknown>(i));
  if (std::isinf(known.deviation)) {
    return fmt::format("Above {:.3g} {} this FRF does not separate the {} from a rigid one.", known.visible_up_to,
                       units[i], name);
  }
  if (bound > 0.0) {
    return fmt::format("The {} ends at its bound of {:.4g} {}: the joint may lie beyond it.", name, bound, units[i]);
  }
  return fmt::format("The {} is below {:.3g} {}; more this FRF does not show.", name, value + 2.0 * known.deviation,
                     units[i]);
}

using Flags = std::array<bool, joint_unknowns>;

/// Why nothing can be said of deviations; empty where it can.
std::string why_no_deviations(const Jacobian& columns, const Flags& moves, const Eigen::VectorXd& residual,
                              double variance, const JointData& data) {
  const double misfit = (residual.array() * data.deviation.replicate(2, 1)).matrix().norm() / data.measured.norm();
  if (misfit > no_fit) {
    return fmt::format(
        "The assembly cannot give this FRF with any joint found: it misses {:.0f} % of it. Are units, tool and holder "
        "right?",
        100.0 * misfit);
  }
  if (decrement(columns, moves, residual) > variance) {
    return "The search ended beside the best joint, so that nothing can be said of deviations: --method hybrid goes "
           "on.";
  }
  return {};
}

void report_nothing(const Flags& free, std::array<JointKnowledge, joint_unknowns>& knowledge) {
  for (std::size_t i = 0; i < knowledge.size(); ++i) {
    if (!free[i]) continue;
    knowledge[i].deviation = infinite;
    if (i % 2 == 0) knowledge[i].visible_up_to = infinite;
    knowledge[i].note = to_string(static_cast<JointUnknown>(i)) + ": not determined by this search";
  }
}

}  // namespace

std::array<JointKnowledge, joint_unknowns> joint_knowledge(const JointModel& model, const JointValues& joint,
                                                           const JointData& data, const JointFitOptions& options,
                                                           std::vector<std::string>& notes) {
  Flags free{}, moves{};
  for (std::size_t i = 0; i < free.size(); ++i) {
    free[i] = options.lower[i] < options.upper[i];
    moves[i] = free[i] && !at_bound(joint[i], options.lower[i]) && !at_bound(joint[i], options.upper[i]);
  }
  const Eigen::VectorXd residual = joint_residuals(model, joint, data);
  const double spare = static_cast<double>(residual.size() - std::ranges::count(free, true));
  // A complex line's σ² is that of its real and imaginary parts together.
  const double random = std::max(0.5, residual.squaredNorm() / spare * correlation_length(residual));
  // An error that all lines share, at its worst, is not averaged out.
  const double shared = (data.noise_floor * data.measured.cwiseAbs().array() / data.deviation).square().sum();
  const double variance = std::max(random, shared);
  const Jacobian columns = jacobian(model, joint, data);
  std::array<JointKnowledge, joint_unknowns> knowledge;
  const std::string reason = why_no_deviations(columns, moves, residual, variance, data);
  if (!reason.empty()) {
    notes.push_back(reason);
    report_nothing(free, knowledge);
    return knowledge;
  }
  const std::array<double, joint_unknowns> deviation = deviations(columns, free, variance);
  for (std::size_t i = 0; i < knowledge.size(); ++i) {
    JointKnowledge& known = knowledge[i];
    const std::string name = to_string(static_cast<JointUnknown>(i));
    const bool stiffness = i % 2 == 0;
    known.deviation = stiffness ? deviation[i] * joint[i] * joint[i] : deviation[i];
    if (stiffness) known.visible_up_to = deviation[i] > 0.0 ? 0.5 / deviation[i] : infinite;
    if (!free[i]) {
      known.note = name + ": given, not fitted";
      continue;
    }
    known.identifiable = moves[i] && 2.0 * known.deviation < joint[i];
    if (known.identifiable) continue;
    known.note = name + ": not identifiable from this FRF";
    if (!stiffness) {
      const double most = joint[i] + 2.0 * known.deviation;
      if (most < options.upper[i]) {
        notes.push_back(fmt::format("The {} is below {:.3g} {}; more this FRF does not show.", name, most, units[i]));
      }
      continue;
    }
    JointValues rigid = joint;
    rigid[i] = std::max(1e15, joint[i]);
    const double rise = joint_residuals(model, rigid, data).squaredNorm() - residual.squaredNorm();
    if (rise < 4.0 * variance) known.deviation = infinite;
    const double bound = at_bound(joint[i], options.lower[i]) ? options.lower[i] : options.upper[i];
    notes.push_back(note_of_stiffness(i, joint[i], known, moves[i] ? 0.0 : bound));
  }
  return knowledge;
}

}  // namespace robomill::coupling::detail
