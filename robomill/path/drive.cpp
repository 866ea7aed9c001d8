#include "robomill/path/drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::path {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

namespace {

// exp(A) by Taylor's series of A / 2^s, squared s times.
Matrix6 exponential(const Matrix6& a) {
  const double size = a.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(std::max(size, 1e-300) / 0.25))));
  const Matrix6 small = a / std::ldexp(1.0, halvings);
  Matrix6 term = Matrix6::Identity(), sum = Matrix6::Identity();
  for (int k = 1; k <= 14; ++k) {  // 0.25^15 / 15! is below 1e-21
    term = Matrix6(term * small) / k;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = Matrix6(sum * sum);
  return sum;
}

// d/dt of (y, y', z, z', r, r') with r' constant. Scaled time would not matter to exp; lengths do not mix.
Matrix6 rates(const Drive& drive) {
  const double w = 2.0 * std::numbers::pi * drive.natural_frequency_hz, d = 2.0 * drive.damping_ratio * w;
  Matrix6 a = Matrix6::Zero();
  a(0, 1) = 1.0;
  a.row(1) << -w * w, -d, 0.0, 0.0, w * w, drive.velocity_feed_forward * d;
  if (drive.load_inertia > 0.0) {
    const double k = drive.joint_stiffness / drive.load_inertia, c = drive.joint_damping / drive.load_inertia;
    a(2, 3) = 1.0;
    a.row(3) << k, c, -k, -c, 0.0, 0.0;
  }
  a(4, 5) = 1.0;
  return a;
}

}  // namespace

void Drive::validate() const {
  require_positive("natural_frequency_hz", natural_frequency_hz, "Hz",
                   "10 to 50 Hz suit machine tools, 2 to 10 robots");
  require_positive("damping_ratio", damping_ratio, "");
  require_non_negative("velocity_feed_forward", velocity_feed_forward, "");
  if (velocity_feed_forward > 1.0) {
    throw InvalidInput("velocity_feed_forward", velocity_feed_forward, "", "must be at most 1");
  }
  require_non_negative("load_inertia", load_inertia, "kg m^2 or kg");
  require_non_negative("joint_damping", joint_damping, "N m s/rad or N s/m");
  if (load_inertia > 0.0) require_positive("joint_stiffness", joint_stiffness, "N m/rad or N/m");
}

DriveModel::DriveModel(const std::vector<Drive>& drives, double sample_period_s, Series series)
    : sample_period_s_(sample_period_s), series_(std::move(series)) {
  require_positive("sample_period_s", sample_period_s, "s");
  if (drives.size() > 6) {
    throw InvalidInput("drives", static_cast<double>(drives.size()), "", "must be at most six");
  }
  joints_.reserve(drives.size());
  for (std::size_t j = 0; j < drives.size(); ++j) {
    try {
      drives[j].validate();
    } catch (const InvalidInput& error) {
      throw within("drives[" + std::to_string(j + 1) + "].", error);
    }
    Joint joint;
    joint.step = exponential(rates(drives[j]) * sample_period_s);
    if (!(drives[j].load_inertia > 0.0)) {  // the load is the motor
      joint.step.row(2) = joint.step.row(0);
      joint.step.row(3) = joint.step.row(1);
    }
    joints_.push_back(joint);
  }
  error_.joints.resize(drives.size());
}

void DriveModel::add(std::span<const Sample> samples) {
  for (const Sample& sample : samples) add(sample);
}

void DriveModel::add(const Sample& sample) {
  std::array<double, 6> errors = {};
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const double command = sample.joints[static_cast<Eigen::Index>(j)];
    if (error_.samples == 0) {
      joint.state << command, 0.0, command, 0.0, command, 0.0;
    } else {
      joint.state[5] = (command - joint.state[4]) / sample_period_s_;
      joint.state = State(joint.step * joint.state);
      joint.state[4] = command;  // no sum of differences
    }
    const double error = command - joint.state[2];
    errors[j] = error;
    error_.joints[j].max = std::max(error_.joints[j].max, std::abs(error));
  }
  ++error_.samples;
  if (series_) series_(sample.time_s, std::span<const double>(errors.data(), joints_.size()));
}

TrackingError DriveModel::result() const {
  return error_;
}

}  // namespace robomill::path
