#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/cutting/coefficients.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;

constexpr int highest_degree = 6;
/// What every modelled set holds, since none may lack a tangential coefficient; it is taken off again.
constexpr double base_n_per_m2 = 1e9;
constexpr int coarse_steps = 360;    ///< of a revolution, in the search for the offset
constexpr int coarse_samples = 720;  ///< more are thinned out in it

struct Kind {
  const char* name;
  const char* member;
  int CoefficientDegrees::*degree;
  std::vector<double> MillingCoefficients::*values;
  double unit;  ///< of its columns, N/m^2 or N/m
};
constexpr std::array<Kind, 6> kinds = {{
    {"tangential", "degrees.tangential", &CoefficientDegrees::tangential, &MillingCoefficients::tangential_n_per_m2,
     1e9},
    {"radial", "degrees.radial", &CoefficientDegrees::radial, &MillingCoefficients::radial_n_per_m2, 1e9},
    {"axial", "degrees.axial", &CoefficientDegrees::axial, &MillingCoefficients::axial_n_per_m2, 1e9},
    {"tangential edge", "degrees.tangential_edge", &CoefficientDegrees::tangential_edge,
     &MillingCoefficients::tangential_edge_n_per_m, 1e5},
    {"radial edge", "degrees.radial_edge", &CoefficientDegrees::radial_edge, &MillingCoefficients::radial_edge_n_per_m,
     1e5},
    {"axial edge", "degrees.axial_edge", &CoefficientDegrees::axial_edge, &MillingCoefficients::axial_edge_n_per_m,
     1e5},
}};

/// One unknown: the factor of a power of κ in a coefficient.
struct Term {
  const Kind* kind;
  int power;
  [[nodiscard]] std::string name() const {
    const std::string whole = kind->name;
    return power == 0 ? whole : whole + (power == 1 ? " κ" : " κ^" + std::to_string(power));
  }
};

std::vector<Term> terms_of(const CoefficientDegrees& degrees) {
  std::vector<Term> terms;
  for (const Kind& kind : kinds) {
    for (int power = degrees.*kind.degree; power >= 0; --power) terms.push_back({&kind, power});
  }
  return terms;
}

MillingCoefficients unit_coefficients(const Term& term) {
  MillingCoefficients out;
  std::vector<double>& values = out.*term.kind->values;
  values.assign(static_cast<std::size_t>(term.power) + 1, 0.0);
  values.front() = term.kind->unit;
  if (out.tangential_n_per_m2.empty()) out.tangential_n_per_m2 = {0.0};
  out.tangential_n_per_m2.back() += base_n_per_m2;
  return out;
}

/// The force over a revolution of each term's unit.
class Model {
 public:
  Model(const Cutter& cutter, const Engagement& engagement, const CutMotion& motion, const std::vector<Term>& terms,
        int steps) {
    const ForceOptions options{.steps = steps};
    const CuttingForce base =
        cutting_force(cutter, engagement, {.tangential_n_per_m2 = {base_n_per_m2}}, motion, options);
    start_rad_ = base.rotation_rad(0);
    for (const Term& term : terms) {
      const CuttingForce force = cutting_force(cutter, engagement, unit_coefficients(term), motion, options);
      columns_.emplace_back((force.force_n - base.force_n) / term.kind->unit);
    }
  }

  /// Rows x, y, z of each sample, a column a term [N per unit], between the steps by straight lines.
  [[nodiscard]] Eigen::MatrixXd at(const Eigen::VectorXd& rotation_rad, double offset_rad) const {
    Eigen::MatrixXd out(3 * rotation_rad.size(), static_cast<Eigen::Index>(columns_.size()));
    const Eigen::Index steps = columns_.front().cols();
    for (Eigen::Index i = 0; i < rotation_rad.size(); ++i) {
      const double turns = (rotation_rad(i) + offset_rad - start_rad_) / (2.0 * pi);
      const double place = (turns - std::floor(turns)) * static_cast<double>(steps);
      const Eigen::Index before = static_cast<Eigen::Index>(place) % steps;
      const Eigen::Index after = (before + 1) % steps;
      const double share = place - std::floor(place);
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        out.col(static_cast<Eigen::Index>(k)).segment<3>(3 * i) =
            (1.0 - share) * columns_[k].col(before) + share * columns_[k].col(after);
      }
    }
    return out;
  }

 private:
  double start_rad_ = 0.0;
  std::vector<Eigen::Matrix3Xd> columns_;
};

struct Signal {
  Eigen::VectorXd rotation_rad;
  Eigen::VectorXd force_n;  ///< x, y, z of each sample
};

/// 1 / length of each column; 1 where it has none.
Eigen::VectorXd scale_of(const Eigen::MatrixXd& design) {
  Eigen::VectorXd scale = design.colwise().norm();
  for (double& length : scale) length = length > 0.0 ? 1.0 / length : 1.0;
  return scale;
}

double misfit(const Model& model, const Signal& signal, double offset_rad) {
  const Eigen::MatrixXd design = model.at(signal.rotation_rad, offset_rad);
  const Eigen::MatrixXd scaled = design * scale_of(design).asDiagonal();
  const Eigen::VectorXd solution = linear_algebra::least_squares_with_pivots(scaled, signal.force_n);
  return (signal.force_n - scaled * solution).squaredNorm();
}

Signal thinned(const Signal& signal) {
  const Eigen::Index stride = 1 + (signal.rotation_rad.size() - 1) / coarse_samples;
  const Eigen::Index count = (signal.rotation_rad.size() - 1) / stride + 1;
  Signal out{Eigen::VectorXd(count), Eigen::VectorXd(3 * count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    out.rotation_rad(i) = signal.rotation_rad(i * stride);
    out.force_n.segment<3>(3 * i) = signal.force_n.segment<3>(3 * i * stride);
  }
  return out;
}

/// The least of the misfit over a period: a grid, then the golden section about its best place.
double find_offset(const Model& model, const Signal& signal, double period_rad) {
  const Signal coarse = thinned(signal);
  const int count = std::max(8, static_cast<int>(std::lround(coarse_steps * period_rad / (2.0 * pi))));
  const double step_rad = period_rad / count;
  double best = HUGE_VAL, best_rad = 0.0;
  for (int i = 0; i < count; ++i) {
    const double value = misfit(model, coarse, i * step_rad);
    if (value < best) {
      best = value;
      best_rad = i * step_rad;
    }
  }
  constexpr double golden = std::numbers::phi - 1.0;
  double low = best_rad - step_rad, high = best_rad + step_rad;
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = misfit(model, signal, left), at_right = misfit(model, signal, right);
  while (high - low > 1e-9) {
    if (at_left < at_right) {
      high = right;
      right = std::exchange(left, high - golden * (high - low));
      at_right = std::exchange(at_left, 0.0);
      at_left = misfit(model, signal, left);
    } else {
      low = left;
      left = std::exchange(right, low + golden * (high - low));
      at_left = std::exchange(at_right, 0.0);
      at_right = misfit(model, signal, right);
    }
  }
  const double found = 0.5 * (low + high);
  // A grid that hit the offset itself is no worse for the section having come near it.
  return misfit(model, signal, found) < misfit(model, signal, best_rad)
             ? found - period_rad * std::floor(found / period_rad)
             : best_rad;
}

/// Least squares through the singular values of the scaled design.
struct Solution {
  Eigen::VectorXd values, deviations;  ///< per unknown; deviations for a noise of 1, infinite where undetermined
  Eigen::Index rank = 0;
  double condition = 0.0;
  std::vector<std::vector<Eigen::Index>> mixed;  ///< unknowns determined only as a sum, one list a lost direction
};

Solution solve(const Eigen::MatrixXd& design, const Eigen::VectorXd& force_n, double tolerance) {
  const Eigen::VectorXd scale = scale_of(design);
  const Eigen::MatrixXd scaled = design * scale.asDiagonal();
  const linear_algebra::ThinSvd svd = linear_algebra::thin_svd(scaled);
  const Eigen::Index unknowns = scaled.cols();
  Solution out;
  const double smallest = std::max(tolerance * svd.values(0), std::numeric_limits<double>::min());
  out.rank = (svd.values.array() >= smallest).count();
  const Eigen::VectorXd shares = svd.u.leftCols(out.rank).transpose() * force_n;
  const Eigen::VectorXd parts = svd.values.head(out.rank).cwiseInverse().cwiseProduct(shares);
  out.values = (svd.v.leftCols(out.rank) * parts).cwiseProduct(scale);
  out.condition = out.rank > 0 ? svd.values(0) / svd.values(out.rank - 1) : HUGE_VAL;
  out.deviations.resize(unknowns);
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    double variance = 0.0, lost = 0.0;
    for (Eigen::Index k = 0; k < unknowns; ++k) {
      const double share = svd.v(i, k);
      if (k < out.rank) {
        variance += std::pow(share / svd.values(k), 2);
      } else {
        lost += share * share;
      }
    }
    out.deviations(i) = lost > 1e-6 ? HUGE_VAL : std::sqrt(variance) * scale(i);
  }
  for (Eigen::Index k = out.rank; k < unknowns; ++k) {
    std::vector<Eigen::Index>& names = out.mixed.emplace_back();
    for (Eigen::Index i = 0; i < unknowns; ++i) {
      if (std::abs(svd.v(i, k)) > 0.05) names.push_back(i);
    }
  }
  return out;
}

void put(const std::vector<Term>& terms, const Eigen::VectorXd& values, MillingCoefficients& out) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    (out.*terms[i].kind->values).push_back(values(static_cast<Eigen::Index>(i)));
  }
}

void report(const std::vector<Term>& terms, const Solution& solution, SignalFit& fit) {
  for (const std::vector<Eigen::Index>& mixed : solution.mixed) {
    std::string names;
    for (const Eigen::Index i : mixed) {
      const bool term = i < static_cast<Eigen::Index>(terms.size());
      names += (names.empty() ? "" : ", ") + (term ? terms[static_cast<std::size_t>(i)].name() : std::string("offset"));
    }
    fit.notes.push_back("The signal does not separate: " + names + ".");
  }
  const auto mean = [](const std::vector<double>& polynomial) {
    // At the κ of a cylinder's side.
    double value = 0.0;
    for (const double factor : polynomial) value = value * 0.5 * pi + factor;
    return value;
  };
  if (fit.identifiable && mean(fit.coefficients.tangential_n_per_m2) < 0.0) {
    fit.notes.emplace_back(
        "The tangential coefficient is negative: forces measured on the workpiece have the other sign.");
  }
}

Eigen::Vector3d r_squared(const Eigen::Ref<const Eigen::Matrix3Xd>& force_n, const Eigen::Matrix3Xd& residual_n) {
  Eigen::Vector3d out;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double total = (force_n.row(axis).array() - force_n.row(axis).mean()).square().sum();
    out(axis) = total > 1e-24 * force_n.squaredNorm() ? 1.0 - residual_n.row(axis).squaredNorm() / total
                                                      : std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

void check(const Engagement& engagement, const Eigen::Ref<const Eigen::VectorXd>& rotation_rad,
           const Eigen::Ref<const Eigen::Matrix3Xd>& force_n, std::size_t unknowns) {
  if (unknowns == 0) throw InvalidInput("degrees", "must name a coefficient to find");
  if (engagement.empty()) throw InvalidInput("engagement", "must not be empty: the cutter cuts nothing");
  if (rotation_rad.size() != force_n.cols()) {
    throw InvalidInput("force_n", static_cast<double>(force_n.cols()), "entries",
                       "must have one sample for each of the " + std::to_string(rotation_rad.size()) + " rotations");
  }
  if (!rotation_rad.allFinite()) throw InvalidInput("rotation_rad", "must be finite");
  if (!force_n.allFinite()) throw InvalidInput("force_n", "must be finite");
  if (rotation_rad.size() < static_cast<Eigen::Index>(unknowns)) {
    throw InvalidInput("rotation_rad", static_cast<double>(rotation_rad.size()), "entries",
                       "must be at least as many as the " + std::to_string(unknowns) + " unknowns");
  }
}

}  // namespace

void SignalOptions::validate() const {
  for (const Kind& kind : kinds) {
    const int degree = degrees.*kind.degree;
    if (degree < -1 || degree > highest_degree)
      throw InvalidInput(kind.member, degree, "", "must lie between -1 and 6");
  }
  if (steps < 8 || steps > 100000) throw InvalidInput("steps", steps, "", "must lie between 8 and 100,000");
  if (!(rank_tolerance > 0.0 && rank_tolerance < 1.0)) {
    throw InvalidInput("rank_tolerance", rank_tolerance, "", "must lie between 0 and 1");
  }
}

SignalFit identify_from_signal(const Cutter& cutter, const Engagement& engagement, const CutMotion& motion,
                               const Eigen::Ref<const Eigen::VectorXd>& rotation_rad,
                               const Eigen::Ref<const Eigen::Matrix3Xd>& force_n, const SignalOptions& options) {
  options.validate();
  const std::vector<Term> terms = terms_of(options.degrees);
  check(engagement, rotation_rad, force_n, terms.size());
  const Model model(cutter, engagement, motion, terms, options.steps);
  const Signal signal{rotation_rad, Eigen::VectorXd(force_n.reshaped())};
  const bool alike = cutter.mill.has_equal_teeth();
  const double period_rad = alike ? 2.0 * pi / cutter.mill.teeth : 2.0 * pi;

  SignalFit fit;
  if (options.find_offset) fit.offset_rad = find_offset(model, signal, period_rad);
  const Eigen::MatrixXd design = model.at(signal.rotation_rad, fit.offset_rad);
  const auto unknowns = static_cast<Eigen::Index>(terms.size());
  Solution solution = solve(design, signal.force_n, options.rank_tolerance);
  const Eigen::VectorXd values = solution.values;
  if (options.find_offset) {
    // The offset is an unknown too: what it adds to the deviations comes through its own column.
    const double step_rad = 2.0 * pi / options.steps;
    Eigen::MatrixXd wider(design.rows(), unknowns + 1);
    wider << design, (model.at(signal.rotation_rad, fit.offset_rad + step_rad) -
                      model.at(signal.rotation_rad, fit.offset_rad - step_rad)) *
                         values / (2.0 * step_rad);
    solution = solve(wider, signal.force_n, options.rank_tolerance);
  }
  const Eigen::VectorXd residual = signal.force_n - design * values;
  fit.residual_n = residual.reshaped(3, force_n.cols());
  const Eigen::Index left = signal.force_n.size() - solution.rank;
  fit.noise_n = left > 0 ? std::sqrt(residual.squaredNorm() / static_cast<double>(left)) : HUGE_VAL;
  fit.r_squared = r_squared(force_n, fit.residual_n);
  fit.condition = solution.condition;
  const Eigen::VectorXd& reported = solution.deviations;
  Eigen::VectorXd deviations = reported;
  for (double& deviation : deviations) deviation = std::isfinite(deviation) ? deviation * fit.noise_n : HUGE_VAL;
  put(terms, values, fit.coefficients);
  put(terms, deviations.head(unknowns), fit.deviations);
  fit.identifiable = reported.head(unknowns).allFinite();
  if (options.find_offset) fit.offset_deviation_rad = deviations(unknowns);
  report(terms, solution, fit);
  return fit;
}

}  // namespace robomill::cutting
