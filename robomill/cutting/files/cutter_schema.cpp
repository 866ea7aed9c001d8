#include "robomill/cutting/files/cutter_schema.hpp"

#include <utility>

namespace robomill::cutting {
namespace {

using io::declared;
using io::Json;
using io::key;
using io::of;
using io::Row;
using io::Schema;

constexpr Name<CutterKind> cutter_kinds[] = {{"flat-end", CutterKind::flat_end},
                                             {"ball-end", CutterKind::ball_end},
                                             {"bull-nose", CutterKind::bull_nose},
                                             {"general", CutterKind::general}};

/// One helix angle, or one a tooth.
Row<FlatEndMill> helix_row() {
  Row<FlatEndMill> row = key(helix_key, &FlatEndMill::tooth_helix_rad, "helix angle of the edges; a list: one a tooth");
  row.key.or_one = true;
  row.member = "tooth_helix_rad";
  row.read = [](io::TomlFile& file, const std::string& path, const Row<FlatEndMill>& self, FlatEndMill& mill) {
    if (file.is_number(path)) {
      file.number(path, "helix_rad", self.factor, mill.helix_rad);
    } else {
      file.numbers(path, self.member, self.factor, mill.tooth_helix_rad);
    }
  };
  row.write = [](const FlatEndMill& mill, const Row<FlatEndMill>& self) {
    return mill.tooth_helix_rad.empty() ? io::number(mill.helix_rad / self.factor)
                                        : io::detail::write_value(mill.tooth_helix_rad, {self.factor, false});
  };
  return row;
}

}  // namespace

const Schema<Cutter>& cutter_table() {
  static const Schema<Cutter> table(
      "tool", "the milling cutter",
      {key("kind", &Cutter::kind, cutter_kinds, "shape of the cutter"),
       of(&Cutter::mill,
          key("teeth", &FlatEndMill::teeth, "cutting edges").at_least(1.0).at_most(100.0).slider(1.0, 20.0, 1.0)),
       of(&Cutter::mill,
          key("diameter_mm", &FlatEndMill::diameter_m, "over the cutting edges").above(0.0).slider(1.0, 50.0, 0.1)),
       of(&Cutter::mill, helix_row().slider(0.0, 60.0, 1.0)),
       of(&Cutter::mill,
          key("pitch_deg", &FlatEndMill::pitch_rad, "from tooth to tooth, where the teeth are unequally spaced")),
       of(&Cutter::mill,
          key("runout_um", &FlatEndMill::runout_m, "offset of the cutter's axis from the spindle's; needs the feed")
              .at_least(0.0)),
       of(&Cutter::mill, key("runout_angle_deg", &FlatEndMill::runout_angle_rad,
                             "of that offset, clockwise from where the first tooth stands at the tip")),
       key("cutting_height_mm", &Cutter::cutting_height_m, "how far above the tip the edges reach; 0: two diameters")
           .at_least(0.0),
       key("corner_radius_mm", &Cutter::corner_radius_m, "of a bull nose or a general cutter").at_least(0.0),
       key("corner_center_radius_mm", &Cutter::corner_center_radius_m,
           "general cutter: centre of the corner from the axis"),
       key("corner_center_height_mm", &Cutter::corner_center_height_m,
           "general cutter: centre of the corner above the tip"),
       key("bottom_angle_deg", &Cutter::bottom_angle_rad,
           "general cutter: of the bottom above the plane that it stands on"),
       key("side_angle_deg", &Cutter::side_angle_rad,
           "general cutter: of the side from the axis; above 0 it widens upwards"),
       declared<Cutter>("point_angle_deg", io::Holds::number, "of a drill, whose lips are the teeth; 118")});
  return table;
}

const Schema<ProcessDamping>& process_damping_table() {
  static const Schema<ProcessDamping> table(
      "process_damping", "a worn land under the edge that is pressed into the wave",
      {key("indentation_n_per_mm3", &ProcessDamping::indentation_n_per_m3, "specific indentation force of the material")
           .at_least(0.0),
       key("wear_land_mm", &ProcessDamping::wear_land_m, "length of the worn land").at_least(0.0),
       key("friction", &ProcessDamping::friction, "of the land on the material").at_least(0.0)});
  return table;
}

const Schema<SpeedVariation>& speed_variation_table() {
  static const Schema<SpeedVariation> table(
      "speed_variation", "the spindle speed swings about its mean",
      {key("amplitude_ratio", &SpeedVariation::amplitude_ratio, "share of the mean").at_least(0.0).at_most(0.9),
       key("frequency_ratio", &SpeedVariation::frequency_ratio, "frequency over that of the rotation").at_least(0.0)});
  return table;
}

}  // namespace robomill::cutting
