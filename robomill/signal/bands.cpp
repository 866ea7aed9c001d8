#include "robomill/signal/bands.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"

namespace robomill::signal {
namespace {

// std::fmin and std::fmax leave NaN out.
void widen(double& low, double& high, double other_low, double other_high) {
  low = std::fmin(low, other_low);
  high = std::fmax(high, other_high);
}

}  // namespace

Bands::Bands(std::size_t curves, std::size_t most_runs)
    : curves_(curves), most_(most_runs + most_runs % 2), none_(curves, NAN) {
  if (curves == 0) throw InvalidInput("curves", 0.0, "", "must be > 0");
  if (most_runs == 0) throw InvalidInput("most_runs", 0.0, "", "must be > 0");
  low_.reserve(most_ * curves);
  high_.reserve(most_ * curves);
}

void Bands::clear() {
  low_.clear();
  high_.clear();
  length_ = 1;
  in_last_ = 0;
}

void Bands::halve() {
  const std::size_t runs = low_.size() / curves_ / 2;
  for (std::size_t run = 0; run < runs; ++run) {
    for (std::size_t c = 0; c < curves_; ++c) {
      const std::size_t first = 2 * run * curves_ + c;
      const std::size_t to = run * curves_ + c;
      low_[to] = low_[first];
      high_[to] = high_[first];
      widen(low_[to], high_[to], low_[first + curves_], high_[first + curves_]);
    }
  }
  low_.resize(runs * curves_);
  high_.resize(runs * curves_);
  length_ *= 2;
  in_last_ = length_;
}

void Bands::begin(std::span<const double> values) {
  if (low_.size() == most_ * curves_) halve();
  low_.insert(low_.end(), values.begin(), values.end());
  high_.insert(high_.end(), values.begin(), values.end());
}

void Bands::add(std::span<const double> values) {
  if (in_last_ == length_ || low_.empty()) {
    begin(values);
    in_last_ = 1;
    return;
  }
  ++in_last_;
  const std::size_t last = low_.size() - curves_;
  for (std::size_t c = 0; c < curves_; ++c) widen(low_[last + c], high_[last + c], values[c], values[c]);
}

void Bands::skip(std::uint64_t samples) {
  while (samples > 0) {
    if (in_last_ == length_ || low_.empty()) {
      begin(none_);
      in_last_ = 0;
    }
    const auto taken = static_cast<std::size_t>(std::min<std::uint64_t>(samples, length_ - in_last_));
    in_last_ += taken;
    samples -= taken;
  }
}

Band Bands::band(std::size_t curve) const {
  const auto runs = static_cast<Eigen::Index>(low_.size() / curves_);
  Band out{.low = Eigen::VectorXd(runs), .high = Eigen::VectorXd(runs)};
  for (Eigen::Index run = 0; run < runs; ++run) {
    const std::size_t at = static_cast<std::size_t>(run) * curves_ + curve;
    out.low[run] = low_[at];
    out.high[run] = high_[at];
  }
  return out;
}

}  // namespace robomill::signal
