#include "robomill/path/files/motion_json.hpp"

#include <array>
#include <cstddef>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/signal/files/bands_json.hpp"

namespace robomill::path {
namespace {

using io::key;
using io::Row;
using io::Schema;
using io::Use;
using signal::Band;
using signal::band_key;
using signal::band_table;
using signal::BandView;

/// A column a point; x, y and, of three rows, z.
template <class Places>
std::vector<Row<Places>> places_keys() {
  constexpr std::array<const char*, 3> names = {"x_mm", "y_mm", "z_mm"};
  std::vector<Row<Places>> rows;
  for (Eigen::Index axis = 0; axis < Places::RowsAtCompileTime; ++axis) {
    rows.push_back(key(
                       names.at(static_cast<std::size_t>(axis)),
                       [axis](const Places& places) { return Eigen::VectorXd(places.row(axis).transpose()); },
                       "of each point")
                       .exact());
  }
  return rows;
}

const Schema<Eigen::Matrix3Xd>& path_table() {
  static const Schema<Eigen::Matrix3Xd> table("places", "one point after another in the work frame",
                                              places_keys<Eigen::Matrix3Xd>(), Use::written);
  return table;
}

const Schema<Eigen::Matrix2Xd>& flat_path_table() {
  static const Schema<Eigen::Matrix2Xd> table("flat_places",
                                              "in the plane of a corner: x along the way, y to the inside",
                                              places_keys<Eigen::Matrix2Xd>(), Use::written);
  return table;
}

const Schema<Motion>& moved_tip_table() {
  static const Schema<Motion> table(
      "tip_path", "the tip's path in the work frame",
      [] {
        std::vector<Row<Motion>> rows = io::keys_of<Motion>(
            path_table().rows(), [](const Motion& motion) -> const Eigen::Matrix3Xd& { return motion.tip_m; });
        rows.push_back(key("speed_mm_per_s", &Motion::tip_speed_at_m_per_s, "of the tip at each point").exact());
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<JointMotion>& moved_joint_table() {
  const auto unit = [](const JointMotion& joint) { return joint.prismatic ? units::mm : units::deg; };
  const auto band = [unit](Band JointMotion::*member) {
    return [unit, member](const JointMotion& joint) { return BandView{&(joint.*member), unit(joint)}; };
  };
  static const Schema<JointMotion> table(
      "joint_motion", "what one joint does",
      {key(
           "unit", [](const JointMotion& joint) { return joint.prismatic ? "mm" : "deg"; }, "of the bands")
           .words({"deg", "mm"}),
       key("velocity", band(&JointMotion::velocity), band_table(), "over time"),
       key("acceleration", band(&JointMotion::acceleration), band_table(), "over time"),
       key("jerk", band(&JointMotion::jerk), band_table(), "over time"),
       key(
           "tracking_error",
           [band](const JointMotion& joint) {
             return joint.tracking_error.low.size() > 0 ? std::optional(band(&JointMotion::tracking_error)(joint))
                                                        : std::nullopt;
           },
           band_table(), "of its drive; none: no drive is modelled")
           .nullable()},
      Use::written);
  return table;
}

const Schema<Motion>& moved_table() {
  static const Schema<Motion> table(
      "motion_of_method", "a method's trajectory over time",
      {key("run_s", &Motion::run_s, "of one run of every band"),
       band_key("tip_speed_mm_per_s", &Motion::tip_speed_m_per_s, "of the tip"),
       band_key("axis_speed_deg_per_s", &Motion::axis_speed_rad_per_s, "of the tool's axis"),
       key("joints", &Motion::joints, moved_joint_table(), "one after the other"),
       key(
           "tip", [](const Motion& motion) { return &motion; }, moved_tip_table(), "some of its points in their order"),
       key("corner_paths", &Motion::corner_paths_m, flat_path_table(), "of the tip, one a corner")},
      Use::written);
  return table;
}

const Schema<ProgramCorner>& corner_table() {
  static const Schema<ProgramCorner> table(
      "corner", "a corner of the program that is worth a close look",
      {key(
           "block", [](const ProgramCorner& corner) { return corner.block + 1; }, "of the move into it, from 1"),
       key("line", &ProgramCorner::line, "of the program"), key("turn_deg", &ProgramCorner::turn_rad, "of the path"),
       key("radius_mm", &ProgramCorner::radius_m, "half the view's width"),
       key("program", &ProgramCorner::vertices_m, flat_path_table(), "the moves near it")},
      Use::written);
  return table;
}

}  // namespace

const Schema<MotionView>& motion_table() {
  static const Schema<MotionView> table(
      "motion", "what is recorded of a smoothed program for the page alone, of bounded length",
      {key(
           "program", [](const MotionView& view) { return &view.outline->path_m; }, path_table(), "its path"),
       key(
           "corners", [](const MotionView& view) { return view.outline->corners; }, corner_table(),
           "the sharpest of the program"),
       key(
           "motions", [](const MotionView& view) { return *view.motions; }, moved_table(),
           "one a method, in the order of smooth.json")},
      Use::written, 1);
  return table;
}

std::string motion_json(const ProgramOutline& outline, const std::vector<Motion>& motions) {
  for (const Motion& motion : motions) {
    if (motion.corner_paths_m.size() != outline.corners.size()) {
      throw InvalidInput("motions.corner_paths_m", "must hold one path for each corner of the outline");
    }
  }
  return io::dump(motion_table().write({.outline = &outline, .motions = &motions}));
}

}  // namespace robomill::path
