#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "robomill/stability/collocation/collocation_map.hpp"
#include "robomill/stability/collocation/collocation_model.hpp"
#include "robomill/stability/eigen/arnoldi.hpp"
#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability::detail {

/// Multipliers by collocation. With an estimate, levels rise until two of them agree within the tolerance; the estimate
/// is by how much they differ, which is the error of the coarser.
class CollocationEvaluator final : public PointEvaluator {
 public:
  /// model must outlive this.
  CollocationEvaluator(const CollocationModel& model, double tolerance, const ArnoldiOptions& options = {})
      : model_(model),
        tolerance_(tolerance),
        first_tolerance_(model.modes() > options.most_cold_modes ? options.tolerance
                                                                 : std::max(options.tolerance, 1e-5 * tolerance)),
        next_tolerance_(std::max(options.tolerance, 1e-5 * tolerance)),
        arnoldi_(options) {}
  void evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) override;
  [[nodiscard]] std::size_t at_a_time() const override { return model_.at_a_time(); }

  /// Of the first point of the last evaluation, at its last level.
  [[nodiscard]] const CollocationCase& last_case() const { return *last_; }

  /// Without any search, all at one level.
  void evaluate_at(std::span<const OperatingPoint> points, int level, std::span<Dominant> out);

 private:
  struct Lane {
    int level = 0;
    double coarse = 0.0;  ///< spectral radius one level below
    bool compared = false, done = false;
    Eigen::VectorXd motion = {};  ///< one of the dominant ones there
    int nodes = 0;                ///< of a piece there
  };
  void guess(std::span<const std::size_t> lane_of);
  const CollocationCase& find_case(std::size_t lane, const OperatingPoint& point, int level);
  void run(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out);
  void assess(std::size_t lane, std::size_t column, const Dominant& dominant, const OperatingPoint& point, Ask ask,
              Outcome& out);

  const CollocationModel& model_;
  double tolerance_;
  /// Of a residual. Among many modes that fade alike a pair that is not the dominant one settles first where less is
  /// asked; from a level's result the next one takes the pair that it follows.
  double first_tolerance_, next_tolerance_;
  CollocationMap map_;
  Arnoldi arnoldi_;
  std::array<Lane, lane_count> lanes_;
  std::vector<Lanes> guess_;
  std::array<std::array<CollocationCase, lane_count>, 2> cases_;  ///< by parity of the level
  std::array<const CollocationCase*, lane_count> at_ = {};
  const CollocationCase* last_ = nullptr;
};

}  // namespace robomill::stability::detail
