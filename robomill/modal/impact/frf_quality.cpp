#include "robomill/modal/impact/frf_quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <limits>

#include "robomill/base/statistics.hpp"
#include "robomill/modal/peaks.hpp"

namespace robomill::modal {
namespace {

using Eigen::Index;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Lines first … first + count - 1 of an FRF, between which it is graded.
struct Lines {
  Index first = 0;
  Index count = 0;
  [[nodiscard]] bool none() const { return count < 3; }
};

Lines lines_between(const Eigen::VectorXd& frequency_hz, double low_hz, double high_hz) {
  const double* const begin = frequency_hz.data();
  const double* const end = begin + frequency_hz.size();
  const Index first = std::lower_bound(begin, end, low_hz) - begin;
  const Index last = std::upper_bound(begin, end, high_hz) - begin;
  return {.first = first, .count = std::max<Index>(0, last - first)};
}

bool quiet(const Eigen::VectorXd& relative_error, const Lines& lines) {
  const Index good = (relative_error.segment(lines.first, lines.count).array() < 0.1).count();
  return 5 * good >= 4 * lines.count;
}

double reciprocity_error(const FrfSet& set, const Frf& frf, const Lines& lines) {
  const Frf* const mirror = set.find({.response = frf.name.excitation, .excitation = frf.name.response});
  if (mirror == nullptr || mirror == &frf || lines.none()) return unknown;
  const Eigen::VectorXcd here = frf.receptance.segment(lines.first, lines.count);
  const Eigen::VectorXcd there = mirror->receptance.segment(lines.first, lines.count);
  return 2.0 * (here - there).norm() / (here.norm() + there.norm());
}

class Judge {
 public:
  explicit Judge(FrfGrade& grade) : grade_(grade) { grade_.grade = Grade::good; }
  void minor(std::string fault, std::string remedy) { report(Grade::usable, std::move(fault), std::move(remedy)); }
  void major(std::string fault, std::string remedy) { report(Grade::poor, std::move(fault), std::move(remedy)); }
  void weigh(bool is_major, std::string fault, std::string remedy) {
    report(is_major ? Grade::poor : Grade::usable, std::move(fault), std::move(remedy));
  }

 private:
  void report(Grade at_best, std::string fault, std::string remedy) {
    grade_.grade = std::max(grade_.grade, at_best);
    grade_.faults.push_back(std::move(fault));
    grade_.remedies.push_back(std::move(remedy));
  }
  FrfGrade& grade_;
};

void judge_noise(Judge& judge, const FrfGrade& grade, const FrfEvidence& evidence, const Lines& lines) {
  if (evidence.hits == 1) {
    judge.minor("there is one hit only, so no coherence shows whether hits agree", "hit again, five times in all");
    if (grade.relative_noise > 0.1) {
      judge.weigh(grade.relative_noise > 0.3, fmt::format("noise is {:.0f} % of the FRF", 100.0 * grade.relative_noise),
                  "hit harder, or use a more sensitive accelerometer");
    }
    return;
  }
  if (evidence.hits == 2) judge.minor("there are two hits only", "hit again, five times in all");
  if (grade.mean_coherence >= 0.95) return;
  const std::string fault = fmt::format("mean coherence is {:.2f}", grade.mean_coherence);
  const double sensor = median(evidence.sensor_noise.segment(lines.first, lines.count));
  if (sensor > 0.5 * grade.relative_noise) {
    judge.weigh(grade.mean_coherence < 0.8, fault + ": the response is weak against the noise of its sensor",
                "hit harder, or use a more sensitive accelerometer");
  } else {
    judge.weigh(grade.mean_coherence < 0.8, fault + ": the hits do not agree with each other",
                "hit again, always on the same spot and in the same direction; see that the accelerometer sits firmly");
  }
}

void judge_band(Judge& judge, const FrfGrade& grade, const HitOptions& options) {
  if (options.max_frequency_hz > 0.0 && grade.excited_high_hz < 0.9 * options.max_frequency_hz) {
    judge.minor(fmt::format("the hammer excites nothing above {:.0f} Hz", grade.excited_high_hz), "use a harder tip");
  }
  if (options.min_frequency_hz > 0.0 && grade.lowest_trustworthy_frequency_hz > 1.1 * options.min_frequency_hz) {
    judge.minor(fmt::format("noise rules below {:.3g} Hz", grade.lowest_trustworthy_frequency_hz),
                "use a softer tip, a heavier hammer or an accelerometer for low frequencies");
  }
}

// Where force and response are one degree of freedom, a passive structure has Im H <= 0. The lines about the resonances
// decide, weighted as mobilities are: what a slow drift adds to H grows as 1/f² to low frequencies and has any phase,
// but makes no resonance. Of a right sign the share is near -0.7.
void judge_sign(Judge& judge, const FrfSet& set, const Frf& frf, const Lines& lines,
                const std::vector<FrfPeak>& peaks) {
  constexpr double near = 0.02, least_share = 0.2;
  if (frf.name.response != frf.name.excitation) return;
  double part = 0.0, whole = 0.0;
  for (Index i = lines.first; i < lines.first + lines.count; ++i) {
    const double frequency_hz = set.frequency_hz(i);
    const auto is_near = [&](const FrfPeak& peak) {
      return std::abs(frequency_hz - peak.frequency_hz) <= near * peak.frequency_hz;
    };
    if (std::ranges::none_of(peaks, is_near)) continue;
    const double weight = frequency_hz * frequency_hz * std::abs(frf.receptance(i));
    part += weight * frf.receptance(i).imag();
    whole += weight * std::abs(frf.receptance(i));
  }
  if (part > least_share * whole) {
    judge.minor("the response runs against the force: Im H > 0 at the resonances",
                "check the signs of hammer and accelerometer (force_direction = \"-x\" for a hit against the axis)");
  }
}

/// The resonances that stand out of the noise, on their lines.
std::vector<FrfPeak> highest_peaks(const FrfSet& set, const Frf& frf, const Lines& lines) {
  constexpr std::size_t most = 6;
  const Frf part{.name = frf.name, .receptance = frf.receptance.segment(lines.first, lines.count)};
  std::vector<FrfPeak> peaks;
  for (const Peak& peak : pick_peaks(set.frequency_hz.segment(lines.first, lines.count), {&part})) {
    peaks.push_back({.frequency_hz = peak.frequency_hz, .receptance_m_per_n = peak.receptance});
  }
  std::ranges::stable_sort(peaks, std::greater<>(), &FrfPeak::receptance_m_per_n);
  if (peaks.size() > most) peaks.resize(most);
  std::ranges::stable_sort(peaks, {}, &FrfPeak::frequency_hz);
  return peaks;
}

FrfGrade grade_one(const FrfSet& set, const Frf& frf, const FrfEvidence& evidence, const HitOptions& options) {
  FrfGrade grade;
  grade.name = frf.name;
  grade.hits = evidence.hits;
  const Band excited = excited_band(set.frequency_hz, evidence.force_n_s);
  grade.excited_low_hz = excited.low_hz;
  grade.excited_high_hz = excited.high_hz;
  grade.lowest_trustworthy_frequency_hz = lowest_trustworthy(
      set.frequency_hz, (evidence.relative_noise.cwiseAbs2() + evidence.drift.cwiseAbs2()).cwiseSqrt());
  const Lines lines =
      lines_between(set.frequency_hz, std::max(excited.low_hz, grade.lowest_trustworthy_frequency_hz), excited.high_hz);
  Judge judge(grade);
  if (lines.none()) {
    judge.major("noise rules the whole band that the hammer excites",
                "hit harder, use a more sensitive accelerometer, check cables and the accelerometer's mount");
    return grade;
  }
  grade.relative_noise = median(evidence.relative_noise.segment(lines.first, lines.count));
  if (frf.coherence.size() > 0) grade.mean_coherence = frf.coherence.segment(lines.first, lines.count).mean();
  grade.reciprocity_error = reciprocity_error(set, frf, lines);
  grade.peaks = highest_peaks(set, frf, lines);

  judge_noise(judge, grade, evidence, lines);
  judge_band(judge, grade, options);
  judge_sign(judge, set, frf, lines, grade.peaks);
  if (grade.reciprocity_error > 0.2) {
    judge.minor(
        fmt::format("{} and its mirror differ by {:.0f} %", to_string(frf.name), 100.0 * grade.reciprocity_error),
        "check the directions of hammer and accelerometer; a robot held by its drives may truly be so");
  }
  if (evidence.remaining > 0.02) {
    judge.minor(fmt::format("{:.0f} % of the vibration at {:.3g} Hz is left when the record ends",
                            100.0 * evidence.remaining, evidence.remaining_hz),
                "record longer");
  }
  if (evidence.restless) judge.minor("the structure moved before it was hit", "wait longer between hits");
  return grade;
}

}  // namespace

std::string to_string(Grade grade) {
  switch (grade) {
    case Grade::good:
      return "good";
    case Grade::usable:
      return "usable";
    case Grade::poor:
      break;
  }
  return "poor";
}

Band excited_band(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& force_n_s) {
  Index top = 0;
  const double floor = 0.1 * force_n_s.maxCoeff(&top);
  Index low = top;
  while (low > 0 && force_n_s(low - 1) >= floor) --low;
  Index high = top;
  while (high + 1 < force_n_s.size() && force_n_s(high + 1) >= floor) ++high;
  return {.low_hz = frequency_hz(low), .high_hz = frequency_hz(high)};
}

Eigen::VectorXd drift_of(const Eigen::VectorXcd& ratio, double spacing_rad_per_s, int integrations) {
  constexpr Index first = 2;
  constexpr Index count = 8;
  Eigen::VectorXcd acceleration = ratio.segment(first, count);
  const double power = acceleration.squaredNorm() / static_cast<double>(count);
  for (Index i = 0; i < count; ++i) {
    const std::complex<double> s(0.0, spacing_rad_per_s * static_cast<double>(first + i));
    if (integrations == 1) acceleration(i) *= s;
  }
  const double real_part = acceleration.real().sum();
  const bool free_body = real_part > 0.98 * acceleration.cwiseAbs().sum();
  Eigen::VectorXd drift = Eigen::VectorXd::Zero(ratio.size());
  if (free_body) return drift;
  const double middle = static_cast<double>(first) + 0.5 * static_cast<double>(count - 1);
  for (Index k = 1; k < ratio.size(); ++k) drift(k) = std::sqrt(power * middle / static_cast<double>(k));
  return drift;
}

double lowest_trustworthy(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& relative_error) {
  const double highest = frequency_hz(frequency_hz.size() - 1);
  for (Index i = 0; i < frequency_hz.size();) {
    const double f = frequency_hz(i);
    const Lines third = lines_between(frequency_hz, f, std::cbrt(2.0) * f);
    const Lines octave = lines_between(frequency_hz, f, 2.0 * f);
    if (relative_error(i) < 0.1 && quiet(relative_error, third) && quiet(relative_error, octave)) return f;
    // Steps of one percent where lines lie closer than that.
    const double* const next =
        std::upper_bound(frequency_hz.data() + i, frequency_hz.data() + frequency_hz.size(), 1.01 * f);
    i = std::max<Index>(i + 1, next - frequency_hz.data());
  }
  return highest;
}

std::vector<FrfGrade> grade_frfs(const FrfSet& set, const std::vector<FrfEvidence>& evidence,
                                 const HitOptions& options) {
  std::vector<FrfGrade> grades;
  for (std::size_t i = 0; i < set.frfs.size(); ++i) {
    grades.push_back(grade_one(set, set.frfs[i], evidence[i], options));
  }
  return grades;
}

}  // namespace robomill::modal
