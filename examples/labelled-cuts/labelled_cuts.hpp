#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "robomill/cutting/milling.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::examples {

/// A tool's modes, one along x and one along y.
struct ToolModes {
  std::array<double, 2> frequency_hz = {}, damping_ratio = {}, stiffness_n_per_m = {};
  [[nodiscard]] modal::ModalModel model() const;
};
/// The machine of the example.
inline constexpr ToolModes true_modes{
    .frequency_hz = {410.0, 345.0}, .damping_ratio = {0.03, 0.035}, .stiffness_n_per_m = {8e6, 6e6}};

/// How wide the cuts are, and in which direction.
struct CutKind {
  cutting::MillingDirection direction = cutting::MillingDirection::down;
  double radial_depth_m = 0.003;
};

/// A cut, and whether each of two operators calls it chatter.
struct LabelledCut {
  double spindle_speed_rad_per_s = 0.0, axial_depth_m = 0.0;
  std::array<bool, 2> chatter = {};
};

/// Limits [m] of a three-tooth end mill of 16 mm at these speeds [rad/s], by the zeroth-order method; infinite above
/// 12 mm.
[[nodiscard]] std::vector<double> limits(const modal::ModalModel& modes, const CutKind& kind,
                                         const std::vector<double>& spindle_speed_rad_per_s);

/// Down-milling at twelve speeds, ten depths each, 3 mm wide. An operator calls a cut chatter with the probability
///   0.04 + 0.92 / (1 + (limit / depth)^12),
/// each by himself.
[[nodiscard]] std::vector<LabelledCut> label_cuts(std::uint64_t seed);

/// Modes between 150 and 1,000 Hz, 1 and 10 %, 3·10⁵ and 6·10⁷ N/m under which the labels are most likely, as far as a
/// random search with refinement finds them, with the operators' probabilities and the force coefficients as they are.
struct LabelFit {
  ToolModes modes;
  double log_likelihood = 0.0, log_likelihood_of_true = 0.0;
};
[[nodiscard]] LabelFit fit_to_labels(const std::vector<LabelledCut>& cuts, std::uint64_t seed);

/// The depth above which the labels are most often chatter.
[[nodiscard]] double threshold_of(const std::vector<LabelledCut>& cuts);

/// Modes fitted to FRFs of the tip with 5 % noise, as hits give them.
[[nodiscard]] modal::ModalModel tap_test(std::uint64_t seed);

/// Cuts of a kind whose stability is asked for: random speeds, depths within a factor of two of the true limit.
struct Question {
  std::vector<double> spindle_speed_rad_per_s, axial_depth_m;
  std::vector<bool> chatter;  ///< as it is
};
[[nodiscard]] Question ask(const CutKind& kind, std::uint64_t seed);
/// Share of the answers that are right.
[[nodiscard]] double answered(const Question& question, const CutKind& kind, const modal::ModalModel& modes);
[[nodiscard]] double answered(const Question& question, double threshold_m);

}  // namespace robomill::examples
