#include "robomill/robot/files/geometry_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/stl.hpp"
#include "robomill/robot/collision/body_names.hpp"
#include "robomill/robot/files/pose_toml.hpp"

namespace robomill::robot {
namespace {

using io::declared;
using io::Holds;
using io::key;
using io::of;
using io::Row;
using io::Schema;

/// A closed box between two corners.
io::TriangleMesh box_mesh(const Eigen::AlignedBox3d& box) {
  io::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices_m.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  // Corner i is at the upper end along x, y, z by its bits 0, 1, 2.
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

constexpr Name<double> stl_units[] = {{"mm", units::mm}, {"m", 1.0}, {"inch", units::inch}};

/// A body as the file has it: an STL or a box.
struct BodyTable {
  std::string name = {};
  std::filesystem::path file = {};
  std::optional<Eigen::Vector3d> box_from_m = {}, box_to_m = {};
  Placement place = {};
};

/// One of a link: a body, or a line with a diameter.
struct LinkTable {
  int link = 0;
  BodyTable body = {};
  std::optional<Eigen::Vector3d> from_m = {}, to_m = {};
  std::optional<double> diameter_m = {};
};

/// What a table of `spindle` may be.
struct SpindleTable {
  ToolSection section = {};
  BodyTable body = {};
};

std::vector<Row<BodyTable>> body_rows() {
  std::vector<Row<BodyTable>> rows = {
      key("name", &BodyTable::name, "without it the file's stem or box, of an arm's link its number"),
      key("file", &BodyTable::file, "an STL"),
      key("box_from_mm", &BodyTable::box_from_m, "corner of a box, in place of a file").entries(3),
      key("box_to_mm", &BodyTable::box_to_m, "the corner opposite to it").entries(3)};
  add_placement(rows, &BodyTable::place, "", "the body");
  return rows;
}

const Schema<BodyTable>& body_table() {
  static const Schema<BodyTable> table("body", "a file or a box", body_rows());
  return table;
}

const Schema<LinkTable>& link_table() {
  static const Schema<LinkTable> table(
      "link_body", "a file, a box or a cylinder with round ends that moves with a link", [] {
        std::vector<Row<LinkTable>> rows = {
            key("link", &LinkTable::link, "0 for the base, else the joint that moves it, from 1")
                .required("0 for the base, else the joint that moves it, from 1")
                .at_least(0.0)};
        for (Row<BodyTable>& row : body_rows()) rows.push_back(of(&LinkTable::body, std::move(row)));
        io::add_rows<LinkTable>(
            rows, {key("from_mm", &LinkTable::from_m, "one end of a cylinder's line").entries(3),
                   key("to_mm", &LinkTable::to_m, "its other end").entries(3),
                   key("diameter_mm", &LinkTable::diameter_m, "of the cylinder").as("capsule.diameter_m").above(0.0)});
        return rows;
      }());
  return table;
}

std::vector<Row<ToolSection>> section_rows() {
  return {
      key("length_mm", &ToolSection::length_m, "along the tool's axis").required().above(0.0),
      key("diameter_mm", &ToolSection::lower_diameter_m, "at its end towards the tip")
          .as("lower_diameter_m")
          .required("At its end towards the tip")
          .at_least(0.0),
      key("upper_diameter_mm", &ToolSection::upper_diameter_m, "at its other end, where it is a cone").at_least(0.0)};
}

const Schema<ToolSection>& section_table() {
  static const Schema<ToolSection> table("tool_section", "a cylinder or a cone about the tool's axis", section_rows());
  return table;
}

const Schema<SpindleTable>& spindle_table() {
  static const Schema<SpindleTable> table("spindle_body",
                                          "a section above the holder, or a file or box in the flange frame", [] {
                                            std::vector<Row<SpindleTable>> rows;
                                            for (Row<ToolSection>& row : section_rows()) {
                                              row.key.required = false;
                                              rows.push_back(of(&SpindleTable::section, std::move(row)));
                                            }
                                            for (Row<BodyTable>& row : body_rows())
                                              rows.push_back(of(&SpindleTable::body, std::move(row)));
                                            return rows;
                                          }());
  return table;
}

using NamePair = std::pair<std::string, std::string>;

const Schema<NamePair>& ignored_table() {
  constexpr const char* form = "Two bodies by name: { first = \"link 4\", second = \"spindle\" }";
  static const Schema<NamePair> table("ignored_pair", "two bodies that are not checked against each other",
                                      {key("first", &NamePair::first, "name of a body").required(form),
                                       key("second", &NamePair::second, "name of another").required(form)});
  return table;
}

/// [geometry] while it is read.
struct GeometryReading {
  CellGeometry out = {};
  Eigen::Isometry3d from_flange = Eigen::Isometry3d::Identity();  ///< of what the file has in the flange frame
  std::vector<Eigen::Isometry3d> link_frames = {};
  double stl_unit_m = units::mm;

  /// Bodies that are files, named one after the other, or tables with a file or a box each.
  std::vector<Body> bodies(io::TomlFile& file, const std::string& path) {
    std::vector<Body> read;
    if (!file.has(path)) return read;
    if (!is_table(file, path + "[0]") && !is_table(file, path)) {
      std::vector<std::filesystem::path> paths;
      file.paths(path, paths);
      for (const std::filesystem::path& stl : paths) {
        read.push_back({.name = unique(stl.stem().string()), .mesh = io::read_stl(stl, stl_unit_m)});
      }
      return read;
    }
    for (const std::string& row : rows(file, path)) {
      BodyTable given;
      body_table().read(file, row, given);
      Body& body = read.emplace_back(mesh_of(file, row, given));
      move(body.mesh, given.place.pose());
    }
    return read;
  }

  void arm(io::TomlFile& file, const std::string& path) {
    const std::size_t count = file.tables(path);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string row = fmt::format("{}[{}]", path, i);
      LinkTable given;
      link_table().read(file, row, given, fmt::format("arm[{}].", i + 1));
      const auto link = static_cast<std::size_t>(given.link);
      if (link >= link_frames.size()) {
        throw file.reject(row + ".link", fmt::format("must be 0 for the base, or 1 to {}", link_frames.size() - 1));
      }
      LinkBody body{.link = given.link, .pose = link_frames[link] * given.body.place.pose()};
      const std::string usual = fmt::format("link {}", link);
      if (given.diameter_m || given.from_m || given.to_m) {
        body.capsule = capsule(file, row, given);
        body.name = name_of(file, row, given.body, usual);
      } else {
        Body read = mesh_of(file, row, given.body, usual);
        body.name = std::move(read.name);
        body.mesh = std::move(read.mesh);
      }
      out.arm.push_back(std::move(body));
    }
  }

  void holder(io::TomlFile& file, const std::string& path) {
    for (const std::string& row : rows(file, path))
      out.tool.holder.push_back(section(file, row, "holder", out.tool.holder));
  }

  void spindle(io::TomlFile& file, const std::string& path) {
    if (!file.has(path)) return;
    const std::vector<std::string> all = rows(file, path);
    const auto is_section = [&](const std::string& row) { return file.has(row + ".length_mm"); };
    if (std::ranges::any_of(all, is_section)) names_.insert(spindle_name);  // which all sections have together
    for (const std::string& row : all) {
      if (is_section(row)) {
        out.tool.spindle.push_back(section(file, row, "spindle", out.tool.spindle));
        continue;
      }
      BodyTable given;
      body_table().read(file, row, given);
      Body& body = out.tool.spindle_bodies.emplace_back(mesh_of(file, row, given, spindle_name));
      move(body.mesh, given.place.pose());
      move(body.mesh, from_flange);
    }
  }

  void ignored(io::TomlFile& file, const std::string& path) {
    const std::size_t count = file.tables(path);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string row = fmt::format("{}[{}]", path, i);
      NamePair& pair = out.ignored.emplace_back();
      ignored_table().read(file, row, pair);
      for (const auto& [key, name] : {std::pair(".first", &pair.first), std::pair(".second", &pair.second)}) {
        if (!names_.contains(*name)) throw file.reject(row + key, "must name a body", "There are " + listed());
      }
    }
  }

 private:
  static bool is_table(const io::TomlFile& file, const std::string& row) {
    return std::ranges::any_of(std::array{".file", ".box_from_mm", ".box_to_mm", ".length_mm", ".diameter_mm", ".name"},
                               [&](const char* name) { return file.has(row + name); });
  }
  /// The path of each table: of one table, or of a list of them.
  static std::vector<std::string> rows(const io::TomlFile& file, const std::string& path) {
    if (is_table(file, path)) return {path};
    std::vector<std::string> paths;
    const std::size_t count = file.tables(path);
    for (std::size_t i = 0; i < count; ++i) paths.push_back(fmt::format("{}[{}]", path, i));
    if (paths.empty()) throw file.reject(path, "must hold at least one table");
    return paths;
  }

  std::string unique(const std::string& name) {
    std::string numbered = name;
    for (int k = 2; !names_.insert(numbered).second; ++k) numbered = fmt::format("{} ({})", name, k);
    return numbered;
  }
  std::string name_of(const io::TomlFile& file, const std::string& row, const BodyTable& given,
                      const std::string& usual) {
    if (!file.has(row + ".name")) return unique(usual);
    if (given.name.empty() || !names_.insert(given.name).second) {
      throw file.reject(row + ".name", "must be a name that no other body has");
    }
    return given.name;
  }
  [[nodiscard]] std::string listed() const {
    std::string list;
    for (const std::string& name : names_) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", name);
    return list;
  }

  Body mesh_of(const io::TomlFile& file, const std::string& row, const BodyTable& given,
               const std::string& usual = {}) {
    if (!given.box_from_m && !given.box_to_m) {
      file.require(row + ".file", "An STL; or box_from_mm and box_to_mm, two corners of a box");
      return {.name = name_of(file, row, given, usual.empty() ? given.file.stem().string() : usual),
              .mesh = io::read_stl(given.file, stl_unit_m)};
    }
    if (!given.file.empty()) throw file.reject(row + ".file", "must not stand beside box_from_mm");
    for (const char* key : {".box_from_mm", ".box_to_mm"}) file.require(row + key, "Two opposite corners of a box");
    const Eigen::AlignedBox3d box(given.box_from_m->cwiseMin(*given.box_to_m),
                                  given.box_from_m->cwiseMax(*given.box_to_m));
    if (!(box.sizes().minCoeff() > 0.0)) {
      throw file.reject(row + ".box_to_mm", "must differ from box_from_mm along x, y and z");
    }
    return {.name = name_of(file, row, given, usual.empty() ? "box" : usual), .mesh = box_mesh(box)};
  }

  static Capsule capsule(const io::TomlFile& file, const std::string& row, const LinkTable& given) {
    for (const char* other : {".file", ".box_from_mm", ".box_to_mm"}) {
      if (file.has(row + other)) throw file.reject(row + other, "must not stand beside diameter_mm");
    }
    for (const char* key : {".from_mm", ".to_mm", ".diameter_mm"}) {
      file.require(row + key, "A link is a file, or a line from … to with diameter_mm");
    }
    return {.from_m = *given.from_m, .to_m = *given.to_m, .diameter_m = *given.diameter_m};
  }

  static void move(io::TriangleMesh& mesh, const Eigen::Isometry3d& pose) {
    for (Eigen::Vector3d& vertex : mesh.vertices_m) vertex = pose * vertex;
  }

  static ToolSection section(io::TomlFile& file, const std::string& row, const char* list,
                             const std::vector<ToolSection>& before) {
    ToolSection read;
    section_table().read(file, row, read, fmt::format("tool.{}[{}].", list, before.size() + 1));
    if (!file.has(row + ".upper_diameter_mm")) read.upper_diameter_m = read.lower_diameter_m;
    return read;
  }

  std::set<std::string> names_ = {cutter_name, shank_name, holder_name};  // of bodies so far
};

/// A key whose tables, or files, code reads.
/// @param code  (GeometryReading&, io::TomlFile&, path of the key)
template <class U, class F>
Row<GeometryReading> bodies_key(const std::string& name, const Schema<U>& table, const std::string& meaning, F code) {
  Row<GeometryReading> row = declared<GeometryReading>(name, Holds::table, meaning, 1);
  row.key.table = &table.info();
  return row.read_by([code](io::TomlFile& file, const std::string& path, GeometryReading& reading) {
    std::invoke(code, reading, file, path);
  });
}

/// The same, one or more that stand still.
Row<GeometryReading> still_key(const std::string& name, std::vector<Body> CellGeometry::*list,
                               const std::string& meaning) {
  return bodies_key(name, body_table(), meaning,
                    [list](GeometryReading& reading, io::TomlFile& file, const std::string& path) {
                      reading.out.*list = reading.bodies(file, path);
                    })
      .or_one()
      .or_also(Holds::path);
}

Row<GeometryReading> of_tool(Row<ToolGeometry> row) {
  row.member = "tool." + row.member;
  return of(&GeometryReading::out, of(&CellGeometry::tool, std::move(row)));
}

const Schema<GeometryReading>& reading_table() {
  using Reading = GeometryReading;
  static const Schema<Reading> table(
      "geometry", "the fixed and the moving bodies of a serial arm's cell, for collisions",
      {key("stl_unit", &Reading::stl_unit_m, stl_units, "of STL files"),
       of_tool(key("stickout_mm", &ToolGeometry::stickout_m, "tip to holder")
                   .required("From the tip to the holder; without it nobody knows where the holder stands")
                   .above(0.0)),
       of_tool(key("shank_diameter_mm", &ToolGeometry::shank_diameter_m,
                   "without it that of the cutter at the top of its edges")
                   .above(0.0, "Leave it out where it is the cutter's")),
       bodies_key("holder", section_table(), "from the stickout upwards", &Reading::holder)
           .or_one()
           .required("holder = [{ length_mm = 50, diameter_mm = 40 }, …], from the stickout upwards"),
       bodies_key("spindle", spindle_table(), "above the holder", &Reading::spindle).or_one(),
       still_key("part", &CellGeometry::part,
                 "the finished part, in the work frame; without it gouges are not checked"),
       still_key("fixtures", &CellGeometry::fixtures, "in the work frame"),
       still_key("cell", &CellGeometry::cell, "in the robot's base frame"),
       bodies_key("arm", link_table(), "of the arm, in the frame after DH row k, or of the URDF link", &Reading::arm),
       of(&Reading::out, key("clearance_mm", &CellGeometry::clearance_m, "of all bodies but the edges")
                             .required("The least distance of all but the cutter's edges, 2 say")
                             .at_least(0.0)),
       of(&Reading::out,
          key("gouge_tolerance_mm", &CellGeometry::gouge_tolerance_m,
              "how deep the edges may be in the part, required with it; it must cover the mesh's own error")
              .at_least(0.0)),
       of(&Reading::out,
          key("self_collision", &CellGeometry::self_collision, "links of the arm against each other too")),
       bodies_key("ignore", ignored_table(), "pairs that are not checked", &Reading::ignored)});
  return table;
}

/// Checks all but the outline of the edges, which is not here.
void validate_without_edges(const io::TomlFile& file, const Cell& cell, CellGeometry& geometry) {
  file.locate([&] {
    require_positive("tool.stickout_m", geometry.tool.stickout_m, "m");
    const double any_m = units::mm;
    geometry.tool.edges = {{.height_m = 0.0, .radius_m = any_m},
                           {.height_m = geometry.tool.stickout_m, .radius_m = any_m}};
    geometry.validate(cell);
  });
  geometry.tool.edges.clear();
}

}  // namespace

const io::TableInfo& geometry_table() {
  return reading_table().info();
}

std::optional<CellGeometry> read_geometry(io::TomlFile& file, const Cell& cell, const Eigen::Isometry3d& mount,
                                          const std::vector<Eigen::Isometry3d>& link_frames,
                                          std::vector<std::string>& notes) {
  if (!file.has("geometry")) return std::nullopt;
  GeometryReading reading;
  reading.from_flange = mount.inverse();
  reading.link_frames = link_frames;
  reading_table().read(file, "geometry", reading);
  CellGeometry& out = reading.out;
  if (!out.part.empty()) {
    file.require("geometry.gouge_tolerance_mm", "How deep the edges may stand in the finished part, 0.05 say");
  }
  validate_without_edges(file, cell, out);
  if (out.part.empty()) notes.emplace_back("[geometry] has no part: gouges are not checked");
  if (out.arm.empty()) notes.emplace_back("[geometry] has no arm: collisions of its links are not checked");
  return std::move(out);
}

}  // namespace robomill::robot
