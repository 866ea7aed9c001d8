#include <array>
#include <string>
#include <utility>
#include <vector>

#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/stl.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/files/fit_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/files/machine_json.hpp"
#include "robomill/robot/files/urdf.hpp"
#include "robomill/serve/files/documents.hpp"
#include "testing/fuzz/input.hpp"
#include "testing/fuzz/reader.hpp"

namespace robomill::fuzz {
namespace {

using Path = std::filesystem::path;

/// TOML itself: what a document has at a key stands there too after another key was set.
void read_toml(std::string_view bytes) {
  accept_or_reject([&] {
    const io::TomlFile file(io::TomlSource(folder() / "input.toml", std::string(bytes)));
    for (const std::string& table : file.keys({})) static_cast<void>(file.keys(table));
    static_cast<void>(file.unusual());
  });
  accept_or_reject([&] {
    const std::string set = io::with_setting(bytes, {"tool.teeth", "3"});
    require(io::setting_of(set, "tool.teeth") == "3", "a key has the value that it was set to");
  });
}

/// By its kind: "lobes", below it the document.
void read_document(std::string_view bytes) {
  const Labelled document = labelled(bytes);
  const std::string_view kind = document.label;
  const io::TomlSource source(folder() / "input.toml", std::string(document.bytes));
  std::vector<std::string> notes;
  accept_or_reject([&] {
    if (kind == "materials") {
      static_cast<void>(cutting::read_materials(source, notes));
    } else if (kind == "coefficients") {
      static_cast<void>(cutting::read_coefficients(source, notes));
    } else if (kind == "fit") {
      static_cast<void>(modal::read_fit_options(source, notes));
    } else if (kind == "modes") {
      modal::read_modes(source, notes).validate();
    } else {
      static_cast<void>(serve::check_document(kind, source.path, *source.text));
    }
  });
}

/// Every reader of a document of ours in JSON; what the text itself is comes back as it was written.
void read_json(std::string_view bytes) {
  accept_or_reject([&] {
    const io::Json json = io::parse_json(bytes, "input.json");
    const std::string text = io::dump(json);
    require(io::dump(io::parse_json(text, "again.json")) == text, "JSON that was written is read as it was");
  });
  const Path& file = file_of(bytes, ".json");
  accept_or_reject([&] { modal::read_frfs({file}).set.validate(); });
  accept_or_reject([&] { static_cast<void>(coupling::read_joint_json(file)); });
  accept_or_reject([&] { monitor::read_machine(file).validate(); });
  accept_or_reject([&] {
    std::vector<std::string> notes;
    modal::read_modes(file, notes).validate();
  });
}

void read_urdf(std::string_view bytes) {
  accept_or_reject([&] {
    const robot::UrdfArm read = robot::parse_urdf(bytes, "input.urdf", {.tip = "flange"});
    read.arm.validate();
  });
}

void read_stl(std::string_view bytes) {
  const Path& file = file_of(bytes, ".stl");
  accept_or_reject([&] {
    const io::TriangleMesh mesh = io::read_stl(file);
    require(!mesh.triangles.empty(), "a surface has triangles");
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) require(corner < mesh.vertices_m.size(), "corners are vertices");
    }
    for (const Eigen::Vector3d& vertex : mesh.vertices_m) require(vertex.allFinite(), "vertices are finite");
  });
}

constexpr std::array<Reader, 5> all = {{
    {"toml", read_toml},
    {"document", read_document},
    {"json", read_json},
    {"urdf", read_urdf},
    {"stl", read_stl},
}};

}  // namespace

std::span<const Reader> document_readers() {
  return all;
}

}  // namespace robomill::fuzz
