#include "robomill/decision/mirror.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"

namespace robomill::decision {
namespace {

constexpr double least_seen = 0.05;  ///< of the best direction's; tan²(θ/2) of two walls that meet at θ
constexpr double facing = 0.5;       ///< cosine to a direction from which a wall counts as facing it

void add(const WallPlace& place, MirrorCondition& sum) {
  sum.normals_m += place.width_m * place.normal * place.normal.transpose();
  sum.wanted_m2 += place.width_m * place.error_m * place.normal;
  sum.squares_m3 += place.width_m * place.error_m * place.error_m;
  sum.width_m += place.width_m;
}

/// Adds what dies away from one end of a stretch of feed moves, in the order of `points`, to the points that no block
/// asks anything of.
class Blend {
 public:
  explicit Blend(double blend_m) : blend_m_(blend_m) {}
  void start(const Eigen::Vector3d& offset_m) {
    from_m_ = offset_m;
    way_m_ = 0.0;
  }
  void end() { from_m_.setZero(); }
  [[nodiscard]] Eigen::Vector3d after(double way_m) {
    way_m_ += way_m;
    return blend_m_ > 0.0 ? Eigen::Vector3d(std::max(0.0, 1.0 - way_m_ / blend_m_) * from_m_)
                          : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }

 private:
  double blend_m_, way_m_ = 0.0;
  Eigen::Vector3d from_m_ = Eigen::Vector3d::Zero();
};

}  // namespace

MirrorCondition& MirrorCondition::operator+=(const MirrorCondition& other) {
  normals_m += other.normals_m;
  wanted_m2 += other.wanted_m2;
  squares_m3 += other.squares_m3;
  width_m += other.width_m;
  return *this;
}

Eigen::Vector3d MirrorCondition::offset_m() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normals_m);
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  const double most = eigen.eigenvalues()(2);
  if (!(most > 0.0)) return out;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (eigen.eigenvalues()(k) < least_seen * most) continue;
    const Eigen::Vector3d direction = eigen.eigenvectors().col(k);
    out += direction * (direction.dot(wanted_m2) / eigen.eigenvalues()(k));
  }
  return out;
}

double MirrorCondition::rms_m(const Eigen::Vector3d& offset_m) const {
  if (!(width_m > 0.0)) return 0.0;
  const double sum = squares_m3 - 2.0 * wanted_m2.dot(offset_m) + offset_m.dot(normals_m * offset_m);
  return std::sqrt(std::max(sum, 0.0) / width_m);
}

MirrorCondition condition_of(std::span<const WallPlace> places) {
  MirrorCondition out;
  for (const WallPlace& place : places) add(place, out);
  return out;
}

bool opposite_walls(std::span<const WallPlace> places) {
  const MirrorCondition all = condition_of(places);
  if (!(all.width_m > 0.0)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(all.normals_m);
  const Eigen::Vector3d across = eigen.eigenvectors().col(2);
  double along_m = 0.0;
  double against_m = 0.0;
  for (const WallPlace& place : places) {
    const double cosine = place.normal.dot(across);
    if (cosine > facing) along_m += place.width_m;
    if (cosine < -facing) against_m += place.width_m;
  }
  constexpr double least_wall = 0.05;  // of the width: less is the foot of a wall, or its rim
  if (std::min(along_m, against_m) < least_wall * all.width_m) return false;
  return all.rms_m(all.offset_m()) > 0.5 * all.rms_m(Eigen::Vector3d::Zero());
}

void MirrorOptions::validate() const {
  require_positive("max_offset_m", max_offset_m, "m");
  require_non_negative("blend_m", blend_m, "m");
}

MirrorOffsets mirror_offsets(std::span<const MirrorBlock> blocks, const MirrorOptions& options) {
  options.validate();
  const std::size_t points = blocks.size() + 1;
  MirrorOffsets out;
  out.point_m.assign(points, Eigen::Vector3d::Zero());
  out.bounded.assign(points, false);
  out.blended.assign(blocks.size(), false);
  std::vector<bool> asked(points, false);
  for (std::size_t i = 0; i < points; ++i) {
    MirrorCondition both;
    if (i > 0) both += blocks[i - 1].condition;
    if (i < blocks.size()) both += blocks[i].condition;
    if (!(both.width_m > 0.0)) continue;
    asked[i] = true;
    out.point_m[i] = both.offset_m();
  }
  std::vector<Eigen::Vector3d> blended(points, Eigen::Vector3d::Zero());
  Blend forwards(options.blend_m);
  for (std::size_t i = 0; i < points; ++i) {
    if (i > 0 && !blocks[i - 1].feed) forwards.end();
    if (asked[i]) forwards.start(out.point_m[i]);
    if (!asked[i] && i > 0) blended[i] += forwards.after(blocks[i - 1].length_m);
  }
  Blend backwards(options.blend_m);
  for (std::size_t i = points; i-- > 0;) {
    if (i < blocks.size() && !blocks[i].feed) backwards.end();
    if (asked[i]) backwards.start(out.point_m[i]);
    if (!asked[i] && i < blocks.size()) blended[i] += backwards.after(blocks[i].length_m);
  }
  for (std::size_t i = 0; i < points; ++i) {
    Eigen::Vector3d& offset = out.point_m[i];
    offset += blended[i];
    const double length = offset.norm();
    if (!(length > options.max_offset_m)) continue;
    offset *= options.max_offset_m / length;
    out.bounded[i] = true;
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool moved = out.point_m[i].squaredNorm() + out.point_m[i + 1].squaredNorm() > 0.0;
    out.blended[i] = blocks[i].feed && !(blocks[i].condition.width_m > 0.0) && moved;
  }
  return out;
}

}  // namespace robomill::decision
