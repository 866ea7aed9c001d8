#include "robomill/jobs/sweep/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"

namespace robomill::jobs {
namespace {

constexpr std::size_t least_samples = 8, resamples = 1000;
/// Of the greatest value: what varies less is rounding.
constexpr double least_spread = 1e-12;

/// Whole samples, one after the other: f(a), f(b), f(a b_1), ….
class SampledValues {
 public:
  SampledValues(std::span<const double> values, std::size_t inputs) : inputs_(inputs) {
    for (std::size_t i = 0; i < values.size(); i += width()) {
      const std::span<const double> sample = values.subspan(i, width());
      if (!std::ranges::all_of(sample, [](double value) { return std::isfinite(value); })) continue;
      values_.insert(values_.end(), sample.begin(), sample.end());
    }
  }
  [[nodiscard]] std::size_t width() const { return inputs_ + 2; }
  [[nodiscard]] std::size_t size() const { return values_.size() / width(); }
  [[nodiscard]] bool is_constant() const {
    const auto [least, greatest] = std::ranges::minmax(values_);
    return greatest - least <= least_spread * std::max(std::abs(least), std::abs(greatest));
  }

  struct Moments {
    double mean = 0.0, variance = 0.0;
    std::vector<double> first = {}, total = {};  ///< an input each
  };
  /// Of some of the samples, in any order, each as often as it is named.
  [[nodiscard]] Moments moments(const std::vector<std::size_t>& chosen) const {
    Moments out{.first = std::vector<double>(inputs_, 0.0), .total = std::vector<double>(inputs_, 0.0)};
    const auto n = static_cast<double>(chosen.size());
    for (const std::size_t i : chosen) out.mean += at(i, 0) + at(i, 1);
    out.mean /= 2.0 * n;
    for (const std::size_t i : chosen) {
      const double a = at(i, 0), b = at(i, 1) - out.mean;
      out.variance += (a - out.mean) * (a - out.mean) + b * b;
      for (std::size_t k = 0; k < inputs_; ++k) {
        const double change = at(i, k + 2) - a;
        out.first[k] += b * change;
        out.total[k] += change * change;
      }
    }
    out.variance /= 2.0 * n;
    for (double& first : out.first) first /= n * out.variance;
    for (double& total : out.total) total /= 2.0 * n * out.variance;
    return out;
  }

 private:
  [[nodiscard]] double at(std::size_t sample, std::size_t place) const { return values_[sample * width() + place]; }
  std::size_t inputs_;
  std::vector<double> values_ = {};
};

/// Between the 2.5 and 97.5 % quantiles; what is no number, of a resample without variance, counts for nothing.
Estimate with_interval(double value, std::vector<double> resampled) {
  std::erase_if(resampled, [](double one) { return !std::isfinite(one); });
  if (resampled.empty()) return {.value = value};
  std::ranges::sort(resampled);
  const auto last = static_cast<double>(resampled.size() - 1);
  return {.value = value,
          .low = resampled[static_cast<std::size_t>(std::floor(0.025 * last))],
          .high = resampled[static_cast<std::size_t>(std::ceil(0.975 * last))]};
}

}  // namespace

SobolIndices sobol_indices(std::span<const double> values, std::size_t inputs, std::uint64_t seed) {
  if (inputs == 0 || values.size() % (inputs + 2) != 0) {
    throw InvalidInput("values", fmt::format("are {} for {} inputs", values.size(), inputs),
                       "Each sample has one more than inputs, and one");
  }
  const SampledValues sampled(values, inputs);
  SobolIndices out{.inputs = std::vector<SobolIndex>(inputs),
                   .samples = sampled.size(),
                   .left_out = values.size() / (inputs + 2) - sampled.size()};
  if (out.samples < least_samples) return out;
  std::vector<std::size_t> chosen(out.samples);
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  const SampledValues::Moments found = sampled.moments(chosen);
  out.mean = found.mean;
  out.variance = found.variance;
  out.status = sampled.is_constant() ? SobolStatus::constant : SobolStatus::found;
  if (out.status == SobolStatus::constant) return out;
  std::vector<std::vector<double>> first(inputs), total(inputs);
  for (std::size_t r = 0; r < resamples; ++r) {
    Random random(seed, r);
    for (std::size_t& one : chosen) one = random.index(out.samples);
    const SampledValues::Moments again = sampled.moments(chosen);
    for (std::size_t k = 0; k < inputs; ++k) {
      first[k].push_back(again.first[k]);
      total[k].push_back(again.total[k]);
    }
  }
  for (std::size_t k = 0; k < inputs; ++k) {
    out.inputs[k] = {.first = with_interval(found.first[k], std::move(first[k])),
                     .total = with_interval(found.total[k], std::move(total[k]))};
  }
  return out;
}

}  // namespace robomill::jobs
