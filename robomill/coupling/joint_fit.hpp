#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/assembly.hpp"

// Method: robomill/coupling/README.md, "The joint from one FRF (`joint_fit.hpp`)"

namespace robomill::coupling {

enum class JointMethod {
  hybrid,  ///< differential evolution on logarithms, then nonlinear least squares on complex residuals
  ga       ///< genetic algorithm on ‖ |H11| - |H11 model| ‖, as published
};
inline constexpr Name<JointMethod> joint_method_names[] = {{"hybrid", JointMethod::hybrid}, {"ga", JointMethod::ga}};

/// Of the genetic algorithm.
enum class Mutation {
  uniform,  ///< a gene in a hundred is drawn anew from its range, as published
  adaptive  ///< Gaussian steps that shrink over the generations
};
inline constexpr Name<Mutation> mutation_names[] = {{"uniform", Mutation::uniform}, {"adaptive", Mutation::adaptive}};

/// The four unknowns, in this order everywhere: k_u, c_u, k_θ, c_θ.
inline constexpr int joint_unknowns = 4;
enum class JointUnknown {
  translational_stiffness,  ///< k_u [N/m]: force against displacement
  translational_damping,    ///< c_u [N s/m], viscous: force against velocity
  rotational_stiffness,     ///< k_θ [N m/rad]: moment against rotation
  rotational_damping        ///< c_θ [N m s/rad], viscous: moment against angular velocity
};
/// "translational stiffness", …
[[nodiscard]] ROBOMILL_API std::string to_string(JointUnknown unknown);

struct JointFitOptions {
  JointMethod method = JointMethod::hybrid;
  Mutation mutation = Mutation::uniform;
  modal::Axis axis = modal::Axis::x;  ///< which driving-point FRF is fitted: x or y
  std::uint64_t seed = 1;
  /// Of the unknowns; where a range is left empty (0, 0), the method's own: ga as published, stiffness [1e5, 1e8],
  /// damping [0, 100]; hybrid [1e3, 1e12] and [0, 1e6]. A range of one value is not fitted.
  std::array<double, joint_unknowns> lower = {}, upper = {};
  int population = 20;          ///< of ga, >= 4
  int generations = 50;         ///< of ga, >= 1
  double crossover = 0.8;       ///< of ga: share of children by arithmetic crossover, in [0, 1]
  double mutation_rate = 0.01;  ///< of ga with Mutation::uniform: a gene's chance, in [0, 1]
  /// No FRF is taken to be truer than this share of itself, in (0, 1], by an error that all lines may share: it keeps
  /// deviations honest where data has no noise. At every line σ >= noise_floor · |H|. A genetic search that lowered its
  /// objective by no more than this share is stalled.
  double noise_floor = 1e-4;
  /// @throws InvalidInput naming the member
  ROBOMILL_API void validate() const;
};

/// What the FRF shows of one unknown.
struct JointKnowledge {
  double deviation = 0.0;  ///< standard deviation, in the unknown's unit; infinite where the FRF sets no upper bound,
                           ///< or the search did not end at a minimum or misses the FRF
  /// Whether the FRF bounds it from both sides: 2 · deviation < value, and |value - bound| > 1e-6 · |bound| for both
  /// bounds of the search.
  bool identifiable = false;
  /// Of a stiffness: beyond it the FRF cannot distinguish the joint from a rigid one. 0 for damping.
  double visible_up_to = 0.0;
  std::string note =
      {};  ///< a sentence where it is not identifiable: "rotational damping: not identifiable from this FRF"
};

struct JointFitResult {
  /// converged: the last steps gained nearly nothing. hybrid: least squares ended with |Δcost| <= 1e-10 · cost or
  /// |Δx| <= 1e-13 · |x|. ga: the last fifth of the generations lowered the objective by <= 1 % of itself, or
  /// it is 0 but for rounding.
  /// stalled: ga alone; all generations together lowered the objective of the best of the random start by no more than
  /// noise_floor of itself, so that the joint is as good as a random one of the bounds.
  /// not_converged: iterations or generations ran out first; the joint is the best one found.
  enum class Status { converged, not_converged, stalled };
  Status status = Status::not_converged;
  Joint joint;
  double objective_m_per_n = 0.0;  ///< ‖ |H11| - |H11 model| ‖₂ over the lines
  double relative_error = 0.0;     ///< ‖H11 - H11 model‖ / ‖H11‖, complex
  std::array<JointKnowledge, joint_unknowns> knowledge;
  int iterations = 0;  ///< generations and steps together
  double start = 0.0;  ///< the misfit of the best individual of the random start, as the first of `best`
  /// The misfit after each: of ga the objective [m/N]; of hybrid first the evolution's, the mean over thinned lines of
  /// |H - H model|² / (|H|² + |H model|²), then root mean squares of |H - H model| / σ.
  std::vector<double> best;
  modal::FrfSet model;             ///< H11 of the joint found, at the lines fitted
  std::vector<double> suspect_hz;  ///< lines where holder or tip would create energy, beyond their noise
  std::vector<std::string> notes;
};

inline constexpr Name<JointFitResult::Status> joint_status_names[] = {
    {"converged", JointFitResult::Status::converged},
    {"not converged", JointFitResult::Status::not_converged},
    {"stalled", JointFitResult::Status::stalled}};

/// Finds the joint with which the assembly's tip moves as measured. Of the assembly's own joint the cross stiffness is
/// kept, and where it stands: at the mouth, or at several points along the shank, each with an equal share of the whole
/// joint that is found. Method and accuracy in README.md.
/// @param measured  holds xx (or yy, by options.axis), of the unnumbered tip or of one point alone; with a measured
///     holder on its axis. A line at 0 Hz is left out.
/// @throws InvalidInput if an option, the assembly or the set is not valid, the FRF is missing, zero or creates energy
///     at most lines, the axes differ, or nothing holds the tool
/// @throws Interrupted when progress says so
/// Source: [JointIdentification] (ga); [Storn1997] (differential evolution)
[[nodiscard]] ROBOMILL_API JointFitResult fit_joint(const Assembly& assembly, const modal::FrfSet& measured,
                                                    const JointFitOptions& options,
                                                    Progress& progress = Progress::none());

}  // namespace robomill::coupling
