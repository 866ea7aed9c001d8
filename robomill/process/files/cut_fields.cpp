#include "robomill/process/files/cut_fields.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/cutting/unusual_cut.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::process {

void read_cutter(io::TomlFile& file, cutting::Cutter& cutter) {
  cutting::cutter_table().read(file, "tool", cutter);
  if (cutter.kind == cutting::CutterKind::flat_end || cutter.kind == cutting::CutterKind::ball_end) {
    for (const char* key : {"tool.corner_radius_mm", "tool.corner_center_radius_mm", "tool.corner_center_height_mm",
                            "tool.bottom_angle_deg", "tool.side_angle_deg"}) {
      if (file.has(key)) throw file.reject(key, "is no part of this kind of cutter", "tool.kind says which it is");
    }
  }
  file.locate([&] { cutter.validate(); });
}

void require_engagement(const io::TomlFile& file, const cutting::CutTable& cut, const cutting::FlatEndMill& tool,
                        cutting::CutterKind kind, const char* direction_hint) {
  const std::string radial = cutting::radial_depth_of_cut;
  if (!cut.direction) file.require("cut.direction", direction_hint);
  if (*cut.direction != cutting::MillingDirection::slot) {
    if (!cut.radial_depth_m) file.require(radial);
    return;
  }
  const bool full = !cut.radial_depth_m || std::abs(*cut.radial_depth_m / tool.diameter_m - 1.0) < 1e-6;
  if (full || kind == cutting::CutterKind::ball_end) return;
  throw file.reject(file.has(radial) ? radial : "cut.stepover_mm",
                    fmt::format("contradicts cut.direction = \"slot\", whose width is the diameter, {:.6g} mm",
                                tool.diameter_m / units::mm),
                    "A narrower cut is \"up\" or \"down\"; of a slot leave the radial depth out");
}

void add_unusual(const cutting::CutAtHand& cut, std::vector<std::string>& notes) {
  for (const std::string& text :
       cutting::unusual_cut(cut.diameter_m, cut.feed_per_tooth_m, cut.cutting_speed_m_per_s)) {
    notes.push_back(std::string(io::warning_label) + text);
  }
}

}  // namespace robomill::process
