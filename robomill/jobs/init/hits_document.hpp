#pragma once
#include <string>

#include "robomill/modal/files/found_hits.hpp"

namespace robomill::jobs {

/// hits.toml: that of the template where nothing was found, else the template's keys with a table for each record, what
/// is guessed from it marked so. What no record says (sensitivities, a rate) stands behind a #.
[[nodiscard]] std::string hits_document(const modal::FoundHits& found, bool example);

/// The one of x and y that was not measured; 0: both were, or nothing is known.
[[nodiscard]] char unmeasured_axis(const modal::MeasuredAxes& measured);

/// job.toml, which asks what a direction is taken for that was not measured.
/// @param cut_beside  a lobes.toml is there: the job names it, and does not contain the cut
[[nodiscard]] std::string job_document(const modal::MeasuredAxes& measured, bool cut_beside, bool example);

/// cell.toml with an arm of cell::known_arms(); of workpiece and tool what data/cells has stands where the template
/// shows its own. Empty: the template's arm.
/// @throws InvalidInput naming those that are known
[[nodiscard]] std::string cell_document(const std::string& robot, bool example);

}  // namespace robomill::jobs
