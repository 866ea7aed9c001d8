#include "robomill/stability/frequency_domain/frequency_domain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::stability {
namespace {

using std::numbers::pi;

std::string band(double low_rad_per_s, double high_rad_per_s) {
  char text[96];
  if (std::isfinite(high_rad_per_s)) {
    std::snprintf(text, sizeof text, "%.6g to %.6g Hz", low_rad_per_s / (2.0 * pi), high_rad_per_s / (2.0 * pi));
  } else {
    std::snprintf(text, sizeof text, "above %.6g Hz", low_rad_per_s / (2.0 * pi));
  }
  return text;
}

[[noreturn]] void reject(const std::string& missing, const std::string& rule, const std::string& hint) {
  throw InvalidInput(
      InvalidInput::Parts{.field = "frf", .value = "band " + missing + " missing", .rule = rule, .hint = hint});
}

/// Mean of ‖G‖ over a stretch of the band, so that noise weighs less.
double mean_size(const FrequencyResponse& response, double from, double to) {
  constexpr int points = 40;
  double sum = 0.0;
  for (int i = 0; i < points; ++i) sum += response.at(from + (to - from) * (i + 0.5) / points).norm();
  return sum / points;
}

}  // namespace

void FrequencyOptions::validate() const {
  require_positive("largest_depth_m", largest_depth_m, "m");
  if (largest_depth_m > 0.5) {
    throw InvalidInput("largest_depth_m", largest_depth_m, "m", "is deeper than any milling cut",
                       "Are the units mixed up?");
  }
  if (!(tolerance >= 1e-12 && tolerance <= 0.1)) {
    throw InvalidInput("tolerance", tolerance, "", "must lie between 1e-12 and 0.1");
  }
}

void require_coverage(const FrequencyResponse& response, const std::vector<FrequencyLimit>& limits,
                      double largest_ratio) {
  if (!response.measured()) return;
  const double low = response.low_rad_per_s();
  const double high = response.high_rad_per_s();
  const double largest = response.highest_peak();
  // An end towards which the response rises is the flank of a peak that was not measured.
  const char* const again = "Measure that band too";
  const double at_high = mean_size(response, 0.975 * high, high);
  if (at_high > 0.02 * largest && at_high > 1.02 * mean_size(response, 0.9 * high, 0.925 * high)) {
    reject(band(high, std::numeric_limits<double>::infinity()), "FRFs must reach beyond the last peak", again);
  }
  const double at_low = mean_size(response, low, 1.05 * low);
  if (low > 0.0 && at_low > 0.2 * largest && at_low > 1.15 * mean_size(response, 1.15 * low, 1.2 * low)) {
    reject(band(0.0, low), "FRFs must begin below the first peak", again);
  }
  const FrequencyLimit* worst = nullptr;
  for (const FrequencyLimit& limit : limits) {
    if (limit.status == FrequencyLimit::Status::stable_in_range) continue;
    if (worst == nullptr || limit.uncovered_ratio > worst->uncovered_ratio) worst = &limit;
  }
  if (worst == nullptr || worst->uncovered_ratio <= largest_ratio) return;
  const bool below = 2.0 * pi * worst->chatter_frequency_hz < std::sqrt(std::max(low, 1e-3 * high) * high);
  char rule[160];
  std::snprintf(rule, sizeof rule, "what is not measured moves the limit at %.6g rpm, chatter at %.5g Hz, by %.2g %%",
                worst->spindle_speed_rad_per_s * 30.0 / pi, worst->chatter_frequency_hz,
                100.0 * worst->uncovered_ratio);
  reject(below && low > 0.0 ? band(0.0, low) : band(high, std::numeric_limits<double>::infinity()), rule, again);
}

}  // namespace robomill::stability
