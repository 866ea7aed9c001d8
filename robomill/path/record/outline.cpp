#include "robomill/path/record/outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>

namespace robomill::path {
namespace {

constexpr std::size_t outline_points = 2000;
constexpr std::size_t reach = 6;        // moves shown to each side of a corner
constexpr double view_tolerances = 12;  // half a view's width in tolerances: a blend of this tolerance fills it
constexpr double least_turn_rad = 0.02;

struct Vertex {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  std::size_t block = 0, line = 0;  ///< of the move that ends here
};

struct CornerCandidate {
  ProgramCorner corner = {};
  double weight = 0.0;
};

/// The corner in the middle of a window of vertices.
ProgramCorner view(const std::deque<Vertex>& window, std::size_t middle, double radius_m) {
  const Vertex& at = window[middle];
  const Eigen::Vector3d in = (at.tip_m - window[middle - 1].tip_m).normalized();
  const Eigen::Vector3d out = (window[middle + 1].tip_m - at.tip_m).normalized();
  ProgramCorner corner;
  corner.block = at.block;
  corner.line = at.line;
  corner.turn_rad = program::angle_between(in, out);
  corner.radius_m = radius_m;
  corner.corner_m = at.tip_m;
  const Eigen::Vector3d inside = (out - in).normalized();
  const Eigen::Vector3d both = in + out;
  const Eigen::Vector3d along = both.norm() > 1e-6 ? Eigen::Vector3d(both.normalized()) : inside.unitOrthogonal();
  corner.plane << along.transpose(), inside.transpose();
  corner.vertices_m.resize(2, static_cast<Eigen::Index>(window.size()));
  for (std::size_t i = 0; i < window.size(); ++i) {
    corner.vertices_m.col(static_cast<Eigen::Index>(i)) = corner.plane * (window[i].tip_m - at.tip_m);
  }
  return corner;
}

/// The corners of greatest weight so far, of each kind of turn some, so that a program of one kind of sharp corners
/// shows its others too.
class Sharpest {
 public:
  Sharpest(std::size_t most, double radius_m) : most_(most), radius_m_(radius_m) {}

  void look(const std::deque<Vertex>& window, std::size_t middle) {
    if (most_ == 0) return;
    const Eigen::Vector3d in = window[middle].tip_m - window[middle - 1].tip_m;
    const Eigen::Vector3d out = window[middle + 1].tip_m - window[middle].tip_m;
    const double turn = program::angle_between(in.normalized(), out.normalized());
    if (turn < least_turn_rad) return;
    const double weight = (1.0 - std::cos(turn)) * std::min({in.norm(), out.norm(), radius_m_});
    std::vector<CornerCandidate>& kind =
        kinds_.at(std::min(static_cast<std::size_t>(turn / kind_rad), kinds_.size() - 1));
    if (kind.size() == most_ && weight <= kind.back().weight) return;
    const auto here = [&](const CornerCandidate& other) {
      return (other.corner.corner_m - window[middle].tip_m).norm() < radius_m_;
    };
    for (const std::vector<CornerCandidate>& others : kinds_) {
      if (std::ranges::any_of(others,
                              [&](const CornerCandidate& other) { return other.weight >= weight && here(other); }))
        return;
    }
    for (std::vector<CornerCandidate>& others : kinds_) std::erase_if(others, here);
    if (kind.size() == most_) kind.pop_back();
    const auto lighter =
        std::ranges::find_if(kind, [&](const CornerCandidate& other) { return other.weight < weight; });
    kind.insert(lighter, {.corner = view(window, middle, radius_m_), .weight = weight});
  }

  /// The first of each kind, then the second of each, …, sharp kinds first.
  [[nodiscard]] std::vector<ProgramCorner> corners() const {
    std::vector<ProgramCorner> out;
    for (std::size_t rank = 0; rank < most_; ++rank) {
      for (auto kind = kinds_.rbegin(); kind != kinds_.rend() && out.size() < most_; ++kind) {
        if (rank < kind->size()) out.push_back((*kind)[rank].corner);
      }
    }
    std::ranges::sort(out, {}, &ProgramCorner::block);
    return out;
  }

 private:
  static constexpr double kind_rad = std::numbers::pi / 6.0;
  std::size_t most_;
  double radius_m_;
  std::array<std::vector<CornerCandidate>, 6> kinds_;  ///< by turn; each by weight, falling
};

}  // namespace

ProgramOutline outline(program::Source& source, double tip_tolerance_m, std::size_t corners) {
  source.rewind();
  ProgramOutline out;
  Decimated<Eigen::Vector3d> path(outline_points);
  Sharpest sharpest(corners, view_tolerances * tip_tolerance_m);
  std::deque<Vertex> window = {{.tip_m = source.start().tip_m}};
  std::size_t middle = 0;  // the next vertex of the window to be looked at
  const auto look = [&] {
    if (middle > 0) sharpest.look(window, middle);
    ++middle;
    if (middle > reach) {
      window.pop_front();
      --middle;
    }
  };
  path.add(source.start().tip_m);
  program::Block block;
  Eigen::Vector3d last = source.start().tip_m;
  for (; source.next(block); ++out.blocks) {
    if (block.end.tip_m == last) continue;  // a dwell or a turn of the axis alone is no corner of the path
    last = block.end.tip_m;
    path.add(last);
    window.push_back({.tip_m = last, .block = out.blocks, .line = block.line});
    if (window.size() > middle + reach) look();
  }
  while (middle + 1 < window.size()) look();
  std::vector<Eigen::Vector3d> points = path.kept();
  if (points.back() != last) points.push_back(last);
  out.path_m.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) out.path_m.col(static_cast<Eigen::Index>(i)) = points[i];
  out.corners = sharpest.corners();
  source.rewind();
  return out;
}

}  // namespace robomill::path
