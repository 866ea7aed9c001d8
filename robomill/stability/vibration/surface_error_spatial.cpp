#include "robomill/stability/vibration/surface_error_spatial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "robomill/base/units.hpp"
#include "robomill/stability/collocation/mesh/finished_profile.hpp"
#include "robomill/stability/collocation/regenerated_motion.hpp"
#include "robomill/stability/collocation/steady_motion.hpp"
#include "robomill/stability/vibration/steady_vibration.hpp"

namespace robomill::stability::detail {

/// q of a period: the answer to the steady force, and of teeth that differ what they regenerate.
class SpatialSurface::Motion {
 public:
  Motion(const SpatialSurface& surface, const OperatingPoint& point, int level)
      : level_(mesh_level(level)),
        engagement_(surface.parts_.engage(point.axial_depth_m, (level_.nodes + 4) * level_.splits)),
        axes_(surface.parts_.turns_with_tool ? Eigen::Matrix3d::Identity() : engagement_.feed_from_tool),
        force_(steady_force(surface.parts_.cutter, engagement_, surface.parts_.coefficients,
                            surface.parts_.feed_per_tooth_m, axes_)),
        steady_(surface.tip_, force_, point.spindle_speed_rad_per_s),
        period_rad_(surface.model_.whole_rad()) {
    if (period_rad_ < 0.999 * units::revolution || surface.parts_.cutter.mill.teeth == 1) return;
    case_ = std::make_unique<CollocationCase>();
    surface.model_.prepare(point, level_, *case_);
    if (case_->mesh.topology.form != MeshTopology::Form::blocks) return;
    regenerated_ = std::make_unique<RegeneratedMotion>(
        *case_, surface.tip_, [this](double rotation_rad) { return steady_.at(rotation_rad); });
  }
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;
  Motion(Motion&&) = delete;
  Motion& operator=(Motion&&) = delete;
  ~Motion() = default;

  /// In the structure's axes.
  [[nodiscard]] Eigen::Vector3d at(double rotation_rad) const {
    Eigen::Vector3d q = steady_.at(rotation_rad);
    if (regenerated_) q += regenerated_->at(rotation_rad);
    return q;
  }
  [[nodiscard]] const cutting::Engagement& engagement() const { return engagement_; }
  /// The structure's axes from F.
  [[nodiscard]] Eigen::Matrix3d from_feed() const { return axes_ * engagement_.feed_from_tool.transpose(); }
  [[nodiscard]] const SteadyForce& force() const { return force_; }
  [[nodiscard]] double period_rad() const { return period_rad_; }

 private:
  MeshLevel level_;
  cutting::Engagement engagement_;
  Eigen::Matrix3d axes_;  ///< from T
  SteadyForce force_;
  SteadyMotion steady_;
  double period_rad_;
  std::unique_ptr<CollocationCase> case_;
  std::unique_ptr<RegeneratedMotion> regenerated_;
};

SpatialSurface::SpatialSurface(const LobesProblem& problem)
    : milling_(*problem.spatial),
      parts_(spatial_parts(problem, SweptParameter::axial_depth)),
      model_(parts_),
      tip_(tip_dynamics<3>(parts_.structure)) {}

/// The tooth that reaches farthest leaves the surface; a stiff tool's would reach as far as its radius.
SurfacePlace SpatialSurface::at(const SilhouettePoint& place, const Motion& motion) const {
  const cutting::FlatEndMill& mill = parts_.cutter.mill;
  const double height_m = place.on_profile.height_m;
  const double sine = std::sin(place.on_profile.position_rad);
  const Eigen::Vector3d normal = motion.from_feed() * place.normal;
  SurfacePlace out;
  out.position_rad = place.on_profile.position_rad;
  out.angle_rad = place.angle_rad;
  out.height_m = height_m;
  out.radius_m = place.on_profile.radius_m;
  out.normal_rad = std::atan2(place.normal.y(), -place.normal.z());
  double stiff_m = -std::numeric_limits<double>::infinity();
  double reach_m = stiff_m;
  const bool equal = motion.period_rad() < 0.999 * units::revolution;
  for (int tooth = 0; tooth < (equal ? 1 : mill.teeth); ++tooth) {
    const double rotation = place.angle_rad - mill.standing_angle(tooth) + mill.lag_rad_per_m(tooth) * height_m;
    const double longer = mill.radius_deviation_m(tooth, height_m) * sine;
    const double reach = longer + normal.dot(motion.at(rotation));
    stiff_m = std::max(stiff_m, longer);
    if (reach <= reach_m) continue;
    reach_m = reach;
    out.tooth = tooth;
  }
  out.error_m = out.tooth >= 0 ? stiff_m - reach_m : std::numeric_limits<double>::quiet_NaN();
  return out;
}

FinishedProfile SpatialSurface::finished(const OperatingPoint& point, const Motion& motion) const {
  constexpr double step_rad = 0.05;  // of rotation
  constexpr double mode_rad = 0.15;  // of the fastest mode
  const double fastest = tip_.pole.cwiseAbs().maxCoeff() / point.spindle_speed_rad_per_s;
  const double step = std::clamp(mode_rad / fastest, 0.002, step_rad);
  return finished_profile(milling_, point.axial_depth_m, motion.engagement(), step);
}

std::vector<SurfacePlace> SpatialSurface::profile(const OperatingPoint& point, const Motion& motion) const {
  std::vector<SurfacePlace> out;
  for (const SilhouettePoint& place : finished(point, motion).places) out.push_back(at(place, motion));
  return out;
}

std::vector<SurfacePlace> SpatialSurface::profile(const OperatingPoint& point, int level) const {
  return profile(point, Motion(*this, point, level));
}

Eigen::Matrix3Xd SpatialSurface::path(const OperatingPoint& point, const Motion& motion) const {
  constexpr double looks_per_mode_period = 24.0;
  const double cycles =
      tip_.pole.cwiseAbs().maxCoeff() * motion.period_rad() / (units::revolution * point.spindle_speed_rad_per_s);
  const auto looks = static_cast<Eigen::Index>(std::clamp(looks_per_mode_period * cycles, 48.0, 2000.0));
  Eigen::Matrix3Xd out(3, looks);
  for (Eigen::Index i = 0; i < looks; ++i) {
    out.col(i) = motion.at(motion.period_rad() * static_cast<double>(i) / static_cast<double>(looks));
  }
  return out;
}

ForcedVibration SpatialSurface::vibration(const OperatingPoint& point, const Motion& motion,
                                          const Eigen::Matrix3Xd& path) const {
  return vibration_of(
      tip_, {.force = motion.force(), .path = path, .spindle_speed_rad_per_s = point.spindle_speed_rad_per_s});
}

ForcedVibration SpatialSurface::vibration(const OperatingPoint& point, int level) const {
  const Motion motion(*this, point, level);
  return vibration(point, motion, path(point, motion));
}

SteadyCut SpatialSurface::steady(const OperatingPoint& point, int level) const {
  const Motion motion(*this, point, level);
  return {.profile = profile(point, motion), .vibration = vibration(point, motion, path(point, motion))};
}

SurfacePoint SpatialSurface::at(const OperatingPoint& point, int level) const {
  const Motion motion(*this, point, level);
  SurfacePoint out;
  out.stable = true;
  const FinishedProfile finished = this->finished(point, motion);
  out.remains = finished.remains;
  for (const SilhouettePoint& place : finished.places) {
    const SurfacePlace here = at(place, motion);
    if (!(std::abs(here.error_m) <= std::abs(out.place.error_m))) out.place = here;
  }
  out.surface_location_error_m = out.place.error_m;
  const Eigen::Matrix3Xd tip_m = path(point, motion);
  const Eigen::Matrix3Xd in_feed = motion.from_feed().transpose() * tip_m;
  const Eigen::Vector3d low = in_feed.rowwise().minCoeff();
  const Eigen::Vector3d high = in_feed.rowwise().maxCoeff();
  out.peak_deflection_m = tip_m.colwise().norm().maxCoeff();
  out.vibration = vibration(point, motion, tip_m);
  out.peak_to_peak_x_m = high.x() - low.x();
  out.peak_to_peak_y_m = high.y() - low.y();
  out.peak_to_peak_z_m = high.z() - low.z();
  return out;
}

}  // namespace robomill::stability::detail
