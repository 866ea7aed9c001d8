#pragma once
// Of the reader of LVM.
#include <cstddef>
#include <limits>
#include <string>

namespace robomill::io {

/// How the times of a column of x run, without keeping them.
class LvmAxis {
 public:
  /// @param line  where it stands
  void add(double time_s, std::size_t line);
  /// The next time begins a segment.
  void begin_segment() { in_segment_ = false; }

  [[nodiscard]] bool is_used() const { return steps_ > 0; }
  /// Mean of all steps [s].
  [[nodiscard]] double step_s() const { return span_s_ / static_cast<double>(steps_); }
  /// Of all segments together [s].
  [[nodiscard]] double span_s() const { return span_s_; }
  /// Why it is no time of a record; empty: it runs evenly, to half a step.
  [[nodiscard]] std::string fault() const;
  /// Whether it never falls and stands still at times, as where it has too few digits for its steps.
  [[nodiscard]] bool is_rounded() const { return steps_ > 0 && shortest_.s == 0.0 && span_s_ > 0.0; }

 private:
  struct Step {
    double s = 0.0, from_s = 0.0;
    std::size_t line = 0;  ///< of its end
  };
  bool in_segment_ = false;
  double last_s_ = 0.0, span_s_ = 0.0;
  std::size_t steps_ = 0;
  Step shortest_{.s = std::numeric_limits<double>::infinity()};
  Step longest_{.s = -std::numeric_limits<double>::infinity()};
};

}  // namespace robomill::io
