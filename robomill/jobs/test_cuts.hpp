#pragma once
#include <string>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/report/report.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::jobs {

/// What the peaks in the spectrum of a cut are, as stability::explain reads them, without their amplitudes.
/// @throws InvalidInput as stability::explain
[[nodiscard]] std::vector<report::Peak> name_peaks(const std::vector<double>& frequency_hz,
                                                   double spindle_speed_rad_per_s,
                                                   const stability::LobesProblem& problem, double tolerance_hz);

/// Test cuts beside their predictions. A borderline cut agrees where the predicted limit at its speed lies within 20 %
/// of its depth; a cut without a result is predicted but not compared.
[[nodiscard]] std::vector<report::TestCut> compare_cuts(const std::vector<TestCut>& cuts,
                                                        const stability::LobesProblem& problem,
                                                        const stability::LobesOptions& options, Progress& progress);

/// The spectrum of a cut's recording with its peaks named. It says chatter where a peak that is no multiple of the
/// rotation is at least half as high as the highest multiple; borderline from a quarter; nothing where that hangs on a
/// peak that may be either.
/// @throws InvalidInput if the recording cannot be read or is shorter than 0.2 s
[[nodiscard]] report::Recording read_recording(const TestCut& cut, const stability::LobesProblem& problem);

}  // namespace robomill::jobs
