#include "robomill/process/blocks/classes.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/cutting/polynomial.hpp"

namespace robomill::process {
namespace {

/// ∫ u uᵀ dφ over an arc, u = (1, sin φ, cos φ).
Eigen::Matrix3d arc_products(const cutting::Arc& arc) {
  const double a = arc.entry_rad;
  const double b = arc.exit_rad;
  const double sine = std::cos(a) - std::cos(b);
  const double cosine = std::sin(b) - std::sin(a);
  const double twice = 0.25 * (std::sin(2.0 * b) - std::sin(2.0 * a));
  const double mixed = 0.25 * (std::cos(2.0 * a) - std::cos(2.0 * b));
  const double half = 0.5 * (b - a);
  Eigen::Matrix3d out;
  out << b - a, sine, cosine, sine, half - twice, mixed, cosine, mixed, half + twice;
  return out;
}

}  // namespace

Eigen::Matrix3d mean_stiffness(const cutting::PoseEngagement& cut, const cutting::MillingCoefficients& coefficients) {
  using cutting::detail::polynomial;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();  // in T
  const cutting::Engagement& e = cut.engagement;
  for (std::size_t i = 0; i < e.slices.size(); ++i) {
    const cutting::EdgeSlice& ring = e.slices[i];
    Eigen::Matrix3d over = Eigen::Matrix3d::Zero();
    for (const cutting::Arc& arc : e.of(i)) over += arc_products(arc);
    const double kappa = ring.position_rad;
    const double sk = std::sin(kappa);
    const double ck = std::cos(kappa);
    Eigen::Matrix3d normal;  // n, t and a as linear maps of u
    Eigen::Matrix3d tangent;
    Eigen::Matrix3d axial;
    normal << 0.0, sk, 0.0, 0.0, 0.0, sk, -ck, 0.0, 0.0;
    tangent << 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0;
    axial << 0.0, ck, 0.0, 0.0, 0.0, ck, sk, 0.0, 0.0;
    const Eigen::Matrix3d force = polynomial(coefficients.tangential_n_per_m2, kappa) * tangent -
                                  polynomial(coefficients.radial_n_per_m2, kappa) * normal +
                                  polynomial(coefficients.axial_n_per_m2, kappa) * axial;
    sum += ring.width_m * force * over * normal.transpose();
  }
  const Eigen::Matrix3d work_from_tool = cut.work_from_feed * e.feed_from_tool;
  return work_from_tool * sum * work_from_tool.transpose();
}

bool Classes::alike(const CutLook& a, const CutLook& b) const {
  const double apart = std::min((a.along_feed - b.along_feed).norm(), (a.along_feed + b.along_feed).norm());
  return a.spindle_speed_rad_per_s == b.spindle_speed_rad_per_s &&
         std::abs(a.axial_depth_m - b.axial_depth_m) <= tolerance_.cut_share * b.axial_depth_m &&
         std::abs(a.feed_per_tooth_m - b.feed_per_tooth_m) <= tolerance_.cut_share * b.feed_per_tooth_m &&
         (a.stiffness - b.stiffness).norm() <= tolerance_.cut_share * b.stiffness.norm() &&
         apart <= tolerance_.cut_share * b.stiffness.norm() &&
         (a.joints - b.joints).cwiseAbs().maxCoeff() <= tolerance_.joint_rad;
}

std::size_t Classes::add(std::size_t block, const CutLook& look) {
  const std::size_t count = first_.size();
  for (std::size_t back = 1; back <= std::min(count, remembered); ++back) {
    const std::size_t at = count - back;
    if (alike(look, latest_[at % remembered])) return at;
  }
  first_.push_back(block);
  if (latest_.size() < remembered) {
    latest_.push_back(look);
  } else {
    latest_[count % remembered] = look;
  }
  return count;
}

}  // namespace robomill::process
