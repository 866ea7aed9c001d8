#include "robomill/robot/collision/inside.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace robomill::robot {
namespace {

constexpr int most_bins_across = 512;

}  // namespace

std::size_t open_edges(const io::TriangleMesh& mesh) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      edges.push_back(std::uint64_t{low} << 32U | high);
    }
  }
  std::ranges::sort(edges);
  std::size_t open = 0;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    open += (end - i) % 2;
    i = end;
  }
  return open;
}

InsideTest::InsideTest(const io::TriangleMesh& mesh) : mesh_(mesh) {
  for (const Eigen::Vector3d& vertex : mesh.vertices_m) box_.extend(vertex);
  const double count = static_cast<double>(mesh.triangles.size());
  across_ = static_cast<int>(std::clamp(std::sqrt(count / 2.0), 1.0, double{most_bins_across}));
  // Triangles that are long in x and y stand in many bins: fewer bins, then.
  while (!sort_into_bins(16 * mesh.triangles.size() + 1000)) across_ /= 2;
}

int InsideTest::bin(int axis, double at_m) const {
  const double size_m = box_.max()(axis) - box_.min()(axis);
  if (!(size_m > 0.0)) return 0;
  const double place = std::floor((at_m - box_.min()(axis)) / size_m * across_);
  return static_cast<int>(std::clamp(place, 0.0, double(across_ - 1)));
}

bool InsideTest::sort_into_bins(std::size_t most_entries) {
  struct Range {
    std::array<int, 2> first, last;
  };
  std::vector<Range> ranges;
  ranges.reserve(mesh_.triangles.size());
  std::size_t total = 0;
  for (const auto& triangle : mesh_.triangles) {
    Eigen::AlignedBox3d box;
    for (const std::uint32_t corner : triangle) box.extend(mesh_.vertices_m[corner]);
    const Range& range = ranges.emplace_back(
        Range{{bin(0, box.min().x()), bin(1, box.min().y())}, {bin(0, box.max().x()), bin(1, box.max().y())}});
    total += static_cast<std::size_t>(range.last[0] - range.first[0] + 1) *
             static_cast<std::size_t>(range.last[1] - range.first[1] + 1);
  }
  if (total > most_entries && across_ > 1) return false;
  const auto each_bin = [&](const auto& visit) {
    for (std::size_t t = 0; t < ranges.size(); ++t) {
      for (int y = ranges[t].first[1]; y <= ranges[t].last[1]; ++y) {
        for (int x = ranges[t].first[0]; x <= ranges[t].last[0]; ++x) {
          visit(static_cast<std::size_t>(y * across_ + x), static_cast<std::uint32_t>(t));
        }
      }
    }
  };
  begin_.assign(static_cast<std::size_t>(across_ * across_) + 1, 0);
  each_bin([&](std::size_t at, std::uint32_t) { ++begin_[at + 1]; });
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  entries_.resize(total);
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  each_bin([&](std::size_t at, std::uint32_t triangle) { entries_[next[at]++] = triangle; });
  return true;
}

bool InsideTest::meets(const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& at_m) const {
  bool within = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
    const Eigen::Vector3d &a = mesh_.vertices_m[low], &b = mesh_.vertices_m[high];
    if ((a.y() > at_m.y()) == (b.y() > at_m.y())) continue;
    within ^= at_m.x() < a.x() + (at_m.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
  }
  if (!within) return false;
  const Eigen::Vector3d& a = mesh_.vertices_m[triangle[0]];
  const Eigen::Vector3d normal = (mesh_.vertices_m[triangle[1]] - a).cross(mesh_.vertices_m[triangle[2]] - a);
  const Eigen::Vector3d from = at_m - a;
  return a.z() - (normal.x() * from.x() + normal.y() * from.y()) / normal.z() > at_m.z();
}

bool InsideTest::inside(const Eigen::Vector3d& at_m) const {
  if (!box_.contains(at_m)) return false;
  const auto at = static_cast<std::size_t>(bin(1, at_m.y()) * across_ + bin(0, at_m.x()));
  bool out = false;
  for (std::size_t i = begin_[at]; i < begin_[at + 1]; ++i) out ^= meets(mesh_.triangles[entries_[i]], at_m);
  return out;
}

}  // namespace robomill::robot
