#pragma once
#include <vector>

#include "robomill/stability/collocation/mesh/finished_profile.hpp"
#include "robomill/stability/collocation/spatial_model.hpp"
#include "robomill/stability/surface_error.hpp"

// Derived in docs/theory/three-directions.md, "The surface that a stable cut leaves"
namespace robomill::stability::detail {

/// The steady motion of cuts in three directions and what it leaves. Shared by threads.
class SpatialSurface {
 public:
  /// @param problem  with milling in three directions; must outlive this
  explicit SpatialSurface(const LobesProblem& problem);
  /// Of a cut that is stable.
  [[nodiscard]] SurfacePoint at(const OperatingPoint& point, int level) const;
  [[nodiscard]] std::vector<SurfacePlace> profile(const OperatingPoint& point, int level) const;
  [[nodiscard]] ForcedVibration vibration(const OperatingPoint& point, int level) const;
  /// Profile and vibration.
  [[nodiscard]] SteadyCut steady(const OperatingPoint& point, int level) const;
  [[nodiscard]] const SpatialModel& model() const { return model_; }

 private:
  class Motion;
  [[nodiscard]] std::vector<SurfacePlace> profile(const OperatingPoint& point, const Motion& motion) const;
  /// The tip over a period, in the structure's axes.
  [[nodiscard]] Eigen::Matrix3Xd path(const OperatingPoint& point, const Motion& motion) const;
  [[nodiscard]] ForcedVibration vibration(const OperatingPoint& point, const Motion& motion,
                                          const Eigen::Matrix3Xd& path) const;
  [[nodiscard]] FinishedProfile finished(const OperatingPoint& point, const Motion& motion) const;
  [[nodiscard]] SurfacePlace at(const SilhouettePoint& place, const Motion& motion) const;

  const SpatialMilling& milling_;
  SpatialModel::Parts parts_;
  SpatialModel model_;
  TipDynamicsIn<3> tip_;
};

}  // namespace robomill::stability::detail
