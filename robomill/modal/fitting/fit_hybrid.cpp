#include "robomill/modal/fitting/fit_hybrid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/modal/fitting/fit_noise.hpp"
#include "robomill/modal/weak_modes.hpp"

namespace robomill::modal::detail {
namespace {

using Eigen::Index;

// Residuals alike over so many lines are no noise …
constexpr double not_noise = 3.0;
// … and an error that neighbouring lines share may well be so many times as large as what they differ by.
constexpr double shared_to_scatter = 10.0;
// By so much may the error of any FRF grow, as a share, where a weak mode is dropped.
constexpr double tolerated_growth = 0.1;

LscfOptions lscf_options(const FitOptions& options, const FitData& data) {
  // A quarter of the equations at most go into the fraction's coefficients.
  const auto most = static_cast<int>(data.omega.size() / 4);
  return {.max_order = std::clamp(options.lscf_max_order, 1, std::max(1, most)),
          .zeta_high = options.max_damping_ratio,
          .stable_frequency = options.stable_frequency,
          .stable_damping = options.stable_damping,
          .stable_mac = options.stable_mac};
}

SearchOptions search_options(const FitOptions& options, const FitData& data, int modes) {
  const Index n = data.omega.size();
  const double spacing = (data.omega(n - 1) - data.omega(0)) / static_cast<double>(n - 1);
  return {.modes = modes,
          .max_modes = options.max_modes,
          .bounds = {.omega_low = data.omega(0),
                     .omega_high = data.omega(n - 1),
                     .zeta_low = std::min(0.001 * spacing, 0.1 * options.max_damping_ratio),
                     .zeta_high = options.max_damping_ratio}};
}

void set_weight(FitEntry& entry, const Eigen::VectorXd& variance) {
  const double floor = 1e-24 + 1e-20 * variance.maxCoeff();
  entry.weight = (variance.array() + floor).sqrt().inverse();
}

// Weights from the residuals of a fit: the noise, and evenly what the model cannot follow.
void update_weights(Part& part, const FrfSet& set, const Evaluation& at, Weighting weighting) {
  for (std::size_t f = 0; f < part.data.entries.size(); ++f) {
    FitEntry& entry = part.data.entries[f];
    const Eigen::VectorXd squares = at.residual.col(static_cast<Index>(f)).cwiseAbs2();
    if (weighting != Weighting::estimated) {
      // Only the scale of a known variance is in question.
      set_weight(entry, variance_of_size(squares, known_variance(set.frfs[part.frfs[f]], weighting) /
                                                      std::pow(part.unit(entry), 2)));
      continue;
    }
    const Eigen::VectorXd size2 = (entry.receptance - at.residual.col(static_cast<Index>(f))).cwiseAbs2();
    const Eigen::VectorXd noise =
        variance_of_size(scatter(part.data.omega, at.residual.col(static_cast<Index>(f))), size2);
    set_weight(entry, noise.array() + misfit_variance(squares, noise));
  }
}

// Costs become weighted relative errors.
void keep(PartFit& fit, const FitData& data, const std::vector<double>& cost, int iterations) {
  double size = 0.0;
  for (const FitEntry& entry : data.entries) size += entry.receptance.cwiseProduct(entry.weight).squaredNorm();
  for (const double c : cost) fit.cost.push_back(std::sqrt(c / size));
  fit.iterations += iterations;
}

// The error ‖H_fit - H‖² that fewer modes may leave. Without deviation or coherence nothing shows how true the lines
// are, but for their scatter. Where residuals are smooth they are what no mode stands for, such as the error of a
// single hit; modes that follow the lines closer than that error describe the hit and not the structure.
double tolerated_error2(const Part& part, const Evaluation& at) {
  if (correlation_length(part.data, at.residual) < not_noise) return 0.0;
  double error2 = 0.0;
  for (std::size_t f = 0; f < part.data.entries.size(); ++f) {
    const FitEntry& entry = part.data.entries[f];
    const double share =
        shared_to_scatter * relative_scatter(part.data.omega, at.residual.col(static_cast<Index>(f)), entry.receptance);
    error2 += (share * part.unit(entry) * entry.receptance).squaredNorm();
  }
  return error2;
}

double error2(const Part& part, const Evaluation& at) {
  double sum = 0.0;
  for (std::size_t f = 0; f < part.data.entries.size(); ++f) {
    sum += (part.unit(part.data.entries[f]) * at.residual.col(static_cast<Index>(f))).squaredNorm();
  }
  return sum;
}

// The fewest modes that come as near as that; `start` where none do.
Poles fewest(const Part& part, const Kernel& kernel, const Poles& start, double tolerated2, SearchOptions options,
             PartFit& fit, Progress& progress) {
  for (options.modes = 1; options.modes < start.size(); ++options.modes) {
    const Found found = search(kernel, start, options, progress);
    if (error2(part, found.fit.at) > tolerated2 || !all_inside(found.fit.poles, options.bounds)) continue;
    keep(fit, part.data, found.cost, found.iterations);
    fit.held_back = true;
    return found.fit.poles;
  }
  return start;
}

void set_deviations(PartFit& fit, const FitData& data) {
  const Index modes = fit.poles.size();
  fit.omega_std.resize(0);
  fit.zeta_std.resize(0);
  if (modes == 0) return;
  const auto entries = static_cast<Index>(data.entries.size());
  const Index unknowns = 2 * modes * (data.excitations + data.responses) + (data.residuals ? 4 * entries : 0);
  const Index freedom = 2 * data.omega.size() * entries - unknowns;
  if (freedom <= 0) return;
  const double variance = fit.at.cost / static_cast<double>(freedom) * correlation_length(data, fit.at.residual);
  const Eigen::MatrixXd covariance = linear_algebra::inverse(fit.at.hessian) * variance;
  fit.omega_std.resize(modes);
  fit.zeta_std.resize(modes);
  const Index stride = parameter_count(data, modes) / modes;
  for (Index k = 0; k < modes; ++k) {
    fit.omega_std(k) = std::sqrt(std::max(0.0, covariance(stride * k, stride * k)));
    fit.zeta_std(k) = std::sqrt(std::max(0.0, covariance(stride * k + 1, stride * k + 1)));
  }
}

// The part's modes against the FRFs that it fits.
ModalModel marked_model(const Part& part, const FrfSet& set, const PartFit& fit) {
  FrfSet own{.frequency_hz = set.frequency_hz, .frfs = {}};
  for (const std::size_t f : part.frfs) own.frfs.push_back(set.frfs[f]);
  ModalModel model = empty_model(own);
  add_to_model(model, part, fit, part.data.residuals);
  mark_weak_modes(model, own);
  return model;
}

// Whether no FRF is missed by much more, over the band and over one mode's half-power band, at least nine lines.
bool is_as_good(const FitData& data, double omega, double zeta, const Evaluation& before, const Evaluation& after) {
  const Index n = data.omega.size();
  const double spacing = (data.omega(n - 1) - data.omega(0)) / static_cast<double>(n - 1);
  const double reach = std::max(zeta * omega, 4.0 * spacing);
  const Eigen::VectorXd near = ((data.omega.array() - omega).abs() <= reach).cast<double>();
  const double most = (1.0 + tolerated_growth) * (1.0 + tolerated_growth);
  for (Index f = 0; f < before.residual.cols(); ++f) {
    const Eigen::VectorXd was = before.residual.col(f).cwiseAbs2();
    const Eigen::VectorXd is = after.residual.col(f).cwiseAbs2();
    if (is.sum() > most * was.sum() || is.dot(near) > most * was.dot(near)) return false;
  }
  return true;
}

// Takes out the weak modes without which the fit is as good, the least missed first.
void drop_weak_modes(PartFit& fit, const Part& part, const FrfSet& set, const SearchOptions& options,
                     Progress& progress) {
  const Kernel kernel(part.data);
  for (Index tried = 0; tried < fit.poles.size();) {
    const ModalModel model = marked_model(part, set, fit);
    std::vector<Index> weak;
    for (Index k = 0; k < fit.poles.size(); ++k) {
      if (model.modes[static_cast<std::size_t>(k)].weak) weak.push_back(k);
    }
    if (tried >= static_cast<Index>(weak.size())) return;
    std::ranges::stable_sort(weak, [&](Index a, Index b) { return fit.at.loss(a) < fit.at.loss(b); });
    const Index k = weak[static_cast<std::size_t>(tried)];
    Refined without = refine(kernel, fit.poles.without(k), fine_options(options), progress);
    if (!is_as_good(part.data, fit.poles.omega(k), fit.poles.zeta(k), fit.at, without.at)) {
      ++tried;
      continue;
    }
    tried = 0;
    fit.dropped_omega.push_back(fit.poles.omega(k));
    keep(fit, part.data, without.cost, without.iterations);
    fit.poles = std::move(without.poles);
    fit.at = std::move(without.at);
    fit.converged = without.converged;
    set_deviations(fit, part.data);
  }
}

Poles as_poles(const std::vector<LscfPole>& physical, const FitData& data) {
  Poles poles{.omega = Eigen::VectorXd(static_cast<Index>(physical.size())),
              .zeta = Eigen::VectorXd(static_cast<Index>(physical.size())),
              .left = Eigen::MatrixXcd(data.excitations, static_cast<Index>(physical.size())),
              .gauge = {}};
  for (std::size_t k = 0; k < physical.size(); ++k) {
    const auto at = static_cast<Index>(k);
    poles.omega(at) = physical[k].omega;
    poles.zeta(at) = physical[k].zeta;
    poles.left.col(at) = physical[k].left;
  }
  poles.fix_gauge();
  return poles;
}

}  // namespace

void set_first_weights(Part& part, const FrfSet& set, Weighting weighting) {
  for (std::size_t f = 0; f < part.data.entries.size(); ++f) {
    FitEntry& entry = part.data.entries[f];
    const Frf& frf = set.frfs[part.frfs[f]];
    const double unit2 = std::pow(part.unit(entry), 2);
    const Eigen::VectorXd size2 = entry.receptance.cwiseAbs2();
    switch (weighting) {
      case Weighting::none:
        set_weight(entry, Eigen::VectorXd::Constant(size2.size(), 1.0 / unit2));
        break;
      case Weighting::relative:
        set_weight(entry, size2.array() + 1e-12 * size2.mean());
        break;
      case Weighting::coherence:
      case Weighting::deviation:
        set_weight(entry, known_variance(frf, weighting) / unit2);
        break;
      case Weighting::automatic:
      case Weighting::estimated:
        set_weight(entry, first_variance(part.data.omega, entry.receptance));
        break;
    }
  }
  // Only ratios count: bring the largest weight of the part to 1.
  double largest = 0.0;
  for (const FitEntry& entry : part.data.entries) largest = std::max(largest, entry.weight.maxCoeff());
  for (FitEntry& entry : part.data.entries) entry.weight /= largest;
}

PartFit fit_lscf(Part& part, const FitOptions& options, int modes, Progress& progress) {
  const LscfOptions lscf = lscf_options(options, part.data);
  PartFit fit;
  fit.diagram = lscf_poles(part.data, lscf, progress);
  const Poles physical = as_poles(physical_poles(fit.diagram, lscf), part.data);
  const Kernel kernel(part.data);
  fit.poles = with_left_vectors(kernel, physical.omega, physical.zeta);
  fit.at = kernel.evaluate(fit.poles, true);
  // Asked for fewer, it leaves out those that the fit misses least.
  while (modes > 0 && fit.poles.size() > modes) {
    Index weakest = 0;
    fit.at.loss.minCoeff(&weakest);
    const Poles rest = fit.poles.without(weakest);
    fit.poles = with_left_vectors(kernel, rest.omega, rest.zeta);
    fit.at = kernel.evaluate(fit.poles, true);
  }
  fit.converged = modes == 0 ? fit.poles.size() > 0 : fit.poles.size() == modes;
  return fit;
}

PartFit fit_hybrid(Part& part, const FrfSet& set, const FitOptions& options, int modes, Weighting weighting,
                   Progress& progress) {
  const LscfOptions lscf = lscf_options(options, part.data);
  PartFit fit;
  fit.diagram = lscf_poles(part.data, lscf, progress);
  const SearchOptions search_for = search_options(options, part.data, modes);
  const bool adaptive = weighting != Weighting::none && weighting != Weighting::relative;
  Poles start = as_poles(physical_poles(fit.diagram, lscf), part.data);
  if (static_cast<Index>(part.data.entries.size()) != part.data.responses * part.data.excitations) {
    start = with_left_vectors(Kernel(part.data), start.omega, start.zeta);
  }
  // First weights, weights from the first fit's residuals, and those from the second's.
  for (int round = adaptive ? 0 : 1; round < (adaptive ? 3 : 2); ++round) {
    SearchOptions here = search_for;
    here.grow = round < 2;
    here.swap = round == 1;
    const Kernel kernel(part.data);
    const Found found = search(kernel, start, here, progress);
    keep(fit, part.data, found.cost, found.iterations);
    start = found.fit.poles;
    if (adaptive && round < 2) update_weights(part, set, found.fit.at, weighting);
    if (round < 2 || modes > 0 || weighting != Weighting::estimated) continue;
    const double tolerated2 = tolerated_error2(part, found.fit.at);
    if (error2(part, found.fit.at) < tolerated2) {
      start = fewest(part, kernel, start, tolerated2, search_for, fit, progress);
    }
  }
  const Kernel kernel(part.data);
  Refined last = refine(kernel, start, fine_options(search_for), progress);
  keep(fit, part.data, last.cost, last.iterations);
  if (part.data.residuals) {
    part.data.residuals = false;
    const Kernel plain(part.data);
    Refined without = refine(plain, last.poles, fine_options(search_for), progress);
    // Left out only where the data would not notice: what they explain would bias the modes.
    part.data.residuals =
        evidence(part.data, last.at, without.at).is_significant(4.0 * static_cast<double>(part.data.entries.size()));
    if (!part.data.residuals) {
      keep(fit, part.data, without.cost, without.iterations);
      last = std::move(without);
    }
  }
  fit.poles = last.poles;
  fit.at = last.at;
  fit.converged = last.converged && (modes == 0 || static_cast<int>(fit.poles.size()) == modes);
  set_deviations(fit, part.data);
  if (modes == 0) drop_weak_modes(fit, part, set, search_for, progress);
  return fit;
}

}  // namespace robomill::modal::detail
