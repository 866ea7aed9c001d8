#include "robomill/robot/files/geometry_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/stl.hpp"
#include "robomill/robot/collision/body_names.hpp"
#include "robomill/robot/files/pose_toml.hpp"

namespace robomill::robot {
namespace {

/// A closed box between two corners.
io::TriangleMesh box_mesh(const Eigen::AlignedBox3d& box) {
  io::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices_m.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  // Corner i is at the upper end along x, y, z by its bits 0, 1, 2.
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Reads the rows of [geometry].
class GeometryReader {
 public:
  explicit GeometryReader(io::TomlFile& file) : file_(file), names_{cutter_name, shank_name, holder_name} {
    file_.choice<double>("geometry.stl_unit", {{"mm", units::mm}, {"m", 1.0}, {"inch", units::inch}}, stl_unit_m_);
  }

  /// Bodies that are files, named one after the other, or tables with a file or a box each.
  std::vector<Body> bodies(const std::string& key) {
    std::vector<Body> out;
    if (!file_.has(key)) return out;
    if (!is_table(key + "[0].") && !is_table(key + ".")) {
      std::vector<std::filesystem::path> paths;
      file_.paths(key, paths);
      for (const std::filesystem::path& path : paths) {
        out.push_back({.name = unique(path.stem().string()), .mesh = io::read_stl(path, stl_unit_m_)});
      }
      return out;
    }
    for (const std::string& row : rows(key)) {
      Body body = mesh_of(row);
      move(body.mesh, row);
      out.push_back(std::move(body));
    }
    return out;
  }

  std::vector<LinkBody> arm(const std::vector<Eigen::Isometry3d>& link_frames) {
    std::vector<LinkBody> out;
    const std::size_t count = file_.tables("geometry.arm");
    for (std::size_t i = 0; i < count; ++i) {
      const std::string row = fmt::format("geometry.arm[{}].", i), member = fmt::format("arm[{}].", i + 1);
      LinkBody body;
      file_.require(row + "link", "0 for the base, else the joint that moves it, from 1");
      file_.integer(row + "link", member + "link", body.link);
      if (body.link < 0 || static_cast<std::size_t>(body.link) >= link_frames.size()) {
        throw file_.reject(row + "link", fmt::format("must be 0 for the base, or 1 to {}", link_frames.size() - 1));
      }
      const std::string usual = fmt::format("link {}", body.link);
      if (file_.has(row + "diameter_mm")) {
        body.capsule = capsule(row, member);
        body.name = name_of(row, usual);
      } else {
        Body read = mesh_of(row, usual);
        body.name = std::move(read.name);
        body.mesh = std::move(read.mesh);
      }
      body.pose = link_frames[static_cast<std::size_t>(body.link)] * pose_of(row);
      out.push_back(std::move(body));
    }
    return out;
  }

  void holder(ToolGeometry& tool) {
    file_.require("geometry.stickout_mm",
                  "From the tip to the holder; without it nobody knows where the holder stands");
    file_.require("geometry.holder", "holder = [{ length_mm = 50, diameter_mm = 40 }, …], from the stickout upwards");
    file_.number("geometry.stickout_mm", "tool.stickout_m", units::mm, tool.stickout_m);
    file_.number("geometry.shank_diameter_mm", "tool.shank_diameter_m", units::mm, tool.shank_diameter_m);
    if (file_.has("geometry.shank_diameter_mm") && !(tool.shank_diameter_m > 0.0)) {
      throw file_.reject("geometry.shank_diameter_mm", "must be > 0", "Leave it out where it is the cutter's");
    }
    for (const std::string& row : rows("geometry.holder")) tool.holder.push_back(section(row, "holder", tool.holder));
  }

  /// @param mount  the spindle frame in the flange frame, in which the file speaks
  void spindle(ToolGeometry& tool, const Eigen::Isometry3d& mount) {
    const Eigen::Isometry3d from_flange = mount.inverse();
    if (!file_.has("geometry.spindle")) return;
    const std::vector<std::string> all = rows("geometry.spindle");
    const auto is_section = [&](const std::string& row) { return file_.has(row + "length_mm"); };
    if (std::ranges::any_of(all, is_section)) names_.insert(spindle_name);  // which all sections have together
    for (const std::string& row : all) {
      if (is_section(row)) {
        tool.spindle.push_back(section(row, "spindle", tool.spindle));
      } else {
        Body body = mesh_of(row, spindle_name);
        move(body.mesh, row);
        for (Eigen::Vector3d& vertex : body.mesh.vertices_m) vertex = from_flange * vertex;
        tool.spindle_bodies.push_back(std::move(body));
      }
    }
  }

  std::vector<std::pair<std::string, std::string>> ignored() {
    std::vector<std::pair<std::string, std::string>> out;
    const std::size_t count = file_.tables("geometry.ignore");
    for (std::size_t i = 0; i < count; ++i) {
      const std::string row = fmt::format("geometry.ignore[{}].", i);
      std::pair<std::string, std::string>& pair = out.emplace_back();
      const auto name = [&](const char* which, std::string& value) {
        file_.require(row + which, "Two bodies by name: { first = \"link 4\", second = \"spindle\" }");
        file_.text(row + which, value);
        if (!names_.contains(value)) throw file_.reject(row + which, "must name a body", "There are " + listed());
      };
      name("first", pair.first);
      name("second", pair.second);
    }
    return out;
  }

 private:
  bool is_table(const std::string& row) {
    return std::ranges::any_of(std::array{"file", "box_from_mm", "box_to_mm", "length_mm", "diameter_mm", "name"},
                               [&](const char* name) { return file_.has(row + name); });
  }
  /// What stands before the keys of each table: of one table, or of a list of them.
  std::vector<std::string> rows(const std::string& key) {
    if (is_table(key + ".")) return {key + "."};
    std::vector<std::string> out;
    const std::size_t count = file_.tables(key);
    for (std::size_t i = 0; i < count; ++i) out.push_back(fmt::format("{}[{}].", key, i));
    if (out.empty()) throw file_.reject(key, "must hold at least one table");
    return out;
  }

  std::string unique(const std::string& name) {
    std::string out = name;
    for (int k = 2; !names_.insert(out).second; ++k) out = fmt::format("{} ({})", name, k);
    return out;
  }
  std::string name_of(const std::string& row, const std::string& usual) {
    std::string name;
    if (!file_.text(row + "name", name)) return unique(usual);
    if (name.empty() || !names_.insert(name).second) {
      throw file_.reject(row + "name", "must be a name that no other body has");
    }
    return name;
  }
  [[nodiscard]] std::string listed() const {
    std::string out;
    for (const std::string& name : names_) out += fmt::format("{}\"{}\"", out.empty() ? "" : ", ", name);
    return out;
  }

  Body mesh_of(const std::string& row, const std::string& usual = {}) {
    const bool from_file = file_.has(row + "file"), from_box = file_.has(row + "box_from_mm");
    if (from_file && from_box) throw file_.reject(row + "file", "must not stand beside box_from_mm");
    Body out;
    if (from_box) {
      out.name = name_of(row, usual.empty() ? "box" : usual);
      out.mesh = box_mesh(box(row));
      return out;
    }
    file_.require(row + "file", "An STL; or box_from_mm and box_to_mm, two corners of a box");
    std::filesystem::path path;
    file_.path(row + "file", path);
    out.name = name_of(row, usual.empty() ? path.stem().string() : usual);
    out.mesh = io::read_stl(path, stl_unit_m_);
    return out;
  }

  Eigen::AlignedBox3d box(const std::string& row) {
    file_.require(row + "box_to_mm", "The corner opposite to box_from_mm");
    const Eigen::Vector3d from_m = *read_vector(file_, row + "box_from_mm", "box_from_m", units::mm),
                          to_m = *read_vector(file_, row + "box_to_mm", "box_to_m", units::mm);
    const Eigen::AlignedBox3d out(from_m.cwiseMin(to_m), from_m.cwiseMax(to_m));
    if (!(out.sizes().minCoeff() > 0.0)) {
      throw file_.reject(row + "box_to_mm", "must differ from box_from_mm along x, y and z");
    }
    return out;
  }

  Capsule capsule(const std::string& row, const std::string& member) {
    if (file_.has(row + "file")) throw file_.reject(row + "file", "must not stand beside diameter_mm");
    for (const char* end : {"from_mm", "to_mm"}) {
      file_.require(row + end, "A link is a file, or a line from … to with diameter_mm");
    }
    Capsule out{.from_m = *read_vector(file_, row + "from_mm", member + "from_m", units::mm),
                .to_m = *read_vector(file_, row + "to_mm", member + "to_m", units::mm)};
    file_.number(row + "diameter_mm", member + "capsule.diameter_m", units::mm, out.diameter_m);
    return out;
  }

  Eigen::Isometry3d pose_of(const std::string& row) {
    return read_pose(file_, row + "origin_mm", row + "rotation_deg");
  }
  void move(io::TriangleMesh& mesh, const std::string& row) {
    const Eigen::Isometry3d pose = pose_of(row);
    for (Eigen::Vector3d& vertex : mesh.vertices_m) vertex = pose * vertex;
  }

  ToolSection section(const std::string& row, const char* list, const std::vector<ToolSection>& before) {
    const std::string member = fmt::format("tool.{}[{}].", list, before.size() + 1);
    file_.require(row + "length_mm");
    file_.require(row + "diameter_mm", "At its end towards the tip");
    ToolSection out;
    file_.number(row + "length_mm", member + "length_m", units::mm, out.length_m);
    file_.number(row + "diameter_mm", member + "lower_diameter_m", units::mm, out.lower_diameter_m);
    out.upper_diameter_m = out.lower_diameter_m;
    file_.number(row + "upper_diameter_mm", member + "upper_diameter_m", units::mm, out.upper_diameter_m);
    return out;
  }

  io::TomlFile& file_;
  double stl_unit_m_ = units::mm;
  std::set<std::string> names_;  // of bodies so far
};

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

std::optional<CellGeometry> read_geometry(io::TomlFile& file, const Cell& cell, const Eigen::Isometry3d& mount,
                                          const std::vector<Eigen::Isometry3d>& link_frames,
                                          std::vector<std::string>& notes) {
  if (!file.has("geometry")) return std::nullopt;
  CellGeometry out;
  GeometryReader reader(file);
  reader.holder(out.tool);
  reader.spindle(out.tool, mount);
  out.part = reader.bodies("geometry.part");
  out.fixtures = reader.bodies("geometry.fixtures");
  out.cell = reader.bodies("geometry.cell");
  out.arm = reader.arm(link_frames);
  file.require("geometry.clearance_mm", "The least distance of all but the cutter's edges, 2 say");
  file.number("geometry.clearance_mm", "clearance_m", units::mm, out.clearance_m);
  if (!out.part.empty()) {
    file.require("geometry.gouge_tolerance_mm", "How deep the edges may stand in the finished part, 0.05 say");
  }
  file.number("geometry.gouge_tolerance_mm", "gouge_tolerance_m", units::mm, out.gouge_tolerance_m);
  file.boolean("geometry.self_collision", out.self_collision);
  out.ignored = reader.ignored();
  validate_without_edges(file, cell, out);
  if (out.part.empty()) notes.emplace_back("[geometry] has no part: gouges are not checked");
  if (out.arm.empty()) notes.emplace_back("[geometry] has no arm: collisions of its links are not checked");
  return out;
}

}  // namespace robomill::robot
