#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "robomill/path/blend.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/path/speed/segment.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// Runs along planned motion at the sample period: u(t) in closed form, the pose from the path's polynomials, the
/// joints by inverse kinematics. The first sample is at time 0, at rest; the last lies at the end or after it, at rest.
class Emitter {
 public:
  Emitter(const robot::Kinematics& kinematics, double period_s, const robot::Position6& start);
  /// Takes motion over; samples that it reaches go to `out`, whose taker is called whenever it holds `chunk` of them.
  /// @return false where a pose cannot be reached; reach() says why
  bool add(std::span<const Polynomial> path, std::span<const Segment> motion, std::vector<Sample>& out,
           const std::function<void()>& take = {}, std::size_t chunk = 4096);
  /// The last sample.
  bool finish(std::vector<Sample>& out);
  [[nodiscard]] const robot::Reach& reach() const { return reach_; }
  [[nodiscard]] const Polynomial& at() const { return path_[path_at_]; }
  [[nodiscard]] double duration_s() const { return begun_s_; }

 private:
  bool emit(double u_m, std::vector<Sample>& out);

  const robot::Kinematics& kinematics_;
  double period_s_;
  robot::Position6 near_;
  robot::Reach reach_ = {};
  std::vector<Polynomial> path_;
  std::size_t path_at_ = 0, count_ = 0;
  double begun_s_ = 0.0;  ///< where the present segment began
  double next_s_ = 0.0;   ///< of the next sample, from there
  double end_m_ = 0.0;
};

}  // namespace robomill::path
