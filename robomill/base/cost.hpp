#pragma once
#include <initializer_list>
#include <limits>
#include <string>

#include "robomill/base/export.hpp"

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// A number of the input that a cost grows with.
struct CostDriver {
  std::string field = {};  ///< as InvalidInput names it, "grid"
  double value = 0.0;
  std::string unit = {};
  double times_usual = 1.0;  ///< what it multiplies the cost by, over a usual value of it
};

/// The one that makes the cost what it is; the first of equal ones. One without a field is nobody's to change.
[[nodiscard]] ROBOMILL_API CostDriver dominant_of(std::initializer_list<CostDriver> drivers);

/// What a computation is about to take, known before it runs; within a factor of about three.
struct Cost {
  double operations = 0.0;      ///< in all, on whatever cores; one core does some 1e9 a second
  double bytes = 0.0;           ///< held at a time
  double bytes_a_thread = 0.0;  ///< and by each thread that works
  CostDriver dominant = {};
  /// By as few threads as can be.
  [[nodiscard]] double least_bytes() const { return bytes + bytes_a_thread; }
};

/// What may be taken.
struct CostLimit {
  double operations = 6e11;  ///< ten minutes of one core
  double bytes = 2e9;
  /// How whoever sets the limit lets it be exceeded, which ends a rejection: "--allow-large takes it". A literal.
  const char* way_out = "";
};
/// Of those who know what they ask for.
inline constexpr CostLimit no_cost_limit = {.operations = std::numeric_limits<double>::infinity(),
                                            .bytes = std::numeric_limits<double>::infinity()};

/// What require_affordable compares with from now on, in the whole process.
ROBOMILL_API void set_cost_limit(const CostLimit& limit);
[[nodiscard]] ROBOMILL_API CostLimit cost_limit();

/// What of it is above the limit: "about 25 min of one core, more than 10 min"; empty where nothing is.
[[nodiscard]] ROBOMILL_API std::string above_limit(const Cost& cost);

/// Before the work.
/// @return the threads that it may use: fewer than all where those would hold too much, for a ThreadLimit
/// @throws InvalidInput naming the dominant field where the cost is above the limit even so, with estimate and limit
ROBOMILL_API int require_affordable(const Cost& cost);

}  // namespace robomill
