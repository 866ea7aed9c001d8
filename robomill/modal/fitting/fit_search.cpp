#include "robomill/modal/fitting/fit_search.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/modal/fitting/fit_noise.hpp"

namespace robomill::modal::detail {
namespace {

using Eigen::Index;

constexpr std::size_t tried_candidates = 3;  // of those measured, refined …
constexpr std::size_t most_candidates = 8;   // … or more, while none of them becomes a mode inside the bounds
constexpr double exact = 1e-7;               // relative error at which only rounding is left, to single precision
constexpr double coarse_tolerance = 1e-4;    // of the cost, to compare fits

double unknowns_of_a_mode(const FitData& data) {
  return static_cast<double>(2 * (data.excitations + data.responses));
}

// The cost at a relative error of `exact`.
double smallest_cost(const FitData& data) {
  double cost = 0.0;
  for (const FitEntry& entry : data.entries) cost += entry.receptance.cwiseProduct(entry.weight).squaredNorm();
  return exact * exact * cost;
}

// The weighted residual's size over the lines, summed over the FRFs.
Eigen::VectorXd residual_size(const FitData& data, const Evaluation& at) {
  Eigen::VectorXd size = Eigen::VectorXd::Zero(data.omega.size());
  for (std::size_t f = 0; f < data.entries.size(); ++f) {
    size += at.residual.col(static_cast<Index>(f)).cwiseProduct(data.entries[f].weight).cwiseAbs2();
  }
  return size;
}

// Frequencies where the residual, averaged over 2 half + 1 lines, has its highest peaks.
std::vector<double> residual_peaks(const FitData& data, const Evaluation& at, Index half, std::size_t count) {
  const Eigen::VectorXd size = residual_size(data, at);
  const Index n = size.size();
  Eigen::VectorXd total = Eigen::VectorXd::Zero(n + 1);
  for (Index i = 0; i < n; ++i) total(i + 1) = total(i) + size(i);
  Eigen::VectorXd mean(n);
  for (Index i = 0; i < n; ++i) {
    const Index begin = std::max<Index>(0, i - half);
    const Index end = std::min<Index>(n, i + half + 1);
    mean(i) = (total(end) - total(begin)) / static_cast<double>(end - begin);
  }
  std::vector<Index> peaks;
  for (Index i = 1; i + 1 < n; ++i) {
    if (mean(i) > mean(i - 1) && mean(i) >= mean(i + 1)) peaks.push_back(i);
  }
  std::sort(peaks.begin(), peaks.end(), [&](Index a, Index b) { return mean(a) > mean(b); });
  std::vector<double> found;
  for (const Index peak : peaks) {
    if (found.size() == count) break;
    found.push_back(data.omega(peak));
  }
  return found;
}

std::vector<Candidate> candidates(const FitData& data, const Evaluation& at, const SearchOptions& options) {
  std::vector<Candidate> list;
  const auto add = [&](double omega, double zeta) {
    if (zeta < options.bounds.zeta_low || zeta > options.bounds.zeta_high) return;
    list.push_back({.omega = std::clamp(omega, options.bounds.omega_low, options.bounds.omega_high), .zeta = zeta});
  };
  for (const Index half : {Index{1}, Index{6}, Index{30}}) {
    for (const double omega : residual_peaks(data, at, half, 6)) {
      for (const double zeta : {0.002, 0.006, 0.02, 0.06}) add(omega, zeta);
    }
  }
  for (const double zeta : {0.04, 0.12, 0.3}) {
    const double step = std::log1p(2.0 * zeta);
    const int count = static_cast<int>(std::log(options.bounds.omega_high / options.bounds.omega_low) / step);
    for (int i = 0; i <= count; ++i) add(options.bounds.omega_low * std::exp(step * i), zeta);
  }
  return list;
}

// L of the R Lᵀ nearest to a residue matrix on the entries that the data has.
Eigen::VectorXcd left_vector(const Eigen::MatrixXcd& residue, const FitData& data) {
  const linear_algebra::ComplexThinSvd svd = linear_algebra::thin_svd(residue);
  Eigen::VectorXcd left = svd.v.col(0).conjugate();
  if (static_cast<Index>(data.entries.size()) == residue.size()) return left;
  Eigen::VectorXcd right = svd.u.col(0);
  const auto fit_to = [&](Eigen::VectorXcd& own, const Eigen::VectorXcd& other, bool of_right) {
    Eigen::VectorXcd product = Eigen::VectorXcd::Zero(own.size());
    Eigen::VectorXd size2 = Eigen::VectorXd::Zero(own.size());
    for (const FitEntry& entry : data.entries) {
      const Index here = of_right ? entry.response : entry.excitation;
      const std::complex<double> factor = other(of_right ? entry.excitation : entry.response);
      product(here) += std::conj(factor) * residue(entry.response, entry.excitation);
      size2(here) += std::norm(factor);
    }
    for (Index i = 0; i < own.size(); ++i) own(i) = size2(i) > 0.0 ? product(i) / size2(i) : 0.0;
  };
  for (int round = 0; round < 100; ++round) {
    fit_to(right, left, true);
    fit_to(left, right, false);
    left.stableNormalize();
  }
  return left;
}

class Search {
 public:
  Search(const Kernel& kernel, const SearchOptions& options, Progress& progress)
      : kernel_(kernel), options_(options), progress_(progress), smallest_cost_(smallest_cost(kernel.data())) {}

  Found run(const Poles& start) {
    state_ = fit(sifted(start), coarse_tolerance, 40);
    keep_curve(state_);
    if (options_.modes > 0) {
      reach(options_.modes);
    } else {
      by_criterion();
    }
    if (options_.swap) swap();
    Found found;
    found.iterations = iterations_;
    found.cost = curve_;
    found.fit = std::move(state_);
    return found;
  }

 private:
  Refined fit(const Poles& from, double tolerance, int iterations) {
    Refined result = refine(
        kernel_, from, {.bounds = options_.bounds, .max_iterations = iterations, .tolerance = tolerance}, progress_);
    iterations_ += result.iterations;
    return result;
  }
  [[nodiscard]] bool one_more_is_worth_it(const Refined& larger, const Refined& smaller) const {
    const FitData& data = kernel_.data();
    return evidence(data, larger.at, smaller.at).supports_mode(unknowns_of_a_mode(data));
  }
  void keep_curve(const Refined& fit) { curve_.insert(curve_.end(), fit.cost.begin(), fit.cost.end()); }
  void accept(Refined next) {
    keep_curve(next);
    state_ = std::move(next);
    grown_.reset();
  }
  [[nodiscard]] bool all_inside(const Poles& poles) const { return detail::all_inside(poles, options_.bounds); }

  // The state with one mode more.
  const Refined& grown() {
    if (!grown_) grown_ = best_start();
    return *grown_;
  }

  // The best of a few starts with one mode more; the state itself where there is none.
  Refined best_start() {
    std::vector<Candidate> list = candidates(kernel_.data(), state_.at, options_);
    kernel_.measure(list, state_.poles, state_.at);
    std::sort(list.begin(), list.end(), [](const Candidate& a, const Candidate& b) { return a.gain > b.gain; });
    std::vector<Candidate> tried;
    Refined best;
    for (const Candidate& c : list) {
      const bool found = best.poles.size() > 0 && all_inside(best.poles);
      if (tried.size() >= (found ? tried_candidates : most_candidates)) break;
      const bool near = std::any_of(tried.begin(), tried.end(), [&](const Candidate& t) {
        return std::abs(t.omega - c.omega) < 2.0 * (t.zeta + c.zeta) * c.omega &&
               std::max(t.zeta, c.zeta) < 4.0 * std::min(t.zeta, c.zeta);
      });
      if (near || c.gain <= 0.0) continue;
      tried.push_back(c);
      Refined next =
          fit(state_.poles.with(c.omega, c.zeta, left_vector(c.residue, kernel_.data())), coarse_tolerance, 25);
      const bool better = best.poles.size() == 0 || (all_inside(next.poles) && !all_inside(best.poles)) ||
                          (all_inside(next.poles) == all_inside(best.poles) && next.at.cost < best.at.cost);
      if (better) best = std::move(next);
    }
    return best.poles.size() > 0 ? best : state_;
  }

  // The state without the mode that it misses least.
  Refined pruned(const Refined& from) {
    Index weakest = 0;
    from.at.loss.minCoeff(&weakest);
    return fit(from.poles.without(weakest), coarse_tolerance, 25);
  }

  // Those poles of the start whose worth shows before any is refined.
  [[nodiscard]] Poles sifted(Poles poles) const {
    const FitData& data = kernel_.data();
    while (poles.size() > options_.modes) {
      const Evaluation at = kernel_.evaluate(poles, true);
      Index weakest = 0;
      at.loss.minCoeff(&weakest);
      Evaluation less;
      less.cost = at.cost + at.loss(weakest);
      if (poles.size() <= options_.max_modes && evidence(data, at, less).supports_mode(unknowns_of_a_mode(data))) break;
      poles = poles.without(weakest);
    }
    return poles;
  }

  void reach(int modes) {
    while (state_.poles.size() > modes) accept(pruned(state_));
    while (state_.poles.size() < modes) {
      if (grown().poles.size() == state_.poles.size()) return;
      accept(Refined(grown()));
    }
  }

  // One more and one less, as long as it helps.
  void swap() {
    for (int round = 0; round < 6 && state_.at.cost > smallest_cost_; ++round) {
      if (grown().poles.size() == state_.poles.size()) return;
      Refined next = pruned(grown());
      if (!(next.at.cost < (1.0 - coarse_tolerance) * state_.at.cost)) return;
      accept(std::move(next));
    }
  }

  void by_criterion() {
    while (state_.poles.size() > 0) {
      Refined next = pruned(state_);
      const bool allowed = all_inside(state_.poles) && state_.poles.size() <= options_.max_modes;
      if (allowed && one_more_is_worth_it(state_, next)) break;
      accept(std::move(next));
    }
    while (options_.grow && state_.poles.size() < options_.max_modes && state_.at.cost > smallest_cost_) {
      const Refined& next = grown();
      if (next.poles.size() == state_.poles.size() || !all_inside(next.poles)) break;
      if (!one_more_is_worth_it(next, state_)) break;
      accept(Refined(next));
    }
  }

  const Kernel& kernel_;
  SearchOptions options_;
  Progress& progress_;
  double smallest_cost_;
  Refined state_;
  std::optional<Refined> grown_;
  std::vector<double> curve_;
  int iterations_ = 0;
};

}  // namespace

bool Evidence::supports_mode(double more_unknowns) const {
  return gain > more_unknowns * std::log(equations);
}

bool Evidence::is_significant(double more_unknowns) const {
  return gain > more_unknowns + 2.0 * std::sqrt(2.0 * more_unknowns);
}

Evidence evidence(const FitData& data, const Evaluation& larger, const Evaluation& smaller) {
  const auto equations = static_cast<double>(2 * data.omega.size() * static_cast<Index>(data.entries.size()));
  const double independent = equations / correlation_length(data, larger.residual);
  const double floor = smallest_cost(data);
  return {.gain = independent * std::log(std::max(smaller.cost, floor) / std::max(larger.cost, floor)),
          .equations = independent};
}

bool all_inside(const Poles& poles, const PoleBounds& bounds) {
  for (Index k = 0; k < poles.size(); ++k) {
    if (poles.zeta(k) >= 0.999 * bounds.zeta_high || poles.zeta(k) <= 1.001 * bounds.zeta_low) return false;
    if (poles.omega(k) >= bounds.omega_high || poles.omega(k) <= bounds.omega_low) return false;
  }
  return true;
}

RefineOptions fine_options(const SearchOptions& options) {
  return {.bounds = options.bounds, .max_iterations = 200, .tolerance = 1e-13};
}

Found search(const Kernel& kernel, const Poles& start, const SearchOptions& options, Progress& progress) {
  return Search(kernel, options, progress).run(start);
}

Poles with_left_vectors(const Kernel& kernel, const Eigen::VectorXd& omega, const Eigen::VectorXd& zeta) {
  const FitData& data = kernel.data();
  Poles poles{
      .omega = omega, .zeta = zeta, .left = Eigen::MatrixXcd::Zero(data.excitations, omega.size()), .gauge = {}};
  std::vector<Eigen::MatrixXcd> residue(static_cast<std::size_t>(omega.size()),
                                        Eigen::MatrixXcd::Zero(data.responses, data.excitations));
  for (const FitEntry& entry : data.entries) {
    FitData one{.omega = data.omega, .responses = 1, .excitations = 1, .entries = {entry}, .residuals = data.residuals};
    one.entries.front().response = one.entries.front().excitation = 0;
    Poles alone{.omega = omega, .zeta = zeta, .left = Eigen::MatrixXcd::Ones(1, omega.size()), .gauge = {}};
    alone.fix_gauge();
    const Evaluation e = Kernel(one).evaluate(alone, false);
    for (Index k = 0; k < omega.size(); ++k) {
      residue[static_cast<std::size_t>(k)](entry.response, entry.excitation) = e.right(0, k);
    }
  }
  for (Index k = 0; k < omega.size(); ++k) poles.left.col(k) = left_vector(residue[static_cast<std::size_t>(k)], data);
  poles.fix_gauge();
  return poles;
}

}  // namespace robomill::modal::detail
