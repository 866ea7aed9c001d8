#pragma once
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/modal/files/hit_guess.hpp"

namespace robomill::jobs {

/// Of a hammer [mV/N] and an accelerometer [mV/g] of which nothing is known: to show, not to compute with.
inline constexpr std::string_view usual_force_mv_per_n = "2.25", usual_response_mv_per_g = "100";

/// A record that looks like one of a hit.
struct FoundHit {
  std::string file = {};  ///< relative to hits.toml
  io::Format format = io::Format::unknown;
  double sample_rate_hz = 0.0;  ///< 0: not known
  bool rounded_time = false;    ///< its column of time has too few digits to be read: the rate is that of all of it
  modal::HitGuess guess = {};
};
struct FoundHits {
  std::vector<FoundHit> hits = {};
  std::vector<std::string> left_out = {};  ///< "NAME: why"
};

/// [acquisition] has one sample rate, one unit for the forces of all records and one for their responses: records that
/// differ in them from what most have are left out.
void keep_what_goes_together(FoundHits& found);

/// hits.toml: that of the template where nothing was found, else the template's keys with a table for each record, what
/// is guessed from it marked so. What no record says (sensitivities, a rate) stands behind a #.
[[nodiscard]] std::string hits_document(const FoundHits& found, bool example);

/// In which directions there are hits and sensors.
struct MeasuredAxes {
  std::set<char> excitations = {}, responses = {};
};
[[nodiscard]] MeasuredAxes measured_axes(const FoundHits& found);

/// The one of x and y that was not measured; 0: both were, or nothing is known.
[[nodiscard]] char unmeasured_axis(const MeasuredAxes& measured);

/// job.toml, which asks what a direction is taken for that was not measured.
/// @param cut_beside  a lobes.toml is there: the job names it, and does not contain the cut
[[nodiscard]] std::string job_document(const MeasuredAxes& measured, bool cut_beside, bool example);

/// cell.toml with an arm of cell::known_arms(); of workpiece and tool what data/cells has stands where the template
/// shows its own. Empty: the template's arm.
/// @throws InvalidInput naming those that are known
[[nodiscard]] std::string cell_document(const std::string& robot, bool example);

}  // namespace robomill::jobs
