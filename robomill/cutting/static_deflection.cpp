#include "robomill/cutting/static_deflection.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/cutting/engagement.hpp"

namespace robomill::cutting {
namespace {

/// A cut of some depth and what it does.
struct Trial {
  double depth_m = 0.0;
  double missing_m = 0.0;  ///< depth - (commanded - deflection): 0 where they agree
};

class DeflectionSearch {
 public:
  DeflectionSearch(const Cutter& cutter, const Cut& cut, const MillingCoefficients& coefficients,
                   const CutMotion& motion, const Eigen::Matrix3d& compliance, const ForceOptions& options, int slices)
      : cutter_(cutter),
        coefficients_(coefficients),
        motion_(motion),
        compliance_(compliance),
        options_(options),
        slices_(slices),
        commanded_m_(cut.axial_depth_m) {
    out_.cut = cut;
  }

  StaticDeflection run() {
    const double tolerance = 1e-9 * commanded_m_;
    Trial high = look(commanded_m_);
    if (std::abs(high.missing_m) <= tolerance) return out_;
    Trial low = high;
    if (high.missing_m > 0.0) {
      // Pushed out: the answer lies below. Where even next to no depth is too much, the tool lifts off.
      low = look(1e-3 * commanded_m_);
      if (low.missing_m > 0.0) return ended(StaticDeflection::Status::lifts_off);
    } else {
      // Pulled in: the answer lies deeper, if the structure holds it before the edges end.
      while (high.missing_m < 0.0) {
        low = high;
        const double deeper = low.depth_m + 0.1 * commanded_m_;
        if (low.depth_m >= 2.0 * commanded_m_ || !reachable(deeper)) return ended(StaticDeflection::Status::diverged);
        high = look(deeper);
      }
    }
    // Regula falsi whose stale end is halved [DowellJarratt1971].
    int side = 0;
    for (int i = 0; i < 60; ++i) {
      const double depth =
          (low.depth_m * high.missing_m - high.depth_m * low.missing_m) / (high.missing_m - low.missing_m);
      const Trial middle = look(depth);
      if (std::abs(middle.missing_m) <= tolerance || high.depth_m - low.depth_m <= tolerance) break;
      if (middle.missing_m > 0.0) {
        high = middle;
        if (side == 1) low.missing_m *= 0.5;
        side = 1;
      } else {
        low = middle;
        if (side == -1) high.missing_m *= 0.5;
        side = -1;
      }
    }
    return out_;
  }

 private:
  /// Whether the cutter can go so deep, and its coefficients hold there.
  [[nodiscard]] bool reachable(double depth_m) const {
    Cut cut = out_.cut;
    cut.axial_depth_m = depth_m;
    try {
      const Engagement engagement = engage(cutter_, cut, {.slices = slices_});
      static_cast<void>(cutting_force(cutter_, engagement, coefficients_, motion_, options_));
    } catch (const InvalidInput&) {
      return false;
    }
    return true;
  }
  Trial look(double depth_m) {
    out_.cut.axial_depth_m = depth_m;
    out_.engagement = engage(cutter_, out_.cut, {.slices = slices_});
    out_.force = cutting_force(cutter_, out_.engagement, coefficients_, motion_, options_);
    out_.deflection_m = compliance_ * out_.force.mean_n;
    const Eigen::Matrix3Xd motion = compliance_ * out_.force.force_n;
    out_.peak_deflection_m = motion.cols() > 0 ? motion.colwise().norm().maxCoeff() : 0.0;
    return {.depth_m = depth_m, .missing_m = depth_m - commanded_m_ + out_.deflection_m.z()};
  }
  StaticDeflection ended(StaticDeflection::Status status) {
    look(commanded_m_);  // what the cut would ask of it if it could
    out_.status = status;
    return out_;
  }

  const Cutter& cutter_;
  const MillingCoefficients& coefficients_;
  const CutMotion& motion_;
  Eigen::Matrix3d compliance_;
  ForceOptions options_;
  int slices_;
  double commanded_m_;
  StaticDeflection out_;
};

}  // namespace

StaticDeflection static_deflection(const Cutter& cutter, const Cut& cut, const MillingCoefficients& coefficients,
                                   const CutMotion& motion, const Eigen::Matrix3d& compliance_m_per_n,
                                   const ForceOptions& options, int slices) {
  cut.validate(cutter);
  return DeflectionSearch(cutter, cut, coefficients, motion, compliance_m_per_n, options, slices).run();
}

}  // namespace robomill::cutting
