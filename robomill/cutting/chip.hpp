#pragma once
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/milling.hpp"

namespace robomill::cutting::detail {

/// Along a part of an arc a tooth's chip is slope (n·x_F) + offset.
struct ChipPiece {
  double from_rad = 0.0, to_rad = 0.0;
  double slope_m = 0.0, offset_m = 0.0;
  double delay_rad = 0.0;  ///< rotation since the tooth whose surface it meets
};

/// n·x_F on a ring: mean + amplitude cos(φ - middle).
struct Forwards {
  double mean = 0.0, amplitude = 0.0, middle_rad = 0.0;
};

/// The chips of the teeth on one ring, t_j = max(0, min over m of f_m (n·x_F) + (ρ_j - ρ_{j+m}) sin κ): which tooth's
/// surface is met changes where two of these lines in n·x_F cross, and nothing is cut below the zero of the lowest.
/// Needs memory only while it grows.
class ChipShare {
 public:
  /// @param feed_m  of a revolution
  void set(const FlatEndMill& mill, int tooth, double height_m, double position_sine, double feed_m);
  /// The pieces of an arc where the tooth cuts; adds to `missed_rad` what it misses.
  [[nodiscard]] const std::vector<ChipPiece>& pieces(const Arc& arc, const Forwards& forwards, double& missed_rad);

 private:
  struct Line {
    double slope = 0.0, offset = 0.0;
    double delay_rad = 0.0;
  };
  void find_levels();
  std::vector<Line> lines_;
  std::vector<double> levels_;  ///< of n·x_F where the lowest line changes, or is 0
  std::vector<double> cuts_;
  std::vector<ChipPiece> pieces_;
  bool shared_ = false;  ///< whether there is runout
};

}  // namespace robomill::cutting::detail
