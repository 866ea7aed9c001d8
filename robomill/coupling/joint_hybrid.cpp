#include "robomill/coupling/joint_hybrid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>

#include "robomill/base/random.hpp"
#include "robomill/modal/fitting/least_squares.hpp"

namespace robomill::coupling::detail {
namespace {

using Eigen::Index;
using Coordinates = pagmo::vector_double;

constexpr std::size_t thinned_count = 256;
constexpr unsigned individuals = 40;
constexpr unsigned generations = 100;
constexpr double differential_weight = 0.7;
constexpr double crossover_rate = 0.9;
// Of the search, refined on the thinned lines: no two nearer to each other than a factor of e in every unknown.
constexpr std::size_t candidates = 6;
constexpr double least_apart = 1.0;

/// Where least squares and evolution look at the unknowns: x = arsinh(flexibility / unit) of a stiffness, x =
/// arsinh(damping / unit) of a damping. Far above the unit that is a logarithm; below it is linear, and the rigid and
/// the undamped joint are ordinary points at 0.
struct Scale {
  std::array<double, joint_unknowns> unit{};

  [[nodiscard]] static bool is_stiffness(std::size_t i) { return i % 2 == 0; }
  [[nodiscard]] double to(std::size_t i, double value) const {
    return std::asinh((is_stiffness(i) ? 1.0 / value : value) / unit[i]);
  }
  [[nodiscard]] double from(std::size_t i, double x) const {
    const double value = unit[i] * std::sinh(x);
    return is_stiffness(i) ? 1.0 / value : value;
  }
  /// Of the flexibility or damping.
  [[nodiscard]] double slope(std::size_t i, double x) const { return unit[i] * std::cosh(x); }
};

struct Bounds {
  JointValues lower, upper;
  [[nodiscard]] double hold(std::size_t i, double value) const { return std::clamp(value, lower[i], upper[i]); }
};

/// A flexibility that changes the FRF of the rigid joint by a thousandth of itself, and a damping that would be a
/// hundredth of the softest joint's stiffness at the highest line.
Scale search_scale(const JointModel& model, const Bounds& bounds) {
  constexpr double visible = 1e-3;
  constexpr double rigid = 1e13;
  JointModel::Response response;
  model.sensitivity({rigid, 0.0, rigid, 0.0}, response);
  const Index n = model.lines();
  const Eigen::ArrayXd size = (response.real.head(n).square() + response.imag.head(n).square()).sqrt();
  Scale scale;
  for (std::size_t j = 0; j < 2; ++j) {
    const Eigen::ArrayXd along =
        (response.along_real[j].head(n).square() + response.along_imag[j].head(n).square()).sqrt() * (rigid * rigid);
    const double mean = std::sqrt((along / size.max(std::numeric_limits<double>::min())).square().mean());
    scale.unit[2 * j] = std::clamp(visible / mean, 1.0 / bounds.upper[2 * j], 1.0 / bounds.lower[2 * j]);
    scale.unit[2 * j + 1] = 0.01 * bounds.lower[2 * j] / model.omega()(n - 1);
  }
  return scale;
}

/// pagmo's view: the mean over lines of |H - H model|² / (|H|² + |H model|²), which no line can spoil.
class BoundedProblem {
 public:
  BoundedProblem() = default;
  BoundedProblem(const JointModel& model, const Eigen::ArrayXd& real, const Eigen::ArrayXd& imag, const Scale& scale,
                 const Bounds& bounds, JointModel::Response& scratch, Progress& progress)
      : model_(&model),
        real_(&real),
        imag_(&imag),
        scale_(&scale),
        bounds_(&bounds),
        scratch_(&scratch),
        progress_(&progress) {}

  [[nodiscard]] JointValues joint(const Coordinates& x) const {
    JointValues values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = bounds_->hold(i, scale_->from(i, x[i]));
    return values;
  }
  [[nodiscard]] pagmo::vector_double fitness(const Coordinates& x) const {
    progress_->check();
    const JointValues values = joint(x);
    if (!model_->allows(values)) return {2.0};
    model_->receptance(values, *scratch_);
    const Index n = model_->lines();
    const auto real = scratch_->real.head(n);
    const auto imag = scratch_->imag.head(n);
    return {(((real - *real_).square() + (imag - *imag_).square()) /
             (real.square() + imag.square() + real_->square() + imag_->square() + std::numeric_limits<double>::min()))
                .mean()};
  }
  [[nodiscard]] std::pair<Coordinates, Coordinates> get_bounds() const {
    Coordinates lower;
    Coordinates upper;
    for (std::size_t i = 0; i < joint_unknowns; ++i) {
      lower.push_back(scale_->to(i, bounds_->lower[i]));
      upper.push_back(scale_->to(i, bounds_->upper[i]));
      if (lower[i] > upper[i]) std::swap(lower[i], upper[i]);
    }
    return {lower, upper};
  }

 private:
  const JointModel* model_ = nullptr;
  const Eigen::ArrayXd *real_ = nullptr, *imag_ = nullptr;
  const Scale* scale_ = nullptr;
  const Bounds* bounds_ = nullptr;
  JointModel::Response* scratch_ = nullptr;
  Progress* progress_ = nullptr;
};

/// Complex residuals (H model - H) / σ, real parts first.
class Residuals : public ceres::CostFunction {
 public:
  Residuals(const JointModel& model, const JointData& data, const Scale& scale)
      : model_(model), data_(data), scale_(scale), inverse_(data.deviation.inverse()) {
    set_num_residuals(static_cast<int>(2 * model.lines()));
    mutable_parameter_block_sizes()->push_back(joint_unknowns);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    JointValues joint{};
    for (std::size_t i = 0; i < joint.size(); ++i) joint[i] = scale_.from(i, parameters[0][i]);
    if (!model_.allows(joint)) return false;
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    if (derivatives) {
      model_.sensitivity(joint, response_);
    } else {
      model_.receptance(joint, response_);
    }
    const Index n = model_.lines();
    Eigen::Map<Eigen::ArrayXd> out(residuals, 2 * n);
    out.head(n) = (response_.real.head(n) - data_.measured.real().array()) * inverse_;
    out.tail(n) = (response_.imag.head(n) - data_.measured.imag().array()) * inverse_;
    if (!derivatives) return true;
    Eigen::Map<Eigen::Array<double, Eigen::Dynamic, joint_unknowns, Eigen::RowMajor>> jacobian(jacobians[0], 2 * n,
                                                                                               joint_unknowns);
    for (Index j = 0; j < 2; ++j) {
      const std::size_t k = static_cast<std::size_t>(2 * j);
      const Eigen::ArrayXd real = response_.along_real[k / 2].head(n) * inverse_;
      const Eigen::ArrayXd imag = response_.along_imag[k / 2].head(n) * inverse_;
      const double to_stiffness = joint[k] * joint[k] * scale_.slope(k, parameters[0][k]);
      const double to_damping = scale_.slope(k + 1, parameters[0][k + 1]);
      jacobian.col(2 * j).head(n) = to_stiffness * real;
      jacobian.col(2 * j).tail(n) = to_stiffness * imag;
      jacobian.col(2 * j + 1).head(n) = to_damping * model_.omega() * imag;
      jacobian.col(2 * j + 1).tail(n) = -to_damping * model_.omega() * real;
    }
    return true;
  }

 private:
  const JointModel& model_;
  const JointData& data_;
  const Scale& scale_;
  Eigen::ArrayXd inverse_;
  mutable JointModel::Response response_;
};

struct Refined {
  JointValues joint{};
  double cost = 0.0;          // Σ |residual|²
  std::vector<double> costs;  // after each step
  bool converged = false;
};

Refined refine(const JointModel& model, const JointData& data, const JointValues& start, const Bounds& bounds,
               int max_iterations, Progress& progress) {
  // Units at the start: steps are neither all logarithmic nor all linear.
  Scale scale;
  for (std::size_t i = 0; i < joint_unknowns; i += 2) {
    scale.unit[i] = 1.0 / start[i];
    scale.unit[i + 1] = start[i + 1] + 0.01 * start[i] / model.omega()(model.lines() - 1);
  }
  std::array<double, joint_unknowns> x{};
  std::vector<int> fixed;
  ceres::Problem problem;
  problem.AddResidualBlock(new Residuals(model, data, scale), nullptr, x.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = scale.to(i, start[i]);
    if (bounds.lower[i] == bounds.upper[i]) {
      fixed.push_back(static_cast<int>(i));
      continue;
    }
    const auto ends = std::minmax({scale.to(i, bounds.lower[i]), scale.to(i, bounds.upper[i])});
    x[i] = std::clamp(x[i], ends.first, ends.second);
    problem.SetParameterLowerBound(x.data(), static_cast<int>(i), ends.first);
    problem.SetParameterUpperBound(x.data(), static_cast<int>(i), ends.second);
  }
  Refined refined;
  if (fixed.size() == x.size()) {
    problem.SetParameterBlockConstant(x.data());
  } else if (!fixed.empty()) {
    problem.SetManifold(x.data(), new ceres::SubsetManifold(joint_unknowns, fixed));
  }
  const ceres::Solver::Summary summary =
      modal::detail::solve(problem, max_iterations, 1e-10, 1e-13, refined.costs, progress);
  for (std::size_t i = 0; i < x.size(); ++i) refined.joint[i] = bounds.hold(i, scale.from(i, x[i]));
  refined.cost = 2.0 * summary.final_cost;
  refined.converged = summary.termination_type == ceres::CONVERGENCE;
  return refined;
}

/// The best that least squares reach from several starts, and from there with one unknown at a time moved far off: a
/// damping that is taken for a stiffness, or the other way round, is a valley of its own.
Refined refine_best(const JointModel& model, const JointData& data, const std::vector<JointValues>& starts,
                    const Bounds& bounds, Progress& progress) {
  constexpr int steps = 30;
  Refined best;
  best.cost = std::numeric_limits<double>::infinity();
  const auto from = [&](const JointValues& start) {
    Refined refined = refine(model, data, start, bounds, steps, progress);
    if (refined.cost < best.cost) best = std::move(refined);
  };
  for (const JointValues& start : starts) from(start);
  const JointValues found = best.joint;
  for (std::size_t i = 0; i < joint_unknowns; ++i) {
    for (const double factor : {0.03, 30.0}) {
      JointValues moved = found;
      moved[i] = bounds.hold(i, factor * found[i]);
      if (model.allows(moved)) from(moved);
    }
  }
  return best;
}

JointData part(const JointData& data, const std::vector<Index>& lines) {
  JointData out = data;
  out.measured = data.measured(lines);
  out.deviation = data.deviation(lines);
  return out;
}

/// The best individuals of an evolution that are apart, best first.
std::vector<JointValues> evolve(const JointModel& model, const JointData& data, const Bounds& bounds,
                                std::uint64_t seed, JointSearch& search, Progress& progress) {
  const Scale scale = search_scale(model, bounds);
  const Eigen::ArrayXd real = data.measured.real();
  const Eigen::ArrayXd imag = data.measured.imag();
  JointModel::Response scratch;
  const BoundedProblem view(model, real, imag, scale, bounds, scratch, progress);
  const pagmo::problem problem{view};
  const auto [lower_bound, upper_bound] = problem.get_bounds();
  Random random(seed);
  pagmo::population population{problem, 0U, 0U};
  for (unsigned i = 0; i < individuals; ++i) {
    Coordinates x;
    for (std::size_t d = 0; d < joint_unknowns; ++d) x.push_back(random.uniform(lower_bound[d], upper_bound[d]));
    population.push_back(x);
  }
  search.start = population.champion_f()[0];
  pagmo::de algorithm(1U, differential_weight, crossover_rate, 7U, 0.0, 0.0,
                      static_cast<unsigned>(random.index(std::numeric_limits<unsigned>::max())));
  for (unsigned generation = 0; generation < generations; ++generation) {
    population = algorithm.evolve(population);
    search.best.push_back(population.champion_f()[0]);
    progress.advance();
  }
  std::vector<std::size_t> order(population.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return population.get_f()[i][0]; });
  std::vector<JointValues> found;
  std::vector<const Coordinates*> taken;
  const std::vector<Coordinates> all = population.get_x();
  for (const std::size_t i : order) {
    const bool near = std::ranges::any_of(taken, [&](const Coordinates* other) {
      double apart = 0.0;
      for (std::size_t d = 0; d < joint_unknowns; ++d) apart = std::max(apart, std::abs(all[i][d] - (*other)[d]));
      return apart < least_apart;
    });
    if (near) continue;
    taken.push_back(&all[i]);
    found.push_back(view.joint(all[i]));
    if (found.size() == candidates) break;
  }
  return found;
}

/// A damping that the FRF does not notice, as beside a rigid stiffness, is wherever the search left it: the least one
/// serves as well.
JointValues without_idle_damping(const JointModel& model, const JointData& data, JointValues joint,
                                 const Bounds& bounds) {
  constexpr double unnoticed = 0.01;  // of the square of one line's residual
  for (const std::size_t i : {std::size_t{1}, std::size_t{3}}) {
    JointValues less = joint;
    less[i] = bounds.lower[i];
    const double before = joint_residuals(model, joint, data).squaredNorm();
    if (joint_residuals(model, less, data).squaredNorm() <= before + unnoticed) joint = less;
  }
  return joint;
}

}  // namespace

std::vector<Index> thinned_lines(const Eigen::ArrayXd& omega, const Eigen::VectorXcd& measured, std::size_t count) {
  const Index n = omega.size();
  std::vector<Index> lines;
  if (static_cast<std::size_t>(n) <= count) {
    for (Index i = 0; i < n; ++i) lines.push_back(i);
    return lines;
  }
  // The squared relative change over a thousandth of the lines: noise adds to a sum of squares less than resonances do.
  const Index lag = std::max<Index>(1, n / 1000);
  Eigen::ArrayXd change = Eigen::ArrayXd::Zero(n);
  for (Index i = lag; i < n; ++i) {
    const double size = std::abs(measured(i)) + std::abs(measured(i - lag));
    if (size > 0.0) change(i) = std::norm((measured(i) - measured(i - lag)) / size);
  }
  const double log_range = std::log(omega(n - 1) / omega(0));
  const double all_change = std::max(change.sum(), std::numeric_limits<double>::min());
  double position = 0.0;
  for (Index i = 0; i < n; ++i) {
    const double step = i == 0 ? 0.0 : std::log(omega(i) / omega(i - 1)) / log_range;
    position += 0.25 * step + 0.25 / static_cast<double>(n) + 0.5 * change(i) / all_change;
    const double next = static_cast<double>(lines.size()) / static_cast<double>(count);
    if (position >= next) lines.push_back(i);
  }
  return lines;
}

JointData joint_data(const modal::Frf& frf, const std::vector<Index>& lines, double noise_floor) {
  JointData data;
  data.measured = frf.receptance(lines);
  data.noise_floor = noise_floor;
  data.known = frf.deviation.size() > 0;
  const Eigen::ArrayXd size = data.measured.cwiseAbs();
  // A line that happens to be nearly zero is not worth more than all others.
  const double least = 1e-4 * size.mean();
  if (data.known) {
    data.deviation = frf.deviation(lines).array().max(noise_floor * size.max(least));
  } else {
    data.deviation = 0.01 * size.max(least);
  }
  return data;
}

void update_deviation(const JointModel& model, const JointValues& joint, JointData& data) {
  if (data.known) return;
  JointModel::Response response;
  model.receptance(joint, response);
  const Index n = model.lines();
  const Eigen::ArrayXd size2 = response.real.head(n).square() + response.imag.head(n).square();
  const Eigen::ArrayXd missed2 = (response.real.head(n) - data.measured.real().array()).square() +
                                 (response.imag.head(n) - data.measured.imag().array()).square();
  constexpr int steps = 30;
  double relative2 = 0.5 * (missed2 / size2).mean();
  double constant2 = 0.5 * missed2.mean();
  if (constant2 > 0.0) {
    for (int step = 0; step < steps; ++step) {
      const Eigen::ArrayXd inverse = (constant2 + relative2 * size2).inverse();
      const Eigen::ArrayXd ratio = missed2 * inverse * inverse;
      constant2 *= std::sqrt(ratio.sum() / inverse.sum());
      relative2 *= std::sqrt((size2 * ratio).sum() / (size2 * inverse).sum());
    }
  }
  data.deviation = (constant2 + relative2 * size2).max(data.noise_floor * data.noise_floor * size2).sqrt();
}

Eigen::VectorXd joint_residuals(const JointModel& model, const JointValues& joint, const JointData& data) {
  JointModel::Response response;
  model.receptance(joint, response);
  const Index n = model.lines();
  Eigen::VectorXd out(2 * n);
  out.head(n) = (response.real.head(n) - data.measured.real().array()) / data.deviation;
  out.tail(n) = (response.imag.head(n) - data.measured.imag().array()) / data.deviation;
  return out;
}

JointSearch search_by_evolution(const JointModel& model, JointData& data, const JointFitOptions& options,
                                Progress& progress) {
  const Bounds bounds{.lower = options.lower, .upper = options.upper};
  const std::vector<Index> lines = thinned_lines(model.omega(), data.measured, thinned_count);
  const JointModel thin_model = model.part(lines);
  const JointData thin = part(data, lines);
  progress.start("joint search", generations);
  JointSearch search;
  const std::vector<JointValues> starts = evolve(thin_model, thin, bounds, options.seed, search, progress);
  Refined best = refine_best(thin_model, thin, starts, bounds, progress);
  for (int pass = 0; pass < 2; ++pass) {
    best = refine(model, data, best.joint, bounds, 100, progress);
    for (const double cost : best.costs) {
      search.best.push_back(std::sqrt(cost / static_cast<double>(model.lines())));
    }
    if (pass == 0) update_deviation(model, best.joint, data);
  }
  search.joint = without_idle_damping(model, data, best.joint, bounds);
  search.status = best.converged ? JointFitResult::Status::converged : JointFitResult::Status::not_converged;
  return search;
}

}  // namespace robomill::coupling::detail
