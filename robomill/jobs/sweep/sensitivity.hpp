#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "robomill/base/names.hpp"

// Method: robomill/jobs/README.md, "Sensitivity (`sweep/sensitivity.hpp`)"

namespace robomill::jobs {

/// An estimate with its 95 % interval.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
};

/// What one input does to a value.
struct SobolIndex {
  Estimate first = {};  ///< share of the variance that would go if this input were known
  Estimate total = {};  ///< share that would remain if all other inputs were known: with all its interactions
};

enum class SobolStatus {
  found,
  constant,  ///< the value does not vary: it has no indices
  too_few    ///< fewer than 8 samples remain
};
inline constexpr Name<SobolStatus> sobol_status_names[] = {
    {"found", SobolStatus::found}, {"constant", SobolStatus::constant}, {"too_few", SobolStatus::too_few}};

struct SobolIndices {
  SobolStatus status = SobolStatus::too_few;
  std::vector<SobolIndex> inputs = {};  ///< in their order
  std::size_t samples = 0;              ///< that count
  std::size_t left_out = 0;             ///< samples with a point whose value is infinite or NaN, as a whole
  double mean = std::numeric_limits<double>::quiet_NaN(), variance = std::numeric_limits<double>::quiet_NaN();
};

/// Sobol' indices [Sobol2001] of a function of independent, uniform inputs from its values at saltelli_samples:
///
///     S_i  = mean((f(b) - f0) (f(a b_i) - f(a))) / V   [Saltelli2010] table 2 (b), centred
///     S_Ti = mean((f(a) - f(a b_i))^2) / (2 V)         [Jansen1999], [Saltelli2010] table 2 (f)
///
/// with mean f0 and variance V of all f(a) and f(b). The intervals lie between the 2.5 and 97.5 % quantiles of 1000
/// resamples of whole samples; since the sequence is more even than random samples are, they are rather wide. Where
/// samples are left out the indices are those of the rest of the inputs' ranges.
/// @param values  keys + 2 a sample, in the order of saltelli_samples
/// @throws InvalidInput if inputs is 0 or the number of values is no multiple of inputs + 2
[[nodiscard]] SobolIndices sobol_indices(std::span<const double> values, std::size_t inputs, std::uint64_t seed);

}  // namespace robomill::jobs
