#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/modal/hits.hpp"

// Method: robomill/modal/README.md, "Several hits in one record"

namespace robomill::modal {

/// Pulses closer than this are one hit with its bounces [s], as in a stream (HitTrigger).
inline constexpr double usual_hit_spacing_s = 0.5;

/// The part of a record that is of one hit; places in samples.
struct HitSegment {
  Eigen::Index begin = 0;  ///< before the pulse
  Eigen::Index end = 0;    ///< behind its last sample
  Eigen::Index onset = 0;  ///< where the first pulse begins
  Eigen::Index peak = 0;   ///< of the highest pulse
  Eigen::Index after = 0;  ///< samples from the onset to the next hit, or to the record's end
};

/// Where the hits of a record lie; empty: it has one at most, and is to stay whole.
/// @param force_n  finite
/// @param spacing_s  a pulse begins another hit where no pulse was seen for so long
[[nodiscard]] std::vector<HitSegment> find_hit_segments(const Eigen::VectorXd& force_n, double sample_rate_hz,
                                                        double spacing_s = usual_hit_spacing_s);

/// The hits of one record, cut apart: "FILE, hit 3 of 5 at 12.34 s". A record with one hit at most comes back as it is.
/// Those whose record is too short beside the others', or whose response has another size, are marked (Hit::fault).
/// @param begin_s  time of the record's first sample
[[nodiscard]] std::vector<Hit> split_hits(Hit record, double spacing_s, double begin_s = 0.0);

}  // namespace robomill::modal
