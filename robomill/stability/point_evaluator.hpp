#pragma once
#include <complex>
#include <limits>
#include <memory>
#include <span>

#include "robomill/base/lanes.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// What is wanted of a point beside its multiplier.
struct Ask {
  bool estimate = false;  ///< an estimate of the error, and the accuracy that the options ask for
  bool motion = false;    ///< frequency and mode
  int level = 0;          ///< > 0: of collocation, the level that it starts from in place of its own choice
  bool rough = false;     ///< for a search that looks once more where it ends: of collocation perhaps a coarser level
};

/// What is found at a point.
struct Outcome {
  std::complex<double> multiplier = 0.0;  ///< of greatest modulus, imaginary part >= 0
  double spectral_radius = 0.0;           ///< 1e100 where the motion overflows within a period
  double error_estimate = std::numeric_limits<double>::quiet_NaN();  ///< of the spectral radius
  BifurcationType kind = BifurcationType::hopf;
  double chatter_frequency_hz = 0.0;
  modal::ModeId mode = {};
};

/// One thread's means to find multipliers, eight points at a time. What it says of a point does not depend on the
/// points beside it.
class PointEvaluator {
 public:
  virtual ~PointEvaluator() = default;
  /// One to eight points; out has as many.
  virtual void evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) = 0;
  /// How many points to ask for where the later ones may turn out not to be needed: fewer than eight where a point
  /// costs most before they are solved together.
  [[nodiscard]] virtual std::size_t at_a_time() const { return lane_count; }
  [[nodiscard]] long long evaluations() const { return evaluations_; }
  [[nodiscard]] long long unsettled() const { return unsettled_; }

 protected:
  long long evaluations_ = 0, unsettled_ = 0;
};

/// A method applied to a problem. Shared by threads.
class Scheme {
 public:
  virtual ~Scheme() = default;
  [[nodiscard]] virtual std::unique_ptr<PointEvaluator> evaluator() const = 0;
  [[nodiscard]] virtual Period period() const = 0;
  /// Called with the depths that will be asked for often, before evaluators are made.
  /// @param picture  speeds that lie near each other may share what depends little on them
  virtual void expect(std::span<const double> depths_m, bool picture = false) {
    static_cast<void>(depths_m);
    static_cast<void>(picture);
  }
};

/// @throws InvalidInput if the method knows no such problem
void require_known(const LobesProblem& problem, Method method);
/// @throws InvalidInput as require_known
std::unique_ptr<Scheme> make_scheme(const LobesProblem& problem, const LobesOptions& options);
std::unique_ptr<Scheme> semi_discretization(const LobesProblem& problem, int intervals);
std::unique_ptr<Scheme> collocation(const LobesProblem& problem, double tolerance);
/// A cut in three directions; what its points call their axial depth is the parameter's value.
std::unique_ptr<Scheme> sweep_collocation(const LobesProblem& problem, SweptParameter parameter, double tolerance);

}  // namespace robomill::stability::detail
