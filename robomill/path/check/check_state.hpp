#pragma once
// What a checker knows while samples pass by. check.cpp keeps the differences, check_path.cpp the errors.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "robomill/path/check.hpp"
#include "robomill/path/check/check_account.hpp"
#include "robomill/path/check/check_window.hpp"

namespace robomill::path {

using CheckRow = Eigen::Matrix<double, 12, 1>;  // joints, tip, axis

struct Checker::State {
  static constexpr std::size_t near_blocks = 8, far_blocks = 64;
  State(program::Source& source, const robot::Kinematics& machine, const SmoothingOptions& smoothing,
        const CheckOptions& check);

  void add(const Sample& sample);
  CheckResult finish();

 private:
  static constexpr double never = std::numeric_limits<double>::infinity();
  // Standing still: a drift by less than the tolerance in this time.
  static constexpr double still_time_s = 1.0;
  struct JointWatch {
    Watch velocity, acceleration, jerk;
  };
  void watch_all(const CheckOptions& check);
  void begin(const Sample& sample);
  void correct(Sample& sample, double due_s) const;
  bool read();
  void advance(std::size_t block);
  void differences(const CheckRow& step);
  void positions(const Sample& sample);
  void feed(const Eigen::Vector3d& tip_step, const Eigen::Vector3d& axis_step);
  double tip_feed_of(std::size_t block) const;
  double axis_feed_of(std::size_t block) const;
  void errors(const Sample& sample);
  template <class Distance>
  double nearest(double enough, double tolerance, Distance&& distance) const;
  void corners(const Eigen::Vector3d& tip_from, const Eigen::Vector3d& tip_to, const Eigen::Vector3d& axis_from,
               const Eigen::Vector3d& axis_to);
  static void pass(Pass& pass, const Eigen::Vector3d& corner, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                   double travelled, double tolerance, double time_s);
  void stand(const Eigen::Vector3d& tip_step, const Eigen::Vector3d& axis_step);
  bool finished(std::size_t block);
  void close();
  void close_old();
  void end_at_rest();

  BlockWindow window_;
  const robot::Kinematics& machine_;
  SmoothingOptions options_;
  CheckResult result_;
  ViolationBook book_;
  int joints_;
  std::array<JointWatch, 6> joint_watch_ = {};
  Watch tip_velocity_, tip_acceleration_, tip_jerk_, axis_velocity_, axis_acceleration_, axis_jerk_, feed_, tip_error_,
      axis_error_, synchrony_, pose_error_, dwell_;

  bool ended_ = false;                                             // no further block in the source
  std::size_t reached_ = std::numeric_limits<std::size_t>::max();  // the block that was last looked ahead from
  CheckRow row_ = CheckRow::Zero(), step_ = CheckRow::Zero(), step_before_ = CheckRow::Zero();
  double time_s_ = 0.0, first_time_s_ = 0.0, last_time_s_ = 0.0;  // of this sample, the first and the last one
  std::size_t block_ = 0, block_before_ = 0;                      // that these samples name
  std::size_t open_ = 0;                                          // the first block whose end is not accounted for
  double tip_travelled_ = 0.0, axis_travelled_ = 0.0;
  double still_s_ = 0.0;        // how long the tool has been standing
  std::size_t still_from_ = 0;  // the block in which it began to
};

}  // namespace robomill::path
