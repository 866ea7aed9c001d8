#include "robomill/cutting/files/cut_schema.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "robomill/io/text.hpp"

namespace robomill::cutting {
namespace {

using io::Json;
using io::key;
using io::Row;
using io::Schema;
using io::TomlFile;

constexpr Name<bool> cut_kinds[] = {{"milling", false}, {"drilling", true}};
constexpr Name<MillingDirection> directions[] = {
    {"up", MillingDirection::up}, {"down", MillingDirection::down}, {"slot", MillingDirection::slot}};

/// Words of the shop are answered with those of the table.
Row<CutTable> direction_row() {
  Row<CutTable> row = key("direction", &CutTable::direction, directions,
                          "or entry_deg and exit_deg; the neighbouring pass lies at -y (up) or +y (down), of a slot "
                          "there is none");
  row.read = [choose = row.read](TomlFile& file, const std::string& path, const Row<CutTable>& self, CutTable& out) {
    std::string word;
    if (file.text(path, word) && !value_in(directions, word)) {
      word = io::lowered(word);
      const char* const hint = word.starts_with("climb")          ? "Climb milling is \"down\" here"
                               : word.starts_with("conventional") ? "Conventional milling is \"up\" here"
                                                                  : "";
      throw file.reject(path, one_of(directions), hint);
    }
    choose(file, path, self, out);
  };
  return row;
}

/// The second name of the radial depth.
Row<CutTable> stepover_row() {
  Row<CutTable> row =
      key("stepover_mm", &CutTable::radial_depth_m, fmt::format("another name of {}", radial_depth_key)).above(0.0);
  row.member = "radial_depth_m";
  row.read = [number = row.read](TomlFile& file, const std::string& path, const Row<CutTable>& self, CutTable& out) {
    if (file.has(path) && out.radial_depth_m) {
      throw file.reject(path, fmt::format("must not stand beside {}", radial_depth_key),
                        "They are two names of one thing");
    }
    number(file, path, self, out);
  };
  return row;
}

/// A radius, which fills a curvature.
Row<CutTable> radius_row(const char* name, double CutTable::*curvature_per_m) {
  Row<CutTable> row =
      key(name, curvature_per_m, "radius of a curved surface, > 0 convex, < 0 concave; one of the two, ball ends only");
  row.read = [curvature_per_m](TomlFile& file, const std::string& path, const Row<CutTable>& self, CutTable& out) {
    double radius_m = 0.0;
    if (!file.number(path, self.member, self.factor, radius_m)) return;
    if (radius_m == 0.0) throw file.reject(path, "must not be 0", "> 0 is convex, < 0 concave; a plane has none");
    out.*curvature_per_m = 1.0 / radius_m;
  };
  row.write = [curvature_per_m](const CutTable& cut, const Row<CutTable>& self) {
    const double curvature = cut.*curvature_per_m;
    return curvature != 0.0 ? io::number(1.0 / curvature / self.factor) : Json();
  };
  return row;
}

constexpr Name<StockKind> stock_kinds[] = {{"box", StockKind::box},
                                           {"cylinder", StockKind::cylinder},
                                           {"turned", StockKind::turned},
                                           {"neighbours", StockKind::neighbours}};

/// A key of [stock], and the kind or the two kinds that have it.
struct StockKey {
  const char* name = nullptr;
  StockKind kind = StockKind::box, other_kind = StockKind::box;
  bool required = true;
  const char* hint = "";
};

}  // namespace

Cut CutTable::milled() const {
  return {.axial_depth_m = axial_depth_m.value_or(0.0),
          .radial_depth_m = radial_depth_m.value_or(0.0),
          .direction = direction.value_or(MillingDirection::up),
          .lead_rad = lead_rad,
          .tilt_rad = tilt_rad,
          .curvature_along_feed_per_m = curvature_along_feed_per_m,
          .curvature_across_feed_per_m = curvature_across_feed_per_m};
}

const Schema<CutTable>& cut_table() {
  static const Schema<CutTable> table(
      "cut", "how the cutter goes through the material",
      {key("kind", &CutTable::drilling, cut_kinds, "of drilling the teeth are the lips"), direction_row(),
       key("entry_deg", &CutTable::entry_rad, "angle at which a tooth enters; with exit_deg in place of direction"),
       key("exit_deg", &CutTable::exit_rad, "angle at which it leaves"),
       key(radial_depth_key, &CutTable::radial_depth_m, "step-over, from the neighbouring pass; a slot has none")
           .above(0.0)
           .slider(0.01, 50.0, 0.01),
       stepover_row().slider(0.01, 50.0, 0.01),
       key("axial_depth_mm", &CutTable::axial_depth_m, "of a chart where that varies another quantity")
           .above(0.0)
           .slider(0.01, 10.0, 0.01),
       key("feed_per_tooth_mm", &CutTable::feed_per_tooth_m, "of milling").at_least(0.0),
       key("feed_per_revolution_mm", &CutTable::feed_per_revolution_m, "of drilling").above(0.0),
       key("spindle_speed_rpm", &CutTable::spindle_speed_rad_per_s, "along a program in place of its own").above(0.0),
       key("feed_direction_deg", &CutTable::feed_direction_rad, "of the feed in the axes of the structure")
           .slider(-180.0, 180.0, 1.0),
       key("lead_deg", &CutTable::lead_rad, "of the tool's axis, about y of the feed").slider(-45.0, 45.0, 1.0),
       key("tilt_deg", &CutTable::tilt_rad, "the same, about x").slider(-45.0, 45.0, 1.0),
       radius_row("surface_radius_along_feed_mm", &CutTable::curvature_along_feed_per_m),
       radius_row("surface_radius_across_feed_mm", &CutTable::curvature_across_feed_per_m),
       key("force_on", &CutTable::force_on_workpiece, force_on_names, "the body on which the force is reported")});
  return table;
}

const Schema<StockTable>& stock_table() {
  static const Schema<StockTable> table(
      "stock", "the stock of a program",
      {key("kind", &StockTable::kind, stock_kinds,
           "without it a box is assumed; neighbours: no stock, a ball end cuts axial_depth_mm deep beside its "
           "neighbouring pass, on a plane or a cylinder"),
       key("min_mm", &StockTable::min_m, "corner of a box in the work frame, [x, y, z]").entries(3),
       key("max_mm", &StockTable::max_m, "the opposite corner").entries(3),
       key("center_mm", &StockTable::center_m, "[x, y] of the axis of a cylinder or a turned part, along z").entries(2),
       key("radius_mm", &StockTable::radius_m, "of a cylinder"), key("bottom_mm", &StockTable::bottom_m, "the same"),
       key("top_mm", &StockTable::top_m, "the same"),
       key("outline_radius_mm", &StockTable::outline_radius_m, "of a turned part: its outline from below to above")
           .as("outline_m"),
       key("outline_z_mm", &StockTable::outline_z_m, "its heights").as("outline_m"),
       key("dexel_mm", &StockTable::dexel_m, "distance of the rays").above(0.0)});
  return table;
}

std::optional<Stock> stock_of(const io::TomlFile& file, const StockTable& table) {
  using enum StockKind;
  static constexpr StockKey keys[] = {
      {"min_mm", box, box},
      {"max_mm", box, box},
      {"center_mm", cylinder, turned, false},
      {"radius_mm", cylinder, cylinder},
      {"bottom_mm", cylinder, cylinder},
      {"top_mm", cylinder, cylinder},
      {"outline_radius_mm", turned, turned, true, "Radii of the outline, from below to above"},
      {"outline_z_mm", turned, turned, true, "Their heights"}};
  for (const StockKey& one : keys) {
    const std::string path = std::string("stock.") + one.name;
    const bool takes_part = table.kind == one.kind || table.kind == one.other_kind;
    if (takes_part && one.required) file.require(path, one.hint);
    if (!takes_part && file.has(path)) {
      throw file.reject(path, "is no part of this kind of stock", "stock.kind says which it is");
    }
  }
  if (!table.kind || *table.kind == neighbours) return std::nullopt;
  if (table.outline_radius_m.size() != table.outline_z_m.size()) {
    throw file.reject("stock.outline_z_mm", "must have a height for each radius");
  }
  Stock out;
  out.shape = *table.kind == box        ? Stock::Shape::box
              : *table.kind == cylinder ? Stock::Shape::cylinder
                                        : Stock::Shape::turned;
  if (table.min_m) out.min_m = Eigen::Map<const Eigen::Vector3d>(table.min_m->data());
  if (table.max_m) out.max_m = Eigen::Map<const Eigen::Vector3d>(table.max_m->data());
  out.center_m = Eigen::Map<const Eigen::Vector2d>(table.center_m.data());
  out.radius_m = table.radius_m.value_or(0.0);
  out.bottom_m = table.bottom_m.value_or(0.0);
  out.top_m = table.top_m.value_or(0.0);
  for (std::size_t i = 0; i < table.outline_z_m.size(); ++i) {
    out.outline_m.emplace_back(table.outline_radius_m[i], table.outline_z_m[i]);
  }
  file.locate([&] { out.validate(); });
  return out;
}

}  // namespace robomill::cutting
