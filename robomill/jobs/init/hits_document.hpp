#pragma once
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/modal/files/hit_guess.hpp"

namespace robomill::jobs {

/// Of a hammer [mV/N] and an accelerometer [mV/g] of which nothing is known.
inline constexpr std::string_view usual_force_mv_per_n = "2.25", usual_response_mv_per_g = "100";

/// A record that looks like one of a hit.
struct FoundHit {
  std::string file = {};  ///< relative to hits.toml
  io::Format format = io::Format::unknown;
  double sample_rate_hz = 0.0;  ///< 0: not known
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
/// is guessed marked so.
[[nodiscard]] std::string hits_document(const FoundHits& found);

/// In which directions there are hits and sensors.
struct MeasuredAxes {
  std::set<char> excitations = {}, responses = {};
};
[[nodiscard]] MeasuredAxes measured_axes(const FoundHits& found);

/// job.toml, which says what a direction is taken for that was not measured.
[[nodiscard]] std::string job_document(const MeasuredAxes& measured);

/// cell.toml with an arm of known_arms(), workpiece and tool where data/cells has them; empty: the template's arm.
/// @throws InvalidInput naming those that are known
[[nodiscard]] std::string cell_document(const std::string& robot);

}  // namespace robomill::jobs
