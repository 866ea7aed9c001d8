#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/peak_classification.hpp"

// Method: robomill/jobs/README.md, "Test cuts (`test_cuts.hpp`)"

namespace robomill::jobs {

/// A cut that was made, beside what was predicted for it.
struct ComparedCut {
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;
  Verdict result = Verdict::unknown;  ///< as made
  Verdict predicted = Verdict::unknown;
  double limit_depth_m = std::numeric_limits<double>::quiet_NaN();  ///< predicted at this speed; NaN: none in the range
  std::optional<bool> agrees = {};                                  ///< none where there is nothing to compare
  std::string note = {};                                            ///< "predicted |μ| = 1.204, 566.1 Hz (mode 8)"
};

/// How many test cuts came out as predicted.
struct Agreement {
  std::size_t agree = 0, disagree = 0, not_compared = 0;
};
[[nodiscard]] ROBOMILL_API Agreement agreement(const std::vector<ComparedCut>& cuts);

/// A peak in the spectrum of a recorded cut.
struct Peak {
  double frequency_hz = 0.0;
  double amplitude = 0.0;  ///< [m/s^2]
  stability::Explanation::Kind kind = stability::Explanation::Kind::unexplained;
  std::string text = {};  ///< what it is: "29 × rotation", "mode 8"
};

/// The spectrum of a recorded cut.
struct Recording {
  std::string file = {};
  double spindle_speed_rad_per_s = 0.0;  ///< > 0
  int teeth = 0;                         ///< > 0
  double axial_depth_m = 0.0;
  Eigen::VectorXd frequency_hz = {};  ///< length n, increasing
  Eigen::VectorXd amplitude = {};     ///< length n, >= 0 [m/s^2]
  std::vector<Peak> peaks = {};
  Verdict verdict = Verdict::unknown;   ///< what the spectrum says
  std::string reason = {};              ///< why
  std::vector<std::string> notes = {};  ///< on the record, for the user
};

/// What the peaks in the spectrum of a cut are, as stability::explain reads them, without their amplitudes.
/// @param tolerance_hz  > 0; of stability::PeakClassificationOptions, held to <= 0.24 of the rotation frequency
/// @throws InvalidInput as stability::explain
[[nodiscard]] ROBOMILL_API std::vector<Peak> name_peaks(const std::vector<double>& frequency_hz,
                                                        double spindle_speed_rad_per_s,
                                                        const stability::LobesProblem& problem, double tolerance_hz);

/// Test cuts beside their predictions. A borderline cut agrees where the predicted limit at its speed lies within 20 %
/// of its depth; a cut without a result is predicted but not compared.
[[nodiscard]] ROBOMILL_API std::vector<ComparedCut> compare_cuts(const std::vector<TestCut>& cuts,
                                                                 const stability::LobesProblem& problem,
                                                                 const stability::LobesOptions& options,
                                                                 Progress& progress);

/// The spectrum of a cut's recording with its peaks named. It says chatter where a peak that is no multiple of the
/// rotation is at least half as high as the highest multiple; borderline from a quarter; nothing where that hangs on a
/// peak that may be either.
/// @throws InvalidInput if the recording cannot be read or is shorter than 0.2 s
[[nodiscard]] ROBOMILL_API Recording read_recording(const TestCut& cut, const stability::LobesProblem& problem);

}  // namespace robomill::jobs
