#pragma once
#include <Eigen/Core>

#include "robomill/base/export.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"

// Method: robomill/cutting/README.md, "A structure that deflects (`static_deflection.hpp`)"

namespace robomill::cutting {

/// A steady cut whose mean force has bent what holds the tool.
struct StaticDeflection {
  Cut cut;                ///< with the depth that is left
  Engagement engagement;  ///< of that cut
  CuttingForce force;
  Eigen::Vector3d deflection_m = Eigen::Vector3d::Zero();  ///< q = C F̄, in F [m]
  double peak_deflection_m = 0.0;                          ///< greatest |C F| over the revolution
  enum class Status {
    found,     ///< the depth agrees with its own force: |h' - h + q_z(h')| <= 1e-9 h, or h' lies in a range <= 1e-9 h;
               ///< the search ends after 60 rounds in any case
    diverged,  ///< the force pulls the tool in faster than the structure holds it: no static deflection up to 2 h, or
               ///< as deep as edges and coefficients hold
    lifts_off  ///< the tool is pushed out of the cut altogether: h' < 1e-3 h
  };
  Status status = Status::found;
};

/// The depth at which force and deflection agree: h' = h - q_z(h'), q = C F̄(h'). The step-over stays, since the
/// neighbouring pass was bent alike; q_x only lags along the feed, and q_y shifts the pass, which is the error of a
/// wall. With C = 0 this is the rigid cut.
/// @param compliance_m_per_n  C, 3 x 3 of the tip against the part, in F [m/N]
/// @param slices              rings of the engagement; 0: chosen
/// @throws InvalidInput as engage and cutting_force
[[nodiscard]] ROBOMILL_API StaticDeflection static_deflection(const Cutter& cutter, const Cut& cut,
                                                              const MillingCoefficients& coefficients,
                                                              const CutMotion& motion,
                                                              const Eigen::Matrix3d& compliance_m_per_n,
                                                              const ForceOptions& options = {}, int slices = 0);

}  // namespace robomill::cutting
