#include "robomill/program/files/drilling.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::program {
namespace {

using Eigen::Vector3d;

/// The moves of one hole, those that move nothing left out.
class HoleSteps {
 public:
  HoleSteps(const DrilledHole& hole, const Pose& from, std::vector<MoveStep>& steps)
      : hole_(hole), tip_m_(from.tip_m), axis_(from.axis), steps_(steps) {}

  [[nodiscard]] Vector3d at(double height_m) const { return hole_.point_m + height_m * hole_.axis; }

  void add(MoveStep step) {
    if (step.kind == Block::Kind::dwell) {
      step.tip_m = tip_m_;
      if (step.duration_s == 0.0 && step.stop == OperatorStop::none) return;
    } else if (step.tip_m == tip_m_ && step.axis.value_or(axis_) == axis_) {
      return;
    }
    tip_m_ = step.tip_m;
    axis_ = step.axis.value_or(axis_);
    steps_.push_back(step);
  }

  void approach(Spindle turning) {
    if (axis_ != hole_.axis) {
      add({.tip_m = at(std::max(hole_.start_m, hole_.return_m)), .axis = hole_.axis, .spindle = turning});
    } else {
      const double height_m = (tip_m_ - hole_.point_m).dot(hole_.axis);
      const double over_m = std::max(height_m, hole_.start_m);
      add({.tip_m = tip_m_ - height_m * hole_.axis + over_m * hole_.axis, .spindle = turning});
      add({.tip_m = at(over_m), .spindle = turning});
    }
    add({.tip_m = at(hole_.start_m), .spindle = turning});
  }

  void peck(const Drilling& drilling) {
    const double count = drilling.count(hole_.start_m - hole_.bottom_m);
    double reached_m = hole_.start_m;
    for (double i = 1.0; i <= count; i += 1.0) {
      const double next_m = i < count ? hole_.start_m - drilling.depth_m(i) : hole_.bottom_m;
      if (i > 1.0) {
        if (drilling.pecks == Drilling::Pecks::out) add({.tip_m = at(hole_.start_m)});
        add({.tip_m = at(std::min(reached_m + Drilling::clearance_m, hole_.start_m))});
      }
      add({.kind = Block::Kind::feed, .tip_m = at(next_m)});
      reached_m = next_m;
    }
  }

 private:
  const DrilledHole& hole_;
  Vector3d tip_m_, axis_;
  std::vector<MoveStep>& steps_;
};

}  // namespace

double Drilling::depth_m(double i) const {
  double depth_m = 0.0;
  std::size_t listed = 0;
  for (; listed + 1 < pecks_m.size() && i > 0.0; ++listed, i -= 1.0) depth_m += pecks_m[listed];
  return depth_m + std::max(i, 0.0) * pecks_m.back();
}

double Drilling::count(double depth_m) const {
  constexpr double rounding = 1e-9;
  double counted = 0.0;
  std::size_t listed = 0;
  for (; listed + 1 < pecks_m.size(); ++listed, counted += 1.0) {
    if (depth_m <= pecks_m[listed] * (1.0 + rounding)) return counted + 1.0;
    depth_m -= pecks_m[listed];
  }
  return counted + std::max(std::ceil(depth_m / pecks_m.back() - rounding), 1.0);
}

void add_hole(const Drilling& drilling, const DrilledHole& hole, const Pose& from, Spindle turning,
              std::vector<MoveStep>& steps) {
  HoleSteps out(hole, from, steps);
  out.approach(turning);
  if (drilling.pecks == Drilling::Pecks::none) {
    out.add({.kind = Block::Kind::feed, .tip_m = out.at(hole.bottom_m), .spindle = turning});
  } else {
    out.peck(drilling);
  }
  out.add({.kind = Block::Kind::dwell, .duration_s = drilling.dwell_s, .spindle = turning});
  if (drilling.waits) {
    out.add({.kind = Block::Kind::dwell, .spindle = drilling.back, .stop = OperatorStop::always});
  }
  if (drilling.feeds_out) {
    out.add({.kind = Block::Kind::feed, .tip_m = out.at(hole.start_m), .spindle = drilling.back});
  }
  out.add({.tip_m = out.at(hole.return_m), .spindle = drilling.feeds_out ? turning : drilling.back});
}

}  // namespace robomill::program
