#include "robomill/jobs/sweep/samples.hpp"

#include <boost/random/sobol.hpp>
#include <iterator>
#include <numeric>
#include <utility>

#include "robomill/base/random.hpp"

namespace robomill::jobs {

Shares latin_hypercube(std::size_t count, std::size_t keys, std::uint64_t seed) {
  Shares rows(count, std::vector<double>(keys));
  for (std::size_t k = 0; k < keys; ++k) {
    Random random(seed, k);
    std::vector<std::size_t> parts(count);
    std::iota(parts.begin(), parts.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i) std::swap(parts[i - 1], parts[random.index(i)]);
    for (std::size_t i = 0; i < count; ++i) {
      rows[i][k] = (static_cast<double>(parts[i]) + random.uniform()) / static_cast<double>(count);
    }
  }
  return rows;
}

Shares sobol_sequence(std::size_t count, std::size_t keys, std::uint64_t seed) {
  boost::random::sobol engine(keys);  // its first point is the one after zero
  std::vector<double> shift(keys);
  for (std::size_t k = 0; k < keys; ++k) shift[k] = Random(seed, k).uniform();
  Shares rows(count, shift);
  constexpr double one = 18446744073709551616.0;  // 2^64
  for (std::size_t i = 1; i < count; ++i) {
    for (double& share : rows[i]) {
      share += static_cast<double>(engine() >> 11U << 11U) / one;
      if (share >= 1.0) share -= 1.0;
    }
  }
  return rows;
}

Shares saltelli_samples(std::size_t samples, std::size_t keys, std::uint64_t seed) {
  Shares rows;
  rows.reserve(samples * (keys + 2));
  for (const std::vector<double>& both : sobol_sequence(samples, 2 * keys, seed)) {
    const auto middle = both.begin() + static_cast<std::ptrdiff_t>(keys);
    const std::vector<double> a(both.begin(), middle), b(middle, both.end());
    rows.push_back(a);
    rows.push_back(b);
    for (std::size_t k = 0; k < keys; ++k) {
      rows.push_back(a);
      rows.back()[k] = b[k];
    }
  }
  return rows;
}

}  // namespace robomill::jobs
