#include "robomill/path/emitter.hpp"

namespace robomill::path {

Emitter::Emitter(const robot::Kinematics& kinematics, double period_s, const robot::Position6& start)
    : kinematics_(kinematics), period_s_(period_s), near_(start) {}

bool Emitter::emit(double u_m, std::vector<Sample>& out) {
  while (path_at_ + 1 < path_.size() && path_[path_at_ + 1].begin_m <= u_m) ++path_at_;
  const Polynomial& here = path_[path_at_];
  const robot::ToolPose pose = here.pose(u_m - here.begin_m);
  robot::Position6 joints;
  reach_ = kinematics_.follow(pose, near_, joints);
  if (reach_.status != robot::Reach::Status::found) return false;
  near_ = joints;
  out.push_back({.time_s = static_cast<double>(count_) * period_s_,
                 .joints = joints,
                 .tip_m = pose.tip_m,
                 .axis = pose.axis,
                 .block = here.block,
                 .path_m = u_m});
  ++count_;
  return true;
}

bool Emitter::add(std::span<const Polynomial> path, std::span<const Segment> motion, std::vector<Sample>& out,
                  const std::function<void()>& take, std::size_t chunk) {
  path_.erase(path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(path_at_));
  path_at_ = 0;
  path_.insert(path_.end(), path.begin(), path.end());
  for (const Segment& segment : motion) {
    const double total_s = path::duration_s(segment);
    for (; next_s_ < total_s; next_s_ += period_s_) {
      if (!emit(segment.begin_m + way_m(segment, next_s_, total_s), out)) return false;
      if (take && out.size() >= chunk) take();
    }
    next_s_ -= total_s;
    begun_s_ += total_s;
    end_m_ = segment.begin_m + segment.length_m;
  }
  return true;
}

bool Emitter::finish(std::vector<Sample>& out) {
  return path_.empty() || emit(end_m_, out);
}

}  // namespace robomill::path
