#include "robomill/stability/time_steps/node_steps.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "robomill/stability/time_steps/lane_math.hpp"

namespace robomill::stability::detail {

NodeSteps::NodeSteps(const TipDynamics& tip, int steps)
    : tip_(tip),
      steps_(steps),
      modal_(2 * static_cast<std::size_t>(tip.pole.size())),
      compliant_(!tip.compliance.isZero(0.0)),
      displacement_(2 * modal_),
      state_(modal_),
      position_(2 * static_cast<std::size_t>(steps + 1)) {
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const std::size_t column = 2 * static_cast<std::size_t>(k);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const std::size_t row = static_cast<std::size_t>(axis) * modal_;
      displacement_[row + column] = 2.0 * tip.right(axis, k).real();
      displacement_[row + column + 1] = -2.0 * tip.right(axis, k).imag();
    }
  }
}

void NodeSteps::displacement(const Lanes* z, Lanes* out) const {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Lanes sum = {};
    const double* row = displacement_.data() + axis * modal_;
    for (std::size_t c = 0; c < modal_; ++c) add_product(sum, row[c], z[c]);
    out[axis] = sum;
  }
}

std::size_t NodeSteps::record_of(int node) const {
  return static_cast<std::size_t>(record_of_node_[static_cast<std::size_t>(node % steps_)]);
}

void NodeSteps::prepare(std::span<const NodePoint> points) {
  wanted_pattern_.assign(static_cast<std::size_t>(steps_), 0);
  for (const NodePoint& point : points) {
    for (std::size_t i = 0; i < wanted_pattern_.size(); ++i) {
      if (point.halves->cuts[2 * i] || point.halves->cuts[2 * i + 1]) wanted_pattern_[i] = 1;
    }
  }
  if (pattern_ != wanted_pattern_) {
    pattern_ = wanted_pattern_;
    lay_out();
  }
  std::array<NodePoint, lane_count> all;
  for (std::size_t lane = 0; lane < lane_count; ++lane) all[lane] = points[std::min(lane, points.size() - 1)];
  fill_contacts(all);
  fill_coasts(all);
  if (compliant_) fill_compliance();
  build(all);
}

/// Orders the period for pattern_: which steps cut, and which borders are remembered.
void NodeSteps::lay_out() {
  segments_.clear();
  cut_numbers_.clear();
  coast_lengths_.clear();
  record_of_node_.assign(pattern_.size(), -1);
  for (int i = 0; i < steps_; ++i) {
    if (pattern_[static_cast<std::size_t>(i)]) {
      segments_.push_back({.number = i, .index = cut_numbers_.size()});
      cut_numbers_.push_back(i);
      record_of_node_[static_cast<std::size_t>(i)] = record_of_node_[static_cast<std::size_t>((i + 1) % steps_)] = 0;
    } else if (!segments_.empty() && segments_.back().coast > 0) {
      ++segments_.back().coast;
    } else {
      segments_.push_back({.number = i, .coast = 1});
    }
  }
  for (Segment& segment : segments_) {
    if (segment.coast == 0) continue;
    segment.index = coast_lengths_.size();
    coast_lengths_.push_back(segment.coast);
  }
  int count = 0;
  for (int& record : record_of_node_) {
    if (record == 0) record = count++;
  }
  records_ = static_cast<std::size_t>(count);
  contacts_.resize(cut_numbers_.size());
  coasts_.resize(coast_lengths_.size() * modal_);
  compliance_.resize(4 * records_);
}

void NodeSteps::fill_contacts(std::span<const NodePoint> points) {
  const auto effective = [&](const Eigen::Matrix2d& k) -> Eigen::Matrix2d {
    if (!compliant_) return k;
    return (Eigen::Matrix2d::Identity() - k * tip_.compliance).inverse() * k;
  };
  for (std::size_t cut = 0; cut < contacts_.size(); ++cut) {
    Contact& contact = contacts_[cut];
    const std::size_t at = 2 * static_cast<std::size_t>(cut_numbers_[cut]);
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      contact.left[lane] = effective(points[lane].halves->stiffness[at]);
      contact.right[lane] = effective(points[lane].halves->stiffness[at + 1]);
      set(contact.mean, lane, 0.5 * (contact.left[lane] + contact.right[lane]));
    }
  }
}

void NodeSteps::fill_coasts(std::span<const NodePoint> points) {
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    for (std::size_t c = 0; c < coast_lengths_.size(); ++c) {
      const double duration_s = coast_lengths_[c] * points[lane].step_s;
      for (std::size_t k = 0; k < modal_ / 2; ++k) {
        const std::complex<double> factor = std::exp(tip_.pole(static_cast<Eigen::Index>(k)) * duration_s);
        coasts_[c * modal_ + 2 * k].v[lane] = factor.real();
        coasts_[c * modal_ + 2 * k + 1].v[lane] = factor.imag();
      }
    }
  }
}

void NodeSteps::fill_compliance() {
  std::ranges::fill(compliance_, Lanes{});
  const auto add = [&](int node, const std::array<Eigen::Matrix2d, lane_count>& stiffness) {
    Lanes* to = compliance_.data() + 4 * record_of(node);
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      const Eigen::Matrix2d half = 0.5 * tip_.compliance * stiffness[lane];
      for (std::size_t i = 0; i < 4; ++i) {
        to[i].v[lane] += half(static_cast<Eigen::Index>(i / 2), static_cast<Eigen::Index>(i % 2));
      }
    }
  };
  for (std::size_t cut = 0; cut < contacts_.size(); ++cut) {
    add(cut_numbers_[cut], contacts_[cut].left);
    add(cut_numbers_[cut] + 1, contacts_[cut].right);
  }
}

/// The displacement at a border, for the next period.
void NodeSteps::record(int node, const Lanes* in, Lanes* out) {
  Lanes* position = position_.data() + 2 * static_cast<std::size_t>(node);
  displacement(state_.data(), position);
  if (node == steps_) return;
  const std::size_t at = modal_ + 2 * record_of(node);
  out[at] = position[0];
  out[at + 1] = position[1];
  if (!compliant_) return;
  const Lanes slip[2] = {difference(position[0], in[at]), difference(position[1], in[at + 1])};
  add_product(compliance_.data() + 4 * record_of(node), slip, out + at);
}

void NodeSteps::apply(const Lanes* in, Lanes* out) {
  std::copy(in, in + modal_, state_.begin());
  for (const Segment& segment : segments_) {
    if (record_of_node_[static_cast<std::size_t>(segment.number)] >= 0) record(segment.number, in, out);
    if (segment.coast > 0) {
      turn(coasts_.data() + segment.index * modal_, modal_, state_.data());
      continue;
    }
    const int next = segment.number + 1;
    // The border that ends the period one delay ago is the one that starts this.
    const Lanes* after = (next < steps_ ? in : out) + modal_ + 2 * record_of(next);
    cut_step(segment.index, position_.data() + 2 * static_cast<std::size_t>(segment.number),
             in + modal_ + 2 * record_of(segment.number), after, state_.data());
  }
  if (!pattern_.empty() && pattern_.back()) record(steps_, in, out);
  find_forces(in, out);
  std::ranges::copy(state_, out);
}

void NodeSteps::find_forces(const Lanes* in, const Lanes* out) {
  for (std::size_t cut = 0; cut < contacts_.size(); ++cut) {
    const int number = cut_numbers_[cut];
    const Lanes* start = position_.data() + 2 * static_cast<std::size_t>(number);
    const Lanes* before = in + modal_ + 2 * record_of(number);
    const Lanes* after = (number + 1 < steps_ ? in : out) + modal_ + 2 * record_of(number + 1);
    Lanes slip[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      for (std::size_t l = 0; l < lane_count; ++l) {
        slip[axis].v[l] = 0.5 * (start[axis].v[l] + start[axis + 2].v[l] - before[axis].v[l] - after[axis].v[l]);
      }
    }
    Contact& contact = contacts_[cut];
    contact.force[0] = contact.force[1] = Lanes{};
    add_product(contact.mean, slip, contact.force);
  }
}

}  // namespace robomill::stability::detail
