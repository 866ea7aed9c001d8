#include "robomill/simulation/wall.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robomill::simulation::detail {
namespace {

constexpr int places_per_feed = 64;
constexpr std::size_t most_places = 200000;

}  // namespace

WallLine wall_line(const std::vector<WallPass>& passes, double feed_per_tooth_m) {
  WallLine line;
  if (passes.size() < 3 || !(feed_per_tooth_m > 0.0)) return line;
  double low = passes.front().out_m, high = low, least_bend = passes.front().bend_per_m, steepest = 0.0;
  double from = passes.front().x_m, to = from;
  for (const WallPass& pass : passes) {
    low = std::min(low, pass.out_m);
    high = std::max(high, pass.out_m);
    least_bend = std::min(least_bend, pass.bend_per_m);
    steepest = std::max(steepest, std::abs(pass.slope));
    from = std::min(from, pass.x_m);
    to = std::max(to, pass.x_m);
  }
  // A pass whose parabola has fallen below all the others' places no longer matters.
  const double reach = std::sqrt((high - low) / least_bend) + steepest / least_bend + 2.0 * feed_per_tooth_m;
  const double spacing = std::max(feed_per_tooth_m / places_per_feed, (to - from) / static_cast<double>(most_places));
  const double margin = std::min(reach, 0.25 * (to - from));
  const double begin = from + margin;
  const auto count = static_cast<std::ptrdiff_t>(std::floor((to - margin - begin) / spacing));
  if (count < 2) return line;
  line.out_m.assign(static_cast<std::size_t>(count), -std::numeric_limits<double>::infinity());
  for (const WallPass& pass : passes) {
    const auto first = static_cast<std::ptrdiff_t>(std::ceil((pass.x_m - reach - begin) / spacing));
    const auto last = static_cast<std::ptrdiff_t>(std::floor((pass.x_m + reach - begin) / spacing));
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(first, 0); i <= std::min(last, count - 1); ++i) {
      const double x = begin + static_cast<double>(i) * spacing - pass.x_m;
      double& out = line.out_m[static_cast<std::size_t>(i)];
      out = std::max(out, pass.out_m + pass.slope * x - pass.bend_per_m * x * x);
    }
  }
  std::erase_if(line.out_m, [](double out) { return !std::isfinite(out); });
  return line;
}

Roughness roughness(const WallLine& line) {
  Roughness r;
  if (line.out_m.empty()) return r;
  const double n = static_cast<double>(line.out_m.size());
  for (const double out : line.out_m) r.mean_m += out / n;
  for (const double out : line.out_m) r.ra_m += std::abs(out - r.mean_m) / n;
  const auto [low, high] = std::ranges::minmax(line.out_m);
  r.rz_m = high - low;
  return r;
}

}  // namespace robomill::simulation::detail
