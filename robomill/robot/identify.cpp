#include "robomill/robot/identify.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"

namespace robomill::robot {
namespace {

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr double unseen = 1e-9;  // share of the largest column, or singular value

std::string name_of(std::size_t load, const char* member) {
  return "loads[" + std::to_string(load + 1) + "]." + member;
}

void require_loads(const Arm& arm, const std::vector<Load>& loads) {
  if (3 * static_cast<Eigen::Index>(loads.size()) < arm.size()) {
    throw InvalidInput("loads", static_cast<double>(loads.size()), "loads",
                       "must give at least as many numbers as there are joints, three each",
                       "Several postures and directions are needed");
  }
  const bool weighted = loads.front().deviation_m > 0.0;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const Load& load = loads[k];
    if (load.position.size() != arm.size()) {
      throw InvalidInput(name_of(k, "position"), static_cast<double>(load.position.size()), "joints",
                         "must have one value a joint, " + std::to_string(arm.size()));
    }
    if (!load.position.allFinite()) throw InvalidInput(name_of(k, "position"), "must be finite");
    if (!load.wrench.force_n.allFinite()) throw InvalidInput(name_of(k, "wrench.force_n"), "must be finite");
    if (!load.wrench.moment_n_m.allFinite()) throw InvalidInput(name_of(k, "wrench.moment_n_m"), "must be finite");
    if (!load.displacement_m.allFinite()) throw InvalidInput(name_of(k, "displacement_m"), "must be finite");
    require_non_negative(name_of(k, "deviation_m").c_str(), load.deviation_m, "m");
    if ((load.deviation_m > 0.0) != weighted) {
      throw InvalidInput(name_of(k, "deviation_m"), load.deviation_m, "m", "must be given for all loads or for none");
    }
  }
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// The arm under every load with some compliances, and what the displacements make of them.
class Model {
 public:
  Model(const Arm& arm, const Eigen::Vector3d& point_m, const std::vector<Load>& loads)
      : arm_(arm),
        point_m_(point_m),
        loads_(loads),
        rows_(3 * static_cast<Eigen::Index>(loads.size())),
        matrix(rows_, arm.size()),
        residual(rows_),
        weight(rows_),
        torque(Eigen::VectorXd::Zero(arm.size())),
        motion(Eigen::VectorXd::Zero(arm.size())) {
    position_.reserve(loads.size());
    double sum = 0.0;
    for (const Load& load : loads) {
      position_.push_back(load.position);
      sum += load.deviation_m * load.deviation_m;
    }
    const double mean = std::sqrt(sum / static_cast<double>(loads.size()));
    for (std::size_t k = 0; k < loads.size(); ++k) {
      weight.segment<3>(3 * static_cast<Eigen::Index>(k)).setConstant(mean > 0.0 ? mean / loads[k].deviation_m : 1.0);
    }
  }

  /// Brings the arm to rest under each load; matrix = ∂displacement/∂compliance and residual, both weighted.
  void evaluate(const Eigen::VectorXd& compliance) {
    torque.setZero();
    motion.setZero();
    for (std::size_t k = 0; k < loads_.size(); ++k) evaluate(k, compliance);
    matrix = (weight.asDiagonal() * matrix).eval();
    residual = residual.cwiseProduct(weight).eval();
  }

 private:
  void evaluate(std::size_t k, const Eigen::VectorXd& compliance) {
    const Load& load = loads_[k];
    Eigen::Matrix<double, 6, 1> force;
    force << load.wrench.force_n, load.wrench.moment_n_m;
    Jacobian jac(6, arm_.size());
    Posture posture;
    Eigen::VectorXd& position = position_[k];
    Eigen::VectorXd moment;
    Eigen::MatrixXd slope;
    constexpr int most_steps = 30;
    constexpr double smallest_step = 1e-15;
    for (int step = 0; step < most_steps; ++step) {
      posture.update(arm_, position);
      posture.jacobian(arm_, posture.flange * point_m_, jac);
      moment = jac.transpose() * force;
      slope = -(compliance.asDiagonal() * load_stiffness(jac, load.wrench));
      slope.diagonal().array() += 1.0;
      const Eigen::VectorXd change =
          linear_algebra::solve(slope, Eigen::VectorXd(load.position + compliance.cwiseProduct(moment) - position));
      position += change;
      if (!(change.cwiseAbs().maxCoeff() > smallest_step)) break;
    }
    const auto row = 3 * static_cast<Eigen::Index>(k);
    const Eigen::MatrixXd turned = linear_algebra::solve(slope, Eigen::MatrixXd(moment.asDiagonal()));
    matrix.middleRows<3>(row) = jac.topRows<3>() * turned;
    const Eigen::Vector3d moved = posture.flange * point_m_ - forward(arm_, load.position) * point_m_;
    residual.segment<3>(row) = load.displacement_m - moved;
    torque = torque.cwiseMax(moment.cwiseAbs());
    motion = motion.cwiseMax(jac.topRows<3>().colwise().norm().transpose());
  }

  const Arm& arm_;
  const Eigen::Vector3d point_m_;
  const std::vector<Load>& loads_;
  const Eigen::Index rows_;
  std::vector<Eigen::VectorXd> position_;

 public:
  Eigen::MatrixXd matrix;    // 3 loads x n
  Eigen::VectorXd residual;  // 3 loads
  Eigen::VectorXd weight;    // 3 loads, mean about 1
  Eigen::VectorXd torque;    // largest of each joint under any load
  Eigen::VectorXd motion;    // largest of the point when a joint moves
};

/// One scaled least squares.
struct Solved {
  Eigen::VectorXd step;     // n, zero where not free
  Eigen::MatrixXd inverse;  // n x n, (AᵀA)⁻¹ of the free ones, as far as it exists
  Eigen::VectorXd unknown;  // n, share of each joint in what the data do not determine
  Eigen::Index rank = 0;
  double condition = 0.0;
};
Solved solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right, const std::vector<Eigen::Index>& free) {
  const Eigen::Index n = matrix.cols();
  Solved out{
      .step = Eigen::VectorXd::Zero(n), .inverse = Eigen::MatrixXd::Zero(n, n), .unknown = Eigen::VectorXd::Zero(n)};
  if (free.empty()) return out;
  Eigen::MatrixXd part = matrix(Eigen::all, free);
  const Eigen::VectorXd length = part.colwise().norm();
  part = (part * length.cwiseInverse().asDiagonal()).eval();
  const linear_algebra::ThinSvd svd = linear_algebra::thin_svd(part);
  const Eigen::VectorXd& values = svd.values;
  out.condition = values(0) / values(values.size() - 1);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(part.cols(), part.cols());
  Eigen::VectorXd step = Eigen::VectorXd::Zero(part.cols());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const Eigen::VectorXd v = svd.v.col(k);
    if (values(k) > unseen * values(0)) {
      ++out.rank;
      step += v * (svd.u.col(k).dot(right) / values(k));
      inverse += v * v.transpose() / (values(k) * values(k));
    } else {
      for (std::size_t i = 0; i < free.size(); ++i) {
        out.unknown(free[i]) = std::max(out.unknown(free[i]), std::abs(v(static_cast<Eigen::Index>(i))));
      }
    }
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto a = static_cast<Eigen::Index>(i);
    out.step(free[i]) = step(a) / length(a);
    for (std::size_t j = 0; j < free.size(); ++j) {
      const auto b = static_cast<Eigen::Index>(j);
      out.inverse(free[i], free[j]) = inverse(a, b) / (length(a) * length(b));
    }
  }
  return out;
}

/// The fit while it runs.
struct Fit {
  const IdentifyOptions& options;
  Model model;
  Eigen::VectorXd compliance;
  Solved solved = {};
  int iterations = 0;

  /// Gauss-Newton over the free joints; the others stay as they are.
  bool run(const std::vector<Eigen::Index>& free) {
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < options.max_iterations; ++k) {
      ++iterations;
      model.evaluate(compliance);
      solved = solve(model.matrix, model.residual, free);
      compliance += solved.step;
      if (!compliance.allFinite()) return false;
      const double change = solved.step.cwiseAbs().maxCoeff() / compliance.cwiseAbs().maxCoeff();
      // Rounding of the poses may stand in the way of a smaller change.
      const bool at_rounding = change < 1e-7 && change >= 0.5 * last;
      if (!(change > options.tolerance) || at_rounding) {
        model.evaluate(compliance);
        return true;
      }
      last = change;
    }
    return false;
  }

  /// Variance of one number of weight 1; infinite where as many were measured as are sought.
  [[nodiscard]] double variance() const {
    const Eigen::Index left = model.residual.size() - solved.rank;
    return left > 0 ? model.residual.squaredNorm() / static_cast<double>(left)
                    : std::numeric_limits<double>::infinity();
  }
};

/// Joints whose compliance the displacements show at all; gives the reason for the others.
std::vector<Eigen::Index> seen_joints(const Fit& fit, const Arm& arm, std::vector<IdentifiedJoint>& joints) {
  const Eigen::VectorXd length = fit.model.matrix.colwise().norm();
  double most[2] = {0.0, 0.0}, torque[2] = {0.0, 0.0};  // of revolute and prismatic joints: their units differ
  for (Eigen::Index i = 0; i < arm.size(); ++i) {
    const int kind = arm.joints[static_cast<std::size_t>(i)].prismatic ? 1 : 0;
    most[kind] = std::max(most[kind], length(i));
    torque[kind] = std::max(torque[kind], fit.model.torque(i));
  }
  std::vector<Eigen::Index> out;
  for (Eigen::Index i = 0; i < arm.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int kind = arm.joints[at].prismatic ? 1 : 0;
    if (length(i) > unseen * most[kind]) {
      out.push_back(i);
    } else if (!(fit.model.torque(i) > unseen * torque[kind])) {
      joints[at].reason = "no load turns this joint";
    } else {
      joints[at].reason = "where loads turn this joint the point does not move";
    }
  }
  return out;
}

/// The joint whose compliance goes most with that of joint i.
std::string partner(const Eigen::MatrixXd& inverse, Eigen::Index i) {
  double most = 0.9;
  Eigen::Index found = -1;
  for (Eigen::Index j = 0; j < inverse.cols(); ++j) {
    const double size = std::sqrt(inverse(i, i) * inverse(j, j));
    if (j == i || !(size > 0.0) || std::abs(inverse(i, j)) / size <= most) continue;
    most = std::abs(inverse(i, j)) / size;
    found = j;
  }
  return found < 0 ? "" : "; the loads hardly separate it from joint " + std::to_string(found + 1);
}

void judge(const Eigen::VectorXd& compliance, const Solved& solved, double variance, const IdentifyOptions& options,
           std::vector<IdentifiedJoint>& joints) {
  for (std::size_t at = 0; at < joints.size(); ++at) {
    IdentifiedJoint& joint = joints[at];
    const auto i = static_cast<Eigen::Index>(at);
    if (!joint.reason.empty()) continue;
    joint.compliance = compliance(i);
    joint.compliance_deviation = std::sqrt(variance * solved.inverse(i, i));
    constexpr double share = 1e-6;
    if (solved.unknown(i) > share) {
      joint.compliance_deviation = std::numeric_limits<double>::infinity();
      joint.reason = "the loads do not separate it from";
      for (Eigen::Index j = 0; j < solved.unknown.size(); ++j) {
        if (j != i && solved.unknown(j) > share) joint.reason += " joint " + std::to_string(j + 1);
      }
    } else if (!std::isfinite(variance)) {
      joint.reason = "as many numbers were measured as are sought: their accuracy is unknown";
    } else if (joint.compliance_deviation > options.max_relative_deviation * joint.compliance) {
      joint.reason = "its compliance is " + number(joint.compliance) + " with a deviation of " +
                     number(joint.compliance_deviation) + partner(solved.inverse, i);
    } else {
      joint.identifiable = true;
      joint.stiffness = 1.0 / joint.compliance;
      joint.deviation = joint.compliance_deviation * joint.stiffness * joint.stiffness;
    }
  }
}

}  // namespace

void IdentifyOptions::validate() const {
  require_positive("max_relative_deviation", max_relative_deviation, "");
  require_positive("tolerance", tolerance, "");
  if (max_iterations < 1) throw InvalidInput("max_iterations", max_iterations, "", "must be >= 1");
}

IdentifiedStiffness identify_joint_stiffness(const Arm& arm, const Eigen::Vector3d& point_m,
                                             const std::vector<Load>& loads, const IdentifyOptions& options) {
  options.validate();
  arm.validate();
  if (!point_m.allFinite()) throw InvalidInput("point_m", "must be finite");
  require_loads(arm, loads);
  IdentifiedStiffness out;
  out.joints.resize(arm.joints.size());
  Fit fit{.options = options, .model = Model(arm, point_m, loads), .compliance = Eigen::VectorXd::Zero(arm.size())};
  fit.model.evaluate(fit.compliance);
  std::vector<Eigen::Index> free = seen_joints(fit, arm, out.joints);
  bool converged = fit.run(free);
  // Deviations are those of all joints together: taking one as rigid does not make its neighbours known better.
  const Solved all = fit.solved;
  const double variance = fit.variance();
  // The softest below nothing becomes rigid, until there is none.
  while (converged && !free.empty()) {
    const auto worst = std::min_element(free.begin(), free.end(), [&](Eigen::Index a, Eigen::Index b) {
      return fit.compliance(a) * fit.model.matrix.col(a).norm() < fit.compliance(b) * fit.model.matrix.col(b).norm();
    });
    if (fit.compliance(*worst) > 0.0) break;
    IdentifiedJoint& joint = out.joints[static_cast<std::size_t>(*worst)];
    joint.compliance = fit.compliance(*worst);
    joint.compliance_deviation = std::sqrt(variance * all.inverse(*worst, *worst));
    joint.reason = "its compliance comes out as " + number(joint.compliance) + " with a deviation of " +
                   number(joint.compliance_deviation) + ": it is taken as rigid";
    fit.compliance(*worst) = 0.0;
    free.erase(worst);
    converged = fit.run(free);
  }
  out.status = converged ? IdentifiedStiffness::Status::converged : IdentifiedStiffness::Status::not_converged;
  out.iterations = fit.iterations;
  out.condition_number = all.condition;
  if (converged) judge(fit.compliance, all, variance, options, out.joints);
  const Eigen::VectorXd plain = fit.model.residual.cwiseQuotient(fit.model.weight);
  out.residual_m = Eigen::Map<const Eigen::Matrix3Xd>(plain.data(), 3, plain.size() / 3);
  out.rms_m = std::sqrt(fit.model.residual.squaredNorm() / static_cast<double>(plain.size()));
  double total = 0.0;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    total += (fit.model.weight(3 * static_cast<Eigen::Index>(k)) * loads[k].displacement_m).squaredNorm();
  }
  out.r_squared = total > 0.0 ? 1.0 - fit.model.residual.squaredNorm() / total : 0.0;
  return out;
}

}  // namespace robomill::robot
