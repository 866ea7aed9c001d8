#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "robomill/path/check.hpp"
#include "robomill/path/emitter.hpp"

namespace robomill::path {

/// What the samples of planned motion will break of feed, speed, acceleration and jerk, reported before the motion is
/// taken over, so that a row can be planned again while the rest of the program need not. Finite differences as the
/// Checker takes them; the Checker alone decides.
class Preview {
 public:
  Preview(const robot::Kinematics& kinematics, const SmoothingOptions& options);
  /// What is sent out.
  void pass(std::span<const Sample> samples);
  /// Adds the worst of each 0.2 mm and order along motion that follows.
  /// @param ahead   as it will send the motion out; its path reaches to the motion's end. Runs on along it
  /// @param joined  the motion begins where the samples ended; else the first samples have no differences
  void look(Emitter& ahead, std::span<const Segment> motion, bool joined, std::vector<Violation>& violations);

 private:
  static constexpr std::size_t channels = 8;  // joints, tip, axis
  using Row = Eigen::Matrix<double, 12, 1>;   // joints, tip, axis
  /// The last sample, and the steps that led to it.
  struct Trail {
    robot::Position6 joints = robot::Position6::Zero();
    Eigen::Vector3d tip_m = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitZ();
    Row step = Row::Zero(), step_before = Row::Zero();
    double tip_feed_m = 0.0;  ///< what the feed lets the tip move in a period
    bool begun = false;
  };
  [[nodiscard]] static Row step_to(const Trail& trail, const Sample& sample);
  static void follow(Trail& trail, const Sample& sample, const Row& step);
  void differences(const Trail& trail, const Row& step, double path_m, std::vector<Violation>& violations);
  void note(double value, double most, int order, double path_m, std::vector<Violation>& violations);

  double period_s_ = 0.0;
  std::array<std::array<double, channels>, 3> most_ = {};  ///< of differences, by order
  Trail trail_ = {};
  std::vector<Sample> samples_;
  std::array<Violation, 3> last_ = {};  ///< of each order, while its place is passed
};

}  // namespace robomill::path
