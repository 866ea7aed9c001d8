#include "robomill/io/records/labview/lvm_axis.hpp"

#include <fmt/format.h>

namespace robomill::io {

void LvmAxis::add(double time_s, std::size_t line) {
  if (in_segment_) {
    const Step step{.s = time_s - last_s_, .from_s = last_s_, .line = line};
    if (step.s < shortest_.s) shortest_ = step;
    if (step.s > longest_.s) longest_ = step;
    span_s_ += step.s;
    ++steps_;
  }
  in_segment_ = true;
  last_s_ = time_s;
}

std::string LvmAxis::fault() const {
  if (steps_ == 0) return {};
  const double mean_s = step_s();
  if (!(mean_s > 0.0)) return "the time does not rise";
  const double most_off_s = 0.5 * mean_s;
  if (longest_.s - mean_s <= most_off_s && mean_s - shortest_.s <= most_off_s) return {};
  const Step& off = longest_.s - mean_s > most_off_s ? longest_ : shortest_;
  return fmt::format("the time does not run evenly: from {:.9g} s to {:.9g} s where {:.6g} s are a step, line {}",
                     off.from_s, off.from_s + off.s, mean_s, off.line);
}

}  // namespace robomill::io
