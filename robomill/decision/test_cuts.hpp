#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/peak_classification.hpp"

// Method: robomill/decision/README.md, "Test cuts (`test_cuts.hpp`)"

namespace robomill::decision {

/// What a cut did, or is predicted to do. Of a recording by the ratio r of its highest peak that is no multiple of the
/// rotation to the highest multiple.
enum class Verdict {
  unknown,     ///< nobody said, or a recording that may be either: the cut is predicted and not compared
  stable,      ///< no chatter. Predicted: |μ| < 1; recorded: r < 0.25
  borderline,  ///< marks that come and go; agrees where |predicted limit / depth - 1| <= 0.2; recorded: 0.25 <= r < 0.5
  chatter      ///< predicted: |μ| >= 1; recorded: r >= 0.5
};
inline constexpr Name<Verdict> verdict_names[] = {
    {"stable", Verdict::stable}, {"borderline", Verdict::borderline}, {"chatter", Verdict::chatter}};
/// "stable", …; empty where it is unknown.
[[nodiscard]] ROBOMILL_API std::string_view to_string(Verdict verdict);

/// What a machinist saw and measured at one test cut.
struct TestCut {
  double spindle_speed_rad_per_s = 0.0;  ///< > 0
  double axial_depth_m = 0.0;            ///< > 0
  Verdict result = Verdict::unknown;
  std::vector<double> peaks_hz = {};  ///< peaks of its spectrum, where known
  std::filesystem::path file = {};    ///< its recording, where there is one
  std::string column = "1";           ///< the recording's column, name or number from 1
  double scale = 1.0;                 ///< of a WAV: what full scale means, in m/s²
  double sample_rate_hz = 0.0;        ///< of a recording without a time column; 0: from the file
};

/// What was recorded of a test cut.
struct CutSignal {
  Eigen::VectorXd acceleration;         ///< length n [m/s^2]
  double sample_rate_hz = 0.0;          ///< > 0
  std::vector<std::string> notes = {};  ///< sentences for the user
};
/// A cut that was made, beside what was predicted for it.
struct ComparedCut {
  TestCut cut = {};
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
/// @throws InvalidInput if the recording is shorter than 0.2 s
[[nodiscard]] ROBOMILL_API Recording judge_recording(const TestCut& cut, const CutSignal& recorded,
                                                     const stability::LobesProblem& problem);

}  // namespace robomill::decision
