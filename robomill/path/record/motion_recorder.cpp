#include "robomill/path/record/motion_recorder.hpp"

#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::path {
namespace {

constexpr std::size_t shown_runs = 800;
constexpr std::size_t most_points = 1000;
constexpr std::size_t most_steps = 1000;  // of the way round one corner
constexpr std::size_t of_joint = 4;       // curves: velocity, acceleration, jerk, tracking error

}  // namespace

MotionRecorder::MotionRecorder(int joints, const std::array<bool, 6>& prismatic, double sample_period_s,
                               const std::vector<ProgramCorner>& corners)
    : joints_(joints),
      prismatic_(prismatic),
      period_s_(sample_period_s),
      corners_(corners),
      bands_(2 + of_joint * static_cast<std::size_t>(joints), shown_runs),
      values_(2 + of_joint * static_cast<std::size_t>(joints)),
      path_(most_points),
      passes_(corners.size()) {
  if (joints < 1 || joints > 6) throw InvalidInput("joints", joints, "", "must be 1 to 6");
  require_positive("sample_period_s", sample_period_s, "s");
}

void MotionRecorder::restart(Tracking tracking) {
  tracking_ = std::move(tracking);
  bands_.clear();
  path_ = Decimated<Point>(most_points);
  any_ = false;
  for (auto& pass : passes_) pass.clear();
}

void MotionRecorder::add(std::span<const Sample> samples) {
  for (const Sample& sample : samples) add(sample);
}

void MotionRecorder::add(const Sample& sample) {
  // Before its first sample the machine stood there.
  if (!std::exchange(any_, true)) before_.fill(sample);
  const auto& [one, two, three] = before_;
  const double h = period_s_;
  const robot::Position6 velocity = (sample.joints - one.joints) / h;
  const robot::Position6 acceleration = (sample.joints - 2.0 * one.joints + two.joints) / (h * h);
  const robot::Position6 jerk = (sample.joints - 3.0 * one.joints + 3.0 * two.joints - three.joints) / (h * h * h);
  robot::Position6 behind = robot::Position6::Zero();
  if (tracking_) behind = tracking_(sample);
  values_[0] = (sample.tip_m - one.tip_m).norm() / h;
  values_[1] = program::angle_between(one.axis, sample.axis) / h;
  for (int joint = 0; joint < joints_; ++joint) {
    double* const at = values_.data() + 2 + of_joint * static_cast<std::size_t>(joint);
    at[0] = velocity[joint];
    at[1] = acceleration[joint];
    at[2] = jerk[joint];
    at[3] = behind[joint];
  }
  bands_.add(values_);
  path_.add({.tip_m = sample.tip_m, .speed_m_per_s = values_[0]});
  pass_corners(sample);
  before_ = {sample, one, two};
}

void MotionRecorder::pass_corners(const Sample& sample) {
  constexpr std::size_t near_blocks = 8;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const ProgramCorner& corner = corners_[i];
    if (sample.block + near_blocks < corner.block || sample.block > corner.block + near_blocks) continue;
    const Eigen::Vector3d from = sample.tip_m - corner.corner_m;
    if (from.norm() > 2.0 * corner.radius_m || passes_[i].size() >= most_steps) continue;
    const Eigen::Vector2d at = corner.plane * from;
    const bool moved = passes_[i].empty() || (at - passes_[i].back()).norm() > 2e-3 * corner.radius_m;
    if (moved) passes_[i].push_back(at);
  }
}

Motion MotionRecorder::motion() const {
  Motion out;
  out.run_s = static_cast<double>(bands_.length()) * period_s_;
  out.tip_speed_m_per_s = bands_.band(0);
  out.axis_speed_rad_per_s = bands_.band(1);
  for (int joint = 0; joint < joints_; ++joint) {
    const std::size_t at = 2 + of_joint * static_cast<std::size_t>(joint);
    JointMotion motion{.prismatic = prismatic_[static_cast<std::size_t>(joint)],
                       .velocity = bands_.band(at),
                       .acceleration = bands_.band(at + 1),
                       .jerk = bands_.band(at + 2)};
    if (tracking_) motion.tracking_error = bands_.band(at + 3);
    out.joints.push_back(std::move(motion));
  }
  const std::vector<Point>& points = path_.kept();
  const auto n = static_cast<Eigen::Index>(points.size());
  out.tip_m.resize(3, n);
  out.tip_speed_at_m_per_s.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    out.tip_m.col(i) = points[static_cast<std::size_t>(i)].tip_m;
    out.tip_speed_at_m_per_s[i] = points[static_cast<std::size_t>(i)].speed_m_per_s;
  }
  for (const std::vector<Eigen::Vector2d>& pass : passes_) {
    Eigen::Matrix2Xd& way = out.corner_paths_m.emplace_back(2, static_cast<Eigen::Index>(pass.size()));
    for (std::size_t k = 0; k < pass.size(); ++k) way.col(static_cast<Eigen::Index>(k)) = pass[k];
  }
  return out;
}

}  // namespace robomill::path
