#pragma once
#include <string>

#include "robomill/stability/peak_classification.hpp"

namespace robomill::stability {

/// What `robomill explain` writes: spindle speed, every peak with what it is and what else it could be, the mode that
/// chatters; the verdict on the delay, or null where no cut was given.
[[nodiscard]] std::string peak_classification_json(const PeakClassification& classification,
                                                   const ChatterMechanism* verdict);

/// A row a peak, with the best reading of those that are named.
[[nodiscard]] std::string peaks_csv(const PeakClassification& classification);

}  // namespace robomill::stability
