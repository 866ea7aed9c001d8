#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robomill/modal/hits.hpp"
#include "robomill/modal/impact/frf_quality.hpp"
#include "robomill/modal/impact/hits_decay.hpp"
#include "robomill/modal/impact/hits_pulse.hpp"

namespace robomill::modal {

/// An accepted hit.
struct Struck {
  const Hit* hit = nullptr;
  Pulse pulse;
};

/// How all accepted hits are cut and transformed, so that they share their lines.
struct Layout {
  double sample_rate_hz = 0.0;
  Eigen::Index samples = 0;    ///< of each hit, from shortly before its pulse
  Eigen::Index transform = 0;  ///< length of the FFT, >= samples
  Eigen::Index first_line = 1;
  Eigen::Index last_line = 1;
  double decay_per_s = 0.0;  ///< 1/τ of the exponential window; 0 for none
  [[nodiscard]] double spacing_hz() const { return sample_rate_hz / static_cast<double>(transform); }
  [[nodiscard]] Eigen::Index lines() const { return last_line - first_line + 1; }
};

/// Where the stretch of a hit begins that is transformed: far enough before the pulse for what the recorder's filters
/// let ring ahead of it. Cut off, that would be an error of equal size on every line, and large after two integrations
/// at low ones.
[[nodiscard]] Eigen::Index stretch_begin(const Pulse& pulse);

/// @throws InvalidInput if nothing of the band asked for lies below half the sample rate
[[nodiscard]] Layout lay_out(const std::vector<Struck>& hits, const HitOptions& options);

/// The response on the layout's stretch without its offset, turned along its axis.
[[nodiscard]] Eigen::VectorXd response_stretch(const Struck& struck, const HitChannel& channel, const Layout& layout,
                                               ResponseKind kind);

/// One FRF as averaged over the hits of one excitation: response as recorded (acceleration, say) per force.
struct Average {
  Eigen::VectorXcd ratio;            ///< lines 0 … transform/2; seen at iω + 1/τ
  Eigen::VectorXd coherence;         ///< lines of the layout; empty from one hit
  Eigen::VectorXd deviation;         ///< the same, of ratio; empty from one hit
  Eigen::VectorXd sensor_deviation;  ///< the same, from the tails alone
  Eigen::VectorXd force_n_s;         ///< root mean square of the force spectra, on the layout's lines
};

/// @param hits  of one excitation, all with a response at `response`
/// @param tails  of that response, one for each hit
[[nodiscard]] Average average_hits(const std::vector<Struck>& hits, const std::vector<Tail>& tails, const Dof& response,
                                   const Layout& layout, const HitOptions& options);

}  // namespace robomill::modal
