#pragma once
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/stability/peak_classification.hpp"

namespace robomill::stability {

/// What `robomill explain` writes.
struct PeaksView {
  const PeakClassification* peaks = nullptr;
  const ChatterMechanism* mechanism = nullptr;  ///< null: no cut was given
};
[[nodiscard]] const io::Schema<PeaksView>& explain_table();
[[nodiscard]] std::string peak_classification_json(const PeakClassification& classification,
                                                   const ChatterMechanism* mechanism);

/// A row a peak, with the best reading of those that are named.
[[nodiscard]] std::string peaks_csv(const PeakClassification& classification);

}  // namespace robomill::stability
