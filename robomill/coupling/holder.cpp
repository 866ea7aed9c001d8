#include "robomill/coupling/holder.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/coupling/artefact.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/section.hpp"

namespace robomill::coupling {
namespace {

using Eigen::Index;
using modal::Axis;
using modal::Frf;
using modal::FrfSet;

constexpr std::size_t holder_lines_per_block = 64;

void require_options(const HolderOptions& options) {
  require_positive("max_amplification", options.max_amplification, "");
  require_non_negative("regularisation", options.regularisation, "");
}

void require_points(const FrfSet& measured, const std::vector<double>& position_m) {
  measured.validate();
  require_positive("frequency_hz", measured.frequency_hz(0), "Hz", "Leave the line at 0 Hz out");
  for (std::size_t i = 0; i < position_m.size(); ++i) {
    require_finite("position_m", position_m[i], "m");
    for (std::size_t k = 0; k < i; ++k) {
      if (position_m[i] == position_m[k]) {
        throw InvalidInput("position_m", position_m[i], "m", "must not be given twice");
      }
    }
  }
  const int count = static_cast<int>(position_m.size());
  for (const Frf& frf : measured.frfs) {
    if (frf.receptance.norm() == 0.0) {
      throw InvalidInput("receptances", fmt::format("{} is zero at every line", modal::to_string(frf.name)));
    }
    for (const int point : {frf.name.response.point, frf.name.excitation.point}) {
      if (point >= 1 && point <= count) continue;
      throw InvalidInput("position_m", fmt::format("says where points 1 to {} stand, but there is an FRF {}", count,
                                                   modal::to_string(frf.name)));
    }
  }
}

/// The translation of a point for a force at another, or the other way round.
const Frf* find(const FrfSet& set, Axis plane, int point, int load_point) {
  const modal::FrfName name = detail::element_name(plane, 0, plane, 0, point, load_point);
  const Frf* frf = set.find(name);
  return frf != nullptr ? frf : set.find({.response = name.excitation, .excitation = name.response});
}

/// Keeps the larger; what is no number is without bound.
void raise(double& amplification, double value) {
  amplification = std::isnan(value) ? std::numeric_limits<double>::infinity() : std::max(amplification, value);
}

bool has_plane(const FrfSet& set, Axis plane) {
  return std::ranges::any_of(
      set.frfs, [&](const Frf& frf) { return frf.name.response.axis == plane && frf.name.excitation.axis == plane; });
}

void add_plane(const std::vector<Eigen::Matrix2cd>& matrices, Axis plane, FrfSet& set) {
  for (int column = 0; column < 2; ++column) {
    for (int row = 0; row < 2; ++row) {
      Frf frf;
      frf.name = detail::element_name(plane, row, plane, column);
      frf.receptance.resize(static_cast<Index>(matrices.size()));
      for (std::size_t i = 0; i < matrices.size(); ++i) {
        frf.receptance(static_cast<Index>(i)) =
            detail::element_sign(plane, row, plane, column) * matrices[i](row, column);
      }
      set.frfs.push_back(std::move(frf));
    }
  }
}

/// Runs a plane's method on each plane that was measured, and says which lines are not to be relied on.
template <class Plane>
HolderResult by_planes(const FrfSet& measured, const HolderOptions& options, Plane&& find_plane) {
  HolderResult result;
  result.receptances.frequency_hz = measured.frequency_hz;
  result.amplification = Eigen::VectorXd::Zero(measured.frequency_hz.size());
  if (!has_plane(measured, Axis::x) && !has_plane(measured, Axis::y)) {
    throw InvalidInput("receptances", "hold no translation in x or y");
  }
  for (const Axis plane : {Axis::x, Axis::y}) {
    if (has_plane(measured, plane)) add_plane(find_plane(plane, result), plane, result.receptances);
  }
  const auto between = [](const Frf& frf) {
    return frf.name.response.axis != frf.name.excitation.axis && static_cast<int>(frf.name.response.axis) <= 2 &&
           static_cast<int>(frf.name.excitation.axis) <= 2;
  };
  if (std::ranges::any_of(measured.frfs, between)) {
    result.notes.emplace_back("FRFs between x and y are left out: each plane is taken by itself.");
  }
  for (Index i = 0; i < result.amplification.size(); ++i) {
    if (!(result.amplification(i) <= options.max_amplification)) {
      result.unreliable_hz.push_back(measured.frequency_hz(i));
    }
  }
  if (!result.unreliable_hz.empty()) {
    result.notes.push_back(
        fmt::format("At {} of {} lines, the first at {:.6g} Hz, an error of 1 % in the measurement becomes more than "
                    "{:.3g} % of the holder's receptances: do not rely on them there.",
                    result.unreliable_hz.size(), measured.frequency_hz.size(), result.unreliable_hz.front(),
                    options.max_amplification));
  }
  return result;
}

/// Weights of value (row 0) and slope (row 1) at z = 0 of the polynomial through points of these positions.
Eigen::MatrixXd stencil(const std::vector<double>& position_m) {
  const Index n = static_cast<Index>(position_m.size());
  Eigen::MatrixXd powers(n, n);  // powers(k, i) = z_i^k: weights w of a functional solve powers w = (value on z^k)
  for (Index k = 0; k < n; ++k) {
    for (Index i = 0; i < n; ++i) powers(k, i) = std::pow(position_m[static_cast<std::size_t>(i)], k);
  }
  Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(n, 2);
  wanted(0, 0) = wanted(1, 1) = 1.0;
  return powers.fullPivLu().solve(wanted).transpose();
}

std::string missing(Axis plane, int point, int load_point) {
  return modal::to_string(detail::element_name(plane, 0, plane, 0, point, load_point));
}

/// From all pairs of points: R = W H Wᵀ.
void complete_from_pairs(const std::vector<std::vector<const Frf*>>& h, const Eigen::MatrixXd& weights, Index line,
                         Eigen::Matrix2cd& out, double& amplification) {
  const Index n = weights.cols();
  Eigen::MatrixXcd all(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      all(i, k) = h[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)]->receptance(line);
    }
  }
  out = weights * all * weights.transpose();
  const Eigen::MatrixXd power = weights.cwiseAbs2() * all.cwiseAbs2() * weights.transpose().cwiseAbs2();
  const Eigen::Matrix2d share = power.cwiseSqrt().array() / out.cwiseAbs().array();
  for (const double value : share.reshaped()) raise(amplification, value);
}

/// From hits at the mouth alone: θ per moment follows as l n / h, which holds where one mode stands out.
void complete_from_column(const std::vector<std::vector<const Frf*>>& h, const Eigen::MatrixXd& weights, Index line,
                          Eigen::Matrix2cd& out, double& amplification) {
  const Index n = weights.cols();
  Eigen::VectorXcd column(n);
  for (Index i = 0; i < n; ++i) column(i) = h[static_cast<std::size_t>(i)][0]->receptance(line);
  const std::complex<double> slope = weights.row(1) * column;
  const std::complex<double> direct = column(0);
  out << direct, slope, slope, direct == 0.0 ? 0.0 : slope * slope / direct;
  const double power = (weights.row(1).transpose().cwiseProduct(column.cwiseAbs())).squaredNorm();
  raise(amplification, 2.0 * std::sqrt(power) / std::abs(slope));
  if (direct == 0.0) raise(amplification, std::numeric_limits<double>::infinity());
}

}  // namespace

HolderResult complete_rotations(const FrfSet& measured, const std::vector<double>& position_m,
                                const HolderOptions& options) {
  require_options(options);
  const int points = static_cast<int>(position_m.size());
  if (points != 2 && points != 3) {
    throw InvalidInput("position_m", fmt::format("has {} positions; must be two or three", points),
                       "A slope needs two, its error three");
  }
  require_points(measured, position_m);
  const Eigen::MatrixXd weights = stencil(position_m);
  HolderResult result = by_planes(measured, options, [&](Axis plane, HolderResult& out) {
    std::vector<std::vector<const Frf*>> h;
    std::vector<std::string> lacking;
    bool column_whole = position_m[0] == 0.0;
    for (int i = 1; i <= points; ++i) {
      h.emplace_back();
      for (int k = 1; k <= points; ++k) {
        h.back().push_back(find(measured, plane, i, k));
        if (h.back().back() != nullptr) continue;
        if (i >= k) lacking.push_back(missing(plane, i, k));
        if (k == 1) column_whole = false;
      }
    }
    if (!lacking.empty() && !column_whole) {
      throw InvalidInput("receptances", fmt::format("lack {}", fmt::join(lacking, ", ")),
                         "Hit every point, or stand point 1 at the mouth (position 0) and hit it alone");
    }
    if (!lacking.empty()) {
      out.notes.push_back(fmt::format(
          "{} {} not measured: rotation per moment is taken as l n / h, which holds only where one mode stands out.",
          fmt::join(lacking, ", "), lacking.size() == 1 ? "was" : "were"));
    }
    std::vector<Eigen::Matrix2cd> matrices(static_cast<std::size_t>(measured.frequency_hz.size()));
    for (Index i = 0; i < measured.frequency_hz.size(); ++i) {
      Eigen::Matrix2cd& matrix = matrices[static_cast<std::size_t>(i)];
      (lacking.empty() ? complete_from_pairs : complete_from_column)(h, weights, i, matrix, out.amplification(i));
    }
    if (points == 3 && plane == (has_plane(measured, Axis::x) ? Axis::x : Axis::y)) {
      const double first = 1.0 / (position_m[1] - position_m[0]);
      double difference = 0.0, size = 0.0;
      for (Index i = 0; i < measured.frequency_hz.size(); ++i) {
        const std::complex<double> slope = first * (h[1][0]->receptance(i) - h[0][0]->receptance(i));
        const std::complex<double> better = matrices[static_cast<std::size_t>(i)](1, 0);
        difference += std::norm(better - slope);
        size += std::norm(slope);
      }
      out.truncation_error = std::sqrt(difference / size);
    }
    return matrices;
  });
  if (result.truncation_error > 0.0) {
    result.notes.push_back(fmt::format(
        "Slopes of second order differ from those of first order by {:.2g} %: the error of either is of that size.",
        100.0 * result.truncation_error));
  }
  return result;
}

namespace {

/// One measured FRF of a plane as an equation for M: which rows of ArtefactPoints it speaks of.
struct Equation {
  const Frf* frf = nullptr;
  Index row = 0, column = 0;
  double sign = 1.0;
};

std::vector<Equation> equations_of(const FrfSet& measured, Axis plane, const std::vector<std::size_t>& rank) {
  std::vector<Equation> out;
  for (const Frf& frf : measured.frfs) {
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 2; ++column) {
        const modal::FrfName name =
            detail::element_name(plane, row, plane, column, frf.name.response.point, frf.name.excitation.point);
        if (name != frf.name) continue;
        const auto at = [&](int point) { return static_cast<Index>(2 * rank[static_cast<std::size_t>(point - 1)]); };
        out.push_back({.frf = &frf,
                       .row = at(frf.name.response.point) + row,
                       .column = at(frf.name.excitation.point) + column,
                       .sign = detail::element_sign(plane, row, plane, column)});
      }
    }
  }
  return out;
}

/// Takes the artefact off at one line. Lengths are in those of the artefact, so that u and θ weigh alike.
Eigen::Matrix2cd take_off(const std::vector<Equation>& equations, const detail::ArtefactPoints& points, Index line,
                          double length_m, double regularisation, double& amplification) {
  const Index n = static_cast<Index>(equations.size());
  Eigen::MatrixXcd a(n, 3);
  Eigen::VectorXcd b(n);
  for (Index e = 0; e < n; ++e) {
    const Equation& equation = equations[static_cast<std::size_t>(e)];
    const std::complex<double> h = equation.sign * equation.frf->receptance(line);
    const Eigen::Vector2cd t(points.carry(equation.row, 0), points.carry(equation.row, 1) / length_m);
    const Eigen::Vector2cd s(points.carry(equation.column, 0), points.carry(equation.column, 1) / length_m);
    // An FRF is as true as a share of itself; a line where it is zero was not measured.
    const double weight = h == 0.0 ? 0.0 : 1.0 / std::abs(h);
    if (h == 0.0) raise(amplification, std::numeric_limits<double>::infinity());
    a.row(e) << weight * t(0) * s(0), weight * (t(0) * s(1) + t(1) * s(0)), weight * t(1) * s(1);
    b(e) = weight * (h - points.receptance(equation.row, equation.column));
  }
  const linear_algebra::ComplexThinSvd svd = linear_algebra::thin_svd(a);
  const Eigen::VectorXd& sigma = svd.values;
  const double floor = regularisation * sigma(0);
  const Eigen::VectorXd gain = sigma.unaryExpr([&](double s) { return s > 0.0 ? s / (s * s + floor * floor) : 0.0; });
  const Eigen::MatrixXcd inverse = svd.v * gain.asDiagonal() * svd.u.adjoint();
  const auto matrix = [](const Eigen::Vector3cd& m) { return Eigen::Matrix2cd{{m(0), m(1)}, {m(1), m(2)}}; };
  const Eigen::Matrix2cd seen = matrix(inverse * b);
  Eigen::Matrix2cd stiffness = points.stiffness;
  stiffness.row(1) /= length_m;
  stiffness.col(1) /= length_m;
  const Eigen::Matrix2cd back = (Eigen::Matrix2cd::Identity() - seen * stiffness).inverse();
  const Eigen::Matrix2cd base = back * seen;
  double power = 0.0;
  for (Index e = 0; e < n; ++e) {
    power += (back * matrix(inverse.col(e)) * back.transpose()).squaredNorm();
  }
  raise(amplification, std::sqrt(power) / base.norm());
  Eigen::Matrix2cd out = base;
  out.row(1) /= length_m;
  out.col(1) /= length_m;
  return out;
}

}  // namespace

HolderResult remove_artefact(const FrfSet& measured, const std::vector<double>& position_m,
                             const std::vector<Segment>& artefact, const HolderOptions& options) {
  require_options(options);
  if (artefact.empty()) throw InvalidInput("artefact", "has no segment");
  for (const Segment& segment : artefact) segment.validate();
  require_points(measured, position_m);
  const double length = detail::total_length(artefact);
  for (const double z : position_m) {
    if (!(z >= 0.0 && z <= length * (1.0 + 1e-9))) {
      throw InvalidInput("position_m", z, "m", "must lie on the artefact, from its free end to the joint");
    }
  }
  std::vector<std::size_t> order(position_m.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::size_t i) { return position_m[i]; });
  std::vector<double> sorted;
  std::vector<std::size_t> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    sorted.push_back(std::min(position_m[order[i]], length));
  }
  const std::vector<detail::ArtefactPoints> points = detail::artefact_points(artefact, sorted, measured.frequency_hz);
  return by_planes(measured, options, [&](Axis plane, HolderResult& out) {
    const std::vector<Equation> equations = equations_of(measured, plane, rank);
    if (equations.size() < 3) {
      throw InvalidInput("receptances",
                         fmt::format("hold {} FRFs; must be at least three a plane, of two points: 1x:1x, 2x:1x, 2x:2x",
                                     equations.size()),
                         "The holder has three unknowns: h, l = n and p");
    }
    std::vector<Eigen::Matrix2cd> matrices(points.size());
    parallel_for(points.size(), holder_lines_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Index line = static_cast<Index>(i);
        matrices[i] = take_off(equations, points[i], line, length, options.regularisation, out.amplification(line));
      }
    });
    return matrices;
  });
}

}  // namespace robomill::coupling
