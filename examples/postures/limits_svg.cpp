#include "examples/postures/limits_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "examples/postures/ten_postures.hpp"

namespace robomill::examples {
namespace {

constexpr double panel_width = 220.0, panel_height = 150.0, left = 46.0, gap = 22.0, top = 40.0, row_gap = 62.0;
constexpr std::array<const char*, 3> colours{"#0072b2", "#d55e00", "#009e73"};  // told apart by everybody

/// One panel's scale: speeds in thousands across, depths in mm up.
struct Panel {
  double x = 0.0, y = 0.0, first_rpm = 0.0, last_rpm = 1.0, highest_mm = 1.0;
  [[nodiscard]] double across(double rpm) const { return x + panel_width * (rpm - first_rpm) / (last_rpm - first_rpm); }
  [[nodiscard]] double up(double mm) const { return y + panel_height * (1.0 - std::min(mm, highest_mm) / highest_mm); }
};

void draw_frame(const Panel& panel, const std::string& title, std::string& out) {
  out += fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='#888'/>\n", panel.x, panel.y,
                     panel_width, panel_height);
  out += fmt::format("<text x='{}' y='{}'>{}</text>\n", panel.x, panel.y - 6.0, title);
  for (double rpm = 3000.0; rpm <= panel.last_rpm; rpm += 4000.0) {
    out += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{:.0f},000</text>\n", panel.across(rpm),
                       panel.y + panel_height + 14.0, rpm / 1000.0);
  }
  for (int k = 0; k <= 4; ++k) {
    const double mm = 0.25 * k * panel.highest_mm;
    out +=
        fmt::format("<text x='{}' y='{:.1f}' text-anchor='end'>{:.2f}</text>\n", panel.x - 4.0, panel.up(mm) + 4.0, mm);
  }
}

void draw_curve(const Panel& panel, const std::vector<double>& rpm, const std::vector<double>& limit_m,
                const char* colour, std::string& out) {
  std::string path;
  bool drawn = false;
  for (std::size_t k = 0; k < rpm.size(); ++k) {
    const double mm = 1e3 * limit_m[k];
    if (!std::isfinite(mm)) {
      drawn = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", drawn ? "L" : "M", panel.across(rpm[k]), panel.up(mm));
    drawn = true;
  }
  out += fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='1.3'/>\n", path, colour);
}

/// Above nine tenths of what the curves reach.
double highest_mm(const LimitRow& row) {
  std::vector<double> all;
  for (const std::vector<double>& curve : row.limit_m) {
    for (const double limit : curve) {
      if (std::isfinite(limit)) all.push_back(1e3 * limit);
    }
  }
  if (all.empty()) return 1.0;
  std::sort(all.begin(), all.end());
  return 0.4 * std::ceil(1.2 * all[all.size() * 9 / 10] / 0.4);
}

}  // namespace

std::string limits_svg(const std::vector<double>& spindle_speed_rpm, const std::vector<LimitRow>& rows) {
  const double step = panel_width + left + gap, row_step = panel_height + row_gap;
  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' font-family='sans-serif' "
      "font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
      4.0 * step, top + static_cast<double>(rows.size()) * row_step);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t d = 0; d < directions().size(); ++d) {
      const Direction& direction = directions()[d];
      const Panel panel{.x = left + static_cast<double>(d) * step,
                        .y = top + static_cast<double>(r) * row_step,
                        .first_rpm = spindle_speed_rpm.front(),
                        .last_rpm = spindle_speed_rpm.back(),
                        .highest_mm = highest_mm(rows[r])};
      draw_frame(panel, fmt::format("{}: {}", direction.name, rows[r].title), out);
      for (std::size_t k = 0; k < direction.postures.size(); ++k) {
        const std::size_t posture = direction.postures[k];
        draw_curve(panel, spindle_speed_rpm, rows[r].limit_m[posture], colours[k], out);
        out += fmt::format("<text x='{}' y='{}' fill='{}' text-anchor='end'>{}</text>\n", panel.x + panel_width - 5.0,
                           panel.y + 14.0 + 13.0 * static_cast<double>(k), colours[k], posture + 1);
      }
    }
  }
  out += fmt::format("<text x='{}' y='14'>limit depth in mm over spindle speed in rpm; numbers are postures</text>\n",
                     left);
  return out + "</svg>\n";
}

}  // namespace robomill::examples
