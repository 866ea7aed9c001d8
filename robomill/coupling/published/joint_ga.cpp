#include "robomill/coupling/published/joint_ga.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>

#include "robomill/base/random.hpp"

namespace robomill::coupling::detail {
namespace {

using Genes = pagmo::vector_double;
using Eigen::Index;

// Standard deviation of an adaptive mutation's steps in the first and last generation, as a share of the range.
constexpr double first_step = 0.5;
constexpr double last_step = 0.01;

/// pagmo's view of the misfit, of whose sources it outlives none.
class MagnitudeProblem {
 public:
  MagnitudeProblem() = default;
  MagnitudeProblem(const JointModel& model, const Eigen::ArrayXd& magnitude, const JointFitOptions& options,
                   JointModel::Response& scratch)
      : model_(&model), magnitude_(&magnitude), options_(&options), scratch_(&scratch) {}
  [[nodiscard]] pagmo::vector_double fitness(const Genes& genes) const {
    JointValues joint{};
    std::ranges::copy(genes, joint.begin());
    return {magnitude_misfit(*model_, joint, *magnitude_, *scratch_)};
  }
  [[nodiscard]] std::pair<Genes, Genes> get_bounds() const {
    return {Genes(options_->lower.begin(), options_->lower.end()),
            Genes(options_->upper.begin(), options_->upper.end())};
  }

 private:
  const JointModel* model_ = nullptr;
  const Eigen::ArrayXd* magnitude_ = nullptr;
  const JointFitOptions* options_ = nullptr;
  JointModel::Response* scratch_ = nullptr;
};

/// Generations with one elite, stochastic uniform selection, arithmetic crossover and mutation, as a pagmo algorithm.
class Generations {
 public:
  Generations() = default;
  Generations(const JointFitOptions& options, Random& random, std::vector<double>& best, Progress& progress)
      : options_(&options), random_(&random), best_(&best), progress_(&progress) {}
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;

 private:
  [[nodiscard]] std::vector<std::size_t> select(const std::vector<std::size_t>& ranked, std::size_t count) const;
  void mutate(Genes& genes, int generation, const Genes& lower, const Genes& upper) const;

  const JointFitOptions* options_ = nullptr;
  Random* random_ = nullptr;
  std::vector<double>* best_ = nullptr;
  Progress* progress_ = nullptr;
};

/// Parents by pointers at equal steps over a line on which the individual of rank r holds 1/√r [Baker1987], in random
/// order.
std::vector<std::size_t> Generations::select(const std::vector<std::size_t>& ranked, std::size_t count) const {
  double total = 0.0;
  for (std::size_t rank = 1; rank <= ranked.size(); ++rank) total += 1.0 / std::sqrt(static_cast<double>(rank));
  const double step = total / static_cast<double>(count);
  const double first = random_->uniform(0.0, step);
  std::vector<std::size_t> parents;
  double end = 1.0;
  std::size_t rank = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double pointer = first + static_cast<double>(i) * step;
    while (pointer > end && rank < ranked.size()) end += 1.0 / std::sqrt(static_cast<double>(++rank));
    parents.push_back(ranked[rank - 1]);
  }
  for (std::size_t i = parents.size(); i > 1; --i) std::swap(parents[i - 1], parents[random_->index(i)]);
  return parents;
}

void Generations::mutate(Genes& genes, int generation, const Genes& lower, const Genes& upper) const {
  for (std::size_t d = 0; d < genes.size(); ++d) {
    const double range = upper[d] - lower[d];
    if (options_->mutation == Mutation::uniform) {
      if (random_->uniform() < options_->mutation_rate) genes[d] = random_->uniform(lower[d], upper[d]);
    } else {
      const double done = static_cast<double>(generation) / options_->generations;
      const double sigma = range * first_step * std::pow(last_step / first_step, done);
      genes[d] = std::clamp(genes[d] + sigma * random_->normal(), lower[d], upper[d]);
    }
  }
}

pagmo::population Generations::evolve(pagmo::population population) const {
  const pagmo::problem& problem = population.get_problem();
  const auto [lower_bound, upper_bound] = problem.get_bounds();
  const std::size_t children = population.size() - 1;
  const std::size_t crossed =
      static_cast<std::size_t>(std::lround(options_->crossover * static_cast<double>(children)));
  std::vector<Genes> genes = population.get_x();
  std::vector<double> misfit;
  for (const pagmo::vector_double& f : population.get_f()) misfit.push_back(f[0]);
  for (int generation = 1; generation <= options_->generations; ++generation) {
    std::vector<std::size_t> ranked(genes.size());
    std::iota(ranked.begin(), ranked.end(), std::size_t{0});
    std::ranges::stable_sort(ranked, {}, [&](std::size_t i) { return misfit[i]; });
    const std::vector<std::size_t> parents = select(ranked, 2 * crossed + (children - crossed));
    std::vector<Genes> next = {genes[ranked[0]]};
    std::vector<double> next_misfit = {misfit[ranked[0]]};
    auto parent = parents.begin();
    for (std::size_t child = 0; child < children; ++child) {
      next.push_back(genes[*parent++]);
      if (child < crossed) {
        const Genes& other = genes[*parent++];
        const double share = random_->uniform();
        for (std::size_t d = 0; d < other.size(); ++d) {
          next.back()[d] = share * next.back()[d] + (1.0 - share) * other[d];
        }
      } else {
        mutate(next.back(), generation, lower_bound, upper_bound);
      }
      next_misfit.push_back(problem.fitness(next.back())[0]);
    }
    genes = std::move(next);
    misfit = std::move(next_misfit);
    best_->push_back(*std::ranges::min_element(misfit));
    progress_->advance();
  }
  for (std::size_t i = 0; i < genes.size(); ++i) population.set_xf(i, genes[i], {misfit[i]});
  return population;
}

}  // namespace

double magnitude_misfit(const JointModel& model, const JointValues& joint, const Eigen::ArrayXd& magnitude,
                        JointModel::Response& scratch) {
  if (!model.allows(joint)) return std::numeric_limits<double>::max();
  model.receptance(joint, scratch);
  const Index n = model.lines();
  const double square =
      ((scratch.real.head(n).square() + scratch.imag.head(n).square()).sqrt() - magnitude).square().sum();
  return std::sqrt(square);
}

namespace {

/// Stalled: all generations together brought nothing that an FRF shows; converged: the last fifth of them brought less
/// than a hundredth.
/// @param size  ‖H‖: an objective within its rounding is 0
JointFitResult::Status end_of(const JointSearch& search, const JointFitOptions& options, double size) {
  using Status = JointFitResult::Status;
  const double last = search.best.back();
  constexpr double rounding = 1e-12;
  if (options.lower == options.upper || last <= rounding * size)
    return Status::converged;  // nothing is left to look for
  if (search.start - last <= options.noise_floor * search.start) return Status::stalled;
  const std::size_t fifth = std::max<std::size_t>(1, search.best.size() / 5);
  const double before = search.best.size() > fifth ? search.best[search.best.size() - 1 - fifth] : search.start;
  return before - last <= 0.01 * before ? Status::converged : Status::not_converged;
}

}  // namespace

JointSearch search_by_genes(const JointModel& model, const Eigen::VectorXcd& measured, const JointFitOptions& options,
                            Progress& progress) {
  const Eigen::ArrayXd magnitude = measured.cwiseAbs().array();
  JointModel::Response scratch;
  Random random(options.seed);
  const pagmo::problem problem{MagnitudeProblem(model, magnitude, options, scratch)};
  pagmo::population population{problem, 0U, 0U};
  for (int i = 0; i < options.population; ++i) {
    Genes genes;
    for (std::size_t d = 0; d < joint_unknowns; ++d)
      genes.push_back(random.uniform(options.lower[d], options.upper[d]));
    population.push_back(genes);
  }
  JointSearch search;
  search.start = population.champion_f()[0];
  progress.start("genetic algorithm", static_cast<std::size_t>(options.generations));
  const pagmo::algorithm algorithm{Generations(options, random, search.best, progress)};
  std::ranges::copy(algorithm.evolve(population).champion_x(), search.joint.begin());
  search.status = end_of(search, options, magnitude.matrix().norm());
  return search;
}

}  // namespace robomill::coupling::detail
