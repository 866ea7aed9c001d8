#pragma once
// Stable or chatter at postures that nobody measured: what predicted modes say of random cuts, judged by a simulation
// in time of the same cuts with the arm's true modes.
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "robomill/stability/lobes.hpp"
#include "testing/modal/posture_judge.hpp"
#include "testing/modal/simulated_arm.hpp"

namespace robomill::modal::testing {

/// Where a cut comes from.
enum class CutFamily {
  published,  ///< one of the 32 cuts of [RobotMillingChatter], its depth the same share of the limit
  flat_end,   ///< a random flat end, its depth uniform from 0 to twice the limit
  ball_end    ///< a random leaning ball end, the same
};
inline constexpr std::array<const char*, 3> cut_family_names{"published", "flat end", "ball end"};

/// One cut in one posture.
struct JudgedCut {
  CutFamily family = CutFamily::published;
  std::size_t posture = 0;         ///< of the held-out ones
  stability::LobesProblem cut;     ///< without dynamics
  Eigen::Matrix3d feed_from_base;  ///< R of P_F = R P_B, F the feed's frame: z along the tool where nothing leans
  double spindle_speed_rad_per_s = 0.0, axial_depth_m = 0.0;
  double limit_m = 0.0;   ///< lowest unstable depth with the true modes
  bool chatters = false;  ///< as simulated
};

struct PostureVerdictOptions {
  int cuts = 16;             ///< in each posture: half published ones, a quarter flat and a quarter ball ends
  std::size_t postures = 8;  ///< of the held-out ones, the first
  /// What the arm has above it stands still in the simulation, as SimulatedArm::modes says; infinite: nothing does.
  double up_to_hz = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 1;  ///< of the cuts
};

struct VerdictCounts {
  int right = 0, wrongly_stable = 0, wrongly_unstable = 0;
  [[nodiscard]] int all() const { return right + wrongly_stable + wrongly_unstable; }
  VerdictCounts& operator+=(const VerdictCounts& other);
};
struct VerdictScore {
  std::array<VerdictCounts, 3> family = {};  ///< in the order of CutFamily
  VerdictCounts near;                        ///< cuts within 10 % of the limit, of all families
  [[nodiscard]] VerdictCounts all() const;
  VerdictScore& operator+=(const VerdictScore& other);
};

/// Cuts at the held-out postures of an arm, simulated once.
class PostureVerdicts {
 public:
  /// @param arm  outlives this
  explicit PostureVerdicts(const SimulatedArm& arm, const PostureVerdictOptions& options = {});
  /// Whether |μ| < 1 with the predicted modes says of each cut what the simulation with the true modes shows. What has
  /// no modes is stable.
  [[nodiscard]] VerdictScore judge(const PosturePredictor& predict) const;
  [[nodiscard]] const std::vector<JudgedCut>& cuts() const { return cuts_; }

 private:
  const SimulatedArm* arm_;
  std::vector<JudgedCut> cuts_;  // posture by posture
};

}  // namespace robomill::modal::testing
