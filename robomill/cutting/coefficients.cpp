#include "robomill/cutting/coefficients.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/cutting/cut_limits.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;

/// That a ratio of two mean squares of a and b degrees of freedom is at least this, were both of one variance.
double probability_of_ratio(double ratio, double a, double b) {
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(a, b), std::max(ratio, 0.0)));
}

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
/// Feeds that differ by less, to their mean, are one: the edge part would be the noise a thousandfold.
constexpr double least_spread_of_feeds = 1e-3;
/// R² from which rows are said to follow the model, and below which they hardly do; the share of the largest force
/// below which scatter is noise.
constexpr double good_fit = 0.9;
constexpr double poor_fit = 0.5;
constexpr double noise_share = 0.05;
/// Speeds that differ by less, to the slower, are one.
constexpr double speed_tolerance = 0.01;

/// One direction: the component of force that its two coefficients make, each per N a c and N a.
struct Direction {
  const char* name;
  int component;
  double cutting, edge;
  CoefficientPair SlotFit::*pair;
  CoefficientPair SpeedGroup::*of_group;
};
constexpr std::array<Direction, 3> directions = {{
    {"fy", 1, 0.25, 1.0 / pi, &SlotFit::tangential, &SpeedGroup::tangential},
    {"fx", 0, -0.25, -1.0 / pi, &SlotFit::radial, &SpeedGroup::radial},
    {"fz", 2, 1.0 / pi, 0.5, &SlotFit::axial, &SpeedGroup::axial},
}};

using Slots = std::vector<SlotForce>;

bool one_feed(const Slots& slots) {
  const auto [least, most] = std::ranges::minmax(slots, {}, &SlotForce::feed_per_tooth_m);
  return most.feed_per_tooth_m - least.feed_per_tooth_m <= least_spread_of_feeds * most.feed_per_tooth_m;
}

/// rows x 2, or rows x 1 without the edge.
Eigen::MatrixXd design(const Slots& slots, const Direction& direction, const SlotOptions& options, bool with_edge) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(slots.size()), with_edge ? 2 : 1);
  Eigen::Index row = 0;
  for (const SlotForce& slot : slots) {
    const double length_m = options.teeth * slot.axial_depth_m;
    columns(row, 0) = direction.cutting * length_m * slot.feed_per_tooth_m;
    if (with_edge) columns(row, 1) = direction.edge * length_m;
    ++row;
  }
  return columns;
}

Eigen::VectorXd component(const Slots& slots, int axis) {
  Eigen::VectorXd force_n(static_cast<Eigen::Index>(slots.size()));
  Eigen::Index row = 0;
  for (const SlotForce& slot : slots) force_n(row++) = slot.mean_force_n(axis);
  return force_n;
}

struct PairFit {
  CoefficientPair pair;
  Eigen::VectorXd residual_n;
};

PairFit fit_pair(const Slots& slots, const Direction& direction, const SlotOptions& options, bool with_edge) {
  const Eigen::MatrixXd columns = design(slots, direction, options, with_edge);
  const Eigen::VectorXd force_n = component(slots, direction.component);
  // Columns of one length: cutting and edge parts differ by the feed, 1e-4 m.
  const Eigen::VectorXd size = columns.colwise().norm();
  const Eigen::MatrixXd scaled = columns * size.cwiseInverse().asDiagonal();
  const Eigen::VectorXd solution = linear_algebra::least_squares(scaled, force_n);
  PairFit out{.pair = {}, .residual_n = force_n - scaled * solution};
  const Eigen::Index unknowns = scaled.cols();
  const Eigen::Index left = scaled.rows() - unknowns;
  const double squares = out.residual_n.squaredNorm();
  const double total = (force_n.array() - force_n.mean()).square().sum();
  CoefficientPair& pair = out.pair;
  pair.cutting_n_per_m2 = solution(0) / size(0);
  pair.edge_n_per_m = with_edge ? solution(1) / size(1) : 0.0;
  // A force that varies by no more than rounding has no variance to explain.
  pair.r_squared = total > 1e-24 * force_n.squaredNorm() ? 1.0 - squares / total : no_number;
  pair.noise_n = left > 0 ? std::sqrt(squares / static_cast<double>(left)) : no_number;
  const Eigen::MatrixXd covariance = linear_algebra::inverse(Eigen::MatrixXd(scaled.transpose() * scaled));
  const double noise_n = left > 0 ? pair.noise_n : HUGE_VAL;
  pair.cutting_deviation_n_per_m2 = noise_n * std::sqrt(covariance(0, 0)) / size(0);
  pair.edge_deviation_n_per_m = with_edge ? noise_n * std::sqrt(covariance(1, 1)) / size(1) : 0.0;
  pair.correlation = with_edge ? covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1)) : 0.0;
  return out;
}

/// Rows of one speed together, slowest first; rows of unknown speed are left out.
std::vector<Slots> by_speed(Slots slots) {
  std::ranges::stable_sort(slots, {}, &SlotForce::spindle_speed_rad_per_s);
  std::vector<Slots> groups;
  for (const SlotForce& slot : slots) {
    if (slot.spindle_speed_rad_per_s <= 0.0) continue;
    const bool same = !groups.empty() && slot.spindle_speed_rad_per_s <=
                                             (1.0 + speed_tolerance) * groups.back().front().spindle_speed_rad_per_s;
    if (!same) groups.emplace_back();
    groups.back().push_back(slot);
  }
  std::erase_if(groups, [](const Slots& group) { return one_feed(group); });
  return groups;
}

/// Whether coefficients of each speed's own explain more than their number would by chance: an F test in each
/// direction, the least of the three probabilities times three.
void compare_speeds(const Slots& slots, const SlotOptions& options, SlotFit& fit) {
  const std::vector<Slots> groups = by_speed(slots);
  if (groups.size() < 2) return;
  fit.by_speed.resize(groups.size());
  Slots all;
  for (const Slots& group : groups) all.insert(all.end(), group.begin(), group.end());
  const double extra = 2.0 * static_cast<double>(groups.size() - 1);
  const double left = static_cast<double>(all.size()) - extra - 2.0;
  for (const Direction& direction : directions) {
    double apart = 0.0;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const PairFit own = fit_pair(groups[i], direction, options, true);
      SpeedGroup& group = fit.by_speed[i];
      group.*direction.of_group = own.pair;
      group.rows = static_cast<int>(groups[i].size());
      apart += own.residual_n.squaredNorm();
    }
    const double together = fit_pair(all, direction, options, true).residual_n.squaredNorm();
    const double rounding = 1e-24 * component(all, direction.component).squaredNorm();
    if (left < 1.0 || together <= rounding) continue;
    const double ratio = (together - apart) / extra / (std::max(apart, rounding) / left);
    fit.speed_probability = std::min(fit.speed_probability, 3.0 * probability_of_ratio(ratio, extra, left));
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    double sum = 0.0;
    for (const SlotForce& slot : groups[i]) sum += slot.spindle_speed_rad_per_s;
    fit.by_speed[i].spindle_speed_rad_per_s = sum / static_cast<double>(groups[i].size());
  }
  if (left < 1.0) {
    fit.notes.emplace_back("Too few slots to say whether the coefficients depend on the speed.");
    return;
  }
  fit.depends_on_speed = fit.speed_probability < options.significance;
  if (fit.depends_on_speed) {
    fit.notes.emplace_back(
        "The coefficients depend on the spindle speed beyond the scatter of the rows: take those of the speed to cut "
        "at.");
  }
}

/// The row without which the others follow the model, in words; empty where there is none. It need not be the one that
/// fits worst: a row far from the others draws the fit to itself.
std::string odd_row(const Slots& slots, const Direction& direction, const SlotOptions& options) {
  double best = good_fit;
  std::string text;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    Slots others = slots;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (others.size() < 3 || one_feed(others)) continue;
    const double r_squared = fit_pair(others, direction, options, true).pair.r_squared;
    if (!(r_squared > best)) continue;
    best = r_squared;
    text = "Row " + std::to_string(i + 1) + " is the odd one: the others follow the model without it. ";
  }
  return text;
}

/// Forces that scatter more about the model than about their mean are no slots' forces, or not in these units.
/// @throws InvalidInput
void check_model(const Slots& slots, const SlotOptions& options, SlotFit& fit) {
  double most_n = 0.0;
  for (const SlotForce& slot : slots) most_n = std::max(most_n, slot.mean_force_n.norm());
  for (const Direction& direction : directions) {
    const double r_squared = (fit.*direction.pair).r_squared;
    const Eigen::VectorXd residual_n = fit.residual_n.row(direction.component).transpose();
    // A force that is small beside the others may be noise alone.
    if (!(r_squared < poor_fit) || residual_n.cwiseAbs().maxCoeff() < noise_share * most_n) continue;
    const std::string force = std::string("R² of ") + direction.name + " is ";
    if (r_squared >= 0.0) {
      fit.notes.push_back(force + std::to_string(r_squared).substr(0, 4) +
                          ": feed and depth explain little of that force; look at the rows.");
      continue;
    }
    throw InvalidInput(
        "slots",
        "do not follow a slot's forces, which grow with feed and depth: " + force +
            std::to_string(std::lround(r_squared)) + ", where their mean alone has 0",
        odd_row(slots, direction, options) +
            "Are feed, depth and forces in their columns and units, and the forces means of full slots?");
  }
}

void judge(std::size_t rows, SlotFit& fit) {
  const bool signs = fit.tangential.cutting_n_per_m2 < 0.0 || fit.radial.cutting_n_per_m2 < 0.0;
  if (fit.tangential.cutting_n_per_m2 < 0.0 && fit.radial.cutting_n_per_m2 < 0.0) {
    fit.notes.emplace_back(
        "Tangential and radial coefficient are negative: forces measured on the workpiece have the other sign.");
  } else if (signs) {
    fit.notes.emplace_back(
        "A cutting coefficient is negative: are x along the feed, y to its left and the forces those on the tool?");
  } else if (fit.tangential.edge_n_per_m < 0.0 || fit.radial.edge_n_per_m < 0.0) {
    fit.notes.emplace_back("An edge coefficient is negative: more feeds, and smaller ones, would determine it.");
  }
  const double tangential = std::abs(fit.tangential.cutting_n_per_m2);
  if (tangential < 1e7 || tangential > 1e11) {
    fit.notes.emplace_back("The tangential coefficient is not that of a metal: are the units right?");
  }
  if (fit.status == SlotFit::Status::identified && rows == 2) {
    fit.notes.emplace_back("Two slots leave no row over: deviations need a third.");
  }
}

}  // namespace

void SlotForce::validate() const {
  require_positive("feed_per_tooth_m", feed_per_tooth_m, "m");
  require_positive("axial_depth_m", axial_depth_m, "m", "Without depth there is no force to learn from");
  if (spindle_speed_rad_per_s != 0.0) require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
  for (const double force_n : mean_force_n) require_finite("mean_force_n", force_n, "N");
}

void SlotOptions::validate() const {
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  if (!(significance > 0.0 && significance < 1.0)) {
    throw InvalidInput("significance", significance, "", "must lie between 0 and 1");
  }
}

MillingCoefficients SlotFit::coefficients() const {
  MillingCoefficients out;
  out.tangential_n_per_m2 = {tangential.cutting_n_per_m2};
  out.radial_n_per_m2 = {radial.cutting_n_per_m2};
  out.axial_n_per_m2 = {axial.cutting_n_per_m2};
  out.tangential_edge_n_per_m = {tangential.edge_n_per_m};
  out.radial_edge_n_per_m = {radial.edge_n_per_m};
  out.axial_edge_n_per_m = {axial.edge_n_per_m};
  out.edge_measure = EdgeMeasure::width;
  return out;
}

SlotFit identify_from_slots(const std::vector<SlotForce>& slots, const SlotOptions& options) {
  options.validate();
  if (slots.size() < 2) {
    throw InvalidInput("slots", static_cast<double>(slots.size()), "rows", "must be at least 2",
                       "Cut slots at several feeds, the same otherwise");
  }
  for (std::size_t i = 0; i < slots.size(); ++i) {
    try {
      slots[i].validate();
    } catch (const InvalidInput& error) {
      throw within("slots[" + std::to_string(i + 1) + "].", error);
    }
  }
  SlotFit fit;
  const bool reported = !options.edge_forces || !one_feed(slots);
  const bool with_edge = options.edge_forces && reported;
  fit.status = reported ? SlotFit::Status::identified : SlotFit::Status::edge_unknown;
  fit.residual_n.resize(3, static_cast<Eigen::Index>(slots.size()));
  for (const Direction& direction : directions) {
    PairFit own = fit_pair(slots, direction, options, with_edge);
    if (!reported) own.pair.cutting_deviation_n_per_m2 = own.pair.edge_deviation_n_per_m = HUGE_VAL;
    fit.*direction.pair = own.pair;
    fit.residual_n.row(direction.component) = own.residual_n.transpose();
  }
  if (!reported) {
    fit.notes.emplace_back(
        "All slots have one feed: cutting and edge parts cannot be parted. The cutting coefficients hold this feed's "
        "edge force too; slots at a second feed would show it.");
  }
  if (with_edge) compare_speeds(slots, options, fit);
  if (with_edge) check_model(slots, options, fit);
  judge(slots.size(), fit);
  return fit;
}

}  // namespace robomill::cutting
