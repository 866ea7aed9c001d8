#include "robomill/report/report.hpp"

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/report/checks.hpp"

namespace robomill::report {
namespace {

void validate_frfs(const Report& report) {
  require_axis("frf_frequency_hz", report.frf_frequency_hz);
  const Eigen::Index n = report.frf_frequency_hz.size();
  for (std::size_t k = 0; k < report.frfs.size(); ++k) {
    const FrfPlot& frf = report.frfs[k];
    const Eigen::Index own = frf.measured_frequency_hz.size();
    require_axis(member("frfs", k, "measured_frequency_hz"), frf.measured_frequency_hz);
    require_length(member("frfs", k, "measured"), frf.measured.size(), own > 0 ? own : n, true);
    require_length(member("frfs", k, "predicted"), frf.predicted.size(), n, true);
    require_length(member("frfs", k, "fitted"), frf.fitted.size(), n, true);
    require_length(member("frfs", k, "coherence"), frf.coherence.size(), n, true);
  }
}

/// What the drawing needs; the rest is the assembly's own business.
void validate_segments(const std::string& list, const std::vector<coupling::Segment>& segments) {
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const coupling::Segment& segment = segments[k];
    require_positive(member(list, k, "length_m").c_str(), segment.length_m, "m");
    require_positive(member(list, k, "diameter_m").c_str(), segment.diameter_m, "m");
    require_non_negative(member(list, k, "inner_diameter_m").c_str(), segment.inner_diameter_m, "m");
    if (segment.inner_diameter_m >= segment.diameter_m) {
      throw InvalidInput(member(list, k, "inner_diameter_m"), segment.inner_diameter_m, "m",
                         "must be below the diameter");
    }
  }
}

void validate_prediction(const Prediction& prediction) {
  const coupling::Assembly& assembly = prediction.assembly;
  if (assembly.tool.empty()) throw InvalidInput("prediction.assembly.tool", "is empty");
  validate_segments("prediction.assembly.tool", assembly.tool);
  validate_segments("prediction.assembly.holder.segments", assembly.holder.segments);
  if (!assembly.joint || assembly.joint->points == 1) return;
  validate_segments("prediction.assembly.joint.shank", assembly.joint->shank);
  if (assembly.joint->points < 1 || assembly.joint->points > 100) {
    throw InvalidInput("prediction.assembly.joint.points", assembly.joint->points, "", "must be in 1 … 100");
  }
  require_positive("prediction.assembly.joint.insertion_length_m", assembly.joint->insertion_length_m, "m");
}

template <class Part>
void validate_part(const char* name, const std::optional<Part>& part) {
  if (!part) return;
  try {
    part->validate();
  } catch (const InvalidInput& error) {
    throw within(name, error);
  }
}

}  // namespace

void Report::validate() const {
  if (prediction) validate_prediction(*prediction);
  validate_frfs(*this);
  validate_part("forces.", forces);
  validate_part("smooth.", smooth);
  validate_part("monitor.", monitor);
}

}  // namespace robomill::report
