#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// Shares in [0, 1) of ranges: a row a sample, a column a key.
using Shares = std::vector<std::vector<double>>;

/// Latin hypercube: of each key one sample at random in each of `count` equal parts [McKay1979].
[[nodiscard]] Shares latin_hypercube(std::size_t count, std::size_t keys, std::uint64_t seed);

/// The first points of the Sobol' sequence, its zero among them, each key shifted by a share of its own, around the end
/// [JoeKuo2008]. @param keys  at most 3667
[[nodiscard]] Shares sobol_sequence(std::size_t count, std::size_t keys, std::uint64_t seed);

/// Samples for Sobol' indices [Saltelli2010]: of each of `samples` rows a and b of the sequence in twice as many keys
/// the points a, b, and a with the value of b in one key, for each key in turn: keys + 2 rows a sample.
[[nodiscard]] Shares saltelli_samples(std::size_t samples, std::size_t keys, std::uint64_t seed);

}  // namespace robomill::jobs
