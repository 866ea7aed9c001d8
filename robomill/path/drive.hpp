#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "robomill/path/sample.hpp"

namespace robomill::path {

/// One joint's drive: a servo of second order, and behind it a load on an elastic joint where an inertia is given. With
/// r the commanded position, y the motor's and z the load's (both at the joint's output):
///     y'' + 2 ζ ω y' + ω² y = ω² r + f 2 ζ ω r'
///     J z'' + c (z' − y') + k (z − y) = 0
/// The load does not push the motor back: the servo is stiff against it.
struct Drive {
  double natural_frequency_hz = 0.0;   ///< ω/2π > 0; the bandwidth where ζ = 0.707; required
  double damping_ratio = 0.707;        ///< ζ > 0
  double velocity_feed_forward = 0.0;  ///< f in [0, 1]; 1: no error at constant speed
  double joint_stiffness = 0.0;        ///< k > 0 where the joint is elastic [N m/rad or N/m, by joint]
  double load_inertia = 0.0;           ///< J >= 0 [kg m² or kg]; 0: a rigid joint
  double joint_damping = 0.0;          ///< c >= 0 [N m s/rad or N s/m]
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// How far the drives are from where they are commanded to be.
struct TrackingError {
  struct Joint {
    double max = 0.0;  ///< largest |r − z| (|r − y| of a rigid joint) at the samples [rad or m]
  };
  std::vector<Joint> joints = {};
  std::size_t samples = 0;
};

/// What drives make of a trajectory, sample by sample; the command runs straight between samples (first-order hold),
/// which is solved exactly. At rest on the first sample.
class DriveModel {
 public:
  /// Takes the errors r − z of all joints at a time; length n.
  using Series = std::function<void(double time_s, std::span<const double> error)>;

  /// @param drives  one a joint, at most six
  /// @param series  called at every sample where it is given
  /// @throws InvalidInput naming the member ("drives[2].damping_ratio", counted from 1), if there are more than six, or
  ///         sample_period_s is not > 0
  DriveModel(const std::vector<Drive>& drives, double sample_period_s, Series series = {});
  void add(std::span<const Sample> samples);
  [[nodiscard]] TrackingError result() const;

 private:
  using State = Eigen::Matrix<double, 6, 1>;  // y, y', z, z', r, r'
  struct Joint {
    Eigen::Matrix<double, 6, 6> step;  // of the state over a period
    State state = State::Zero();
  };
  void add(const Sample& sample);
  double sample_period_s_;
  Series series_;
  std::vector<Joint> joints_;
  TrackingError error_;
};

}  // namespace robomill::path
