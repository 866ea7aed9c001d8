#pragma once
#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/tip.hpp"

// Method: robomill/stability/README.md, "In the frequency domain (`frequency_response.hpp`)"

namespace robomill::stability {

struct LobesProblem;

/// Where the structure answers most: a peak, and half its width.
struct Resonance {
  double frequency_rad_per_s = 0.0;
  double half_width_rad_per_s = 0.0;
};

/// The mode that moves most under a force.
struct MovedMode {
  modal::ModeId id = {};        ///< unknown: there are no modes
  double frequency_hz = 0.0;    ///< its natural frequency
  double displacement_m = 0.0;  ///< ‖q‖ of its share of q e^{iωt}
};

/// The receptance at the tip, q = G(iω) F with q and F in x and y of the feed [m/N]: that of modes, at any frequency
/// and exactly; or straight from measured FRFs, with no model between. Of several parts (tool, workpiece) the sum
/// counts.
///
/// Measured FRFs between their lines, below and above their band: see frf_interpolation.hpp.
class ROBOMILL_API FrequencyResponse {
 public:
  FrequencyResponse() = default;
  /// The modes of tool and workpiece, with the real parts of the stiffness residuals.
  /// @throws InvalidInput if the problem is not valid
  [[nodiscard]] static FrequencyResponse of_modes(const LobesProblem& problem);
  /// The same of one structure, in the feed's frame.
  [[nodiscard]] static FrequencyResponse of_modes(const modal::TipModes& modes);
  /// xx, yx, xy, yy at the tool tip in fixed axes; a direct FRF that is missing belongs to a rigid direction, a cross
  /// FRF that is missing is 0.
  /// @param feed_direction_rad  of the feed in the x-y plane, counter-clockwise from x [rad]
  /// @throws InvalidInput if the set is not valid, has neither xx nor yy at a tip, several points that could be it, or
  /// fewer than 8 lines
  [[nodiscard]] static FrequencyResponse of_frfs(const modal::FrfSet& frfs, double feed_direction_rad);
  /// Receptances of tool and workpiece add: what counts in a cut is the displacement of one against the other.
  FrequencyResponse& operator+=(const FrequencyResponse& other);

  /// G(iω), for ω of either sign [m/N].
  [[nodiscard]] Eigen::Matrix2cd at(double frequency_rad_per_s) const;
  [[nodiscard]] bool measured() const;
  /// Band in which all measured parts have lines [rad/s]; 0 and infinity for modes.
  [[nodiscard]] double low_rad_per_s() const { return low_; }
  [[nodiscard]] double high_rad_per_s() const { return high_; }
  [[nodiscard]] bool covers(double frequency_rad_per_s) const;
  /// By frequency.
  [[nodiscard]] const std::vector<Resonance>& resonances() const { return resonances_; }
  /// What G and s (G - compliance) tend to at high frequency [m/N, m/(N s)].
  [[nodiscard]] const Eigen::Matrix2d& compliance() const { return compliance_; }
  [[nodiscard]] const Eigen::Matrix2d& first_moment() const { return first_moment_; }
  /// Above it there is neither a resonance nor a measured line.
  [[nodiscard]] double smooth_from_rad_per_s() const { return smooth_from_; }
  /// Greatest ‖G‖ (Frobenius) at a resonance [m/N].
  [[nodiscard]] double highest_peak() const;
  /// Of a displacement q e^{iωt} that a force F e^{iωt} makes: the mode whose share is greatest.
  [[nodiscard]] MovedMode mode_of(double frequency_rad_per_s, const Eigen::Vector2cd& force) const;

 private:
  struct Part;
  void add(std::shared_ptr<const Part> part);

  std::vector<std::shared_ptr<const Part>> parts_;
  std::vector<Resonance> resonances_;
  Eigen::Matrix2d compliance_ = Eigen::Matrix2d::Zero(), first_moment_ = Eigen::Matrix2d::Zero();
  double smooth_from_ = 0.0, low_ = 0.0, high_ = std::numeric_limits<double>::infinity();
};

}  // namespace robomill::stability
