#include "robomill/jobs/files/assumed.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::jobs {
namespace {

/// The list of one file.
class Defaults {
 public:
  Defaults(std::shared_ptr<const io::TomlFile> document, const std::filesystem::path& path)
      : document_(std::move(document)), name_(path.filename().string()) {}

  [[nodiscard]] bool has(const char* key) const { return document_ && document_->has(key); }
  void add(std::string what, std::string taken, const char* key) {
    if (document_) list_.push_back({.what = std::move(what), .taken = std::move(taken), .key = key, .file = name_});
  }
  /// Unless the file has the key.
  void add_without(const char* key, const char* what, const char* taken) {
    if (!has(key)) add(what, taken, key);
  }
  void add_helix() { add_without((std::string("tool.") + cutting::helix_key).c_str(), "Helix angle", "0°"); }
  [[nodiscard]] std::vector<Assumption> with(const std::vector<Assumption>& more) const {
    std::vector<Assumption> out = list_;
    add_assumed(out, more);
    return out;
  }

 private:
  std::shared_ptr<const io::TomlFile> document_;
  std::string name_;
  std::vector<Assumption> list_ = {};
};

/// Of coefficients that stand in the file as numbers.
void add_coefficients(Defaults& defaults, bool edges, bool axial) {
  if (!defaults.has("coefficients.tangential_n_per_mm2")) return;
  if (axial) defaults.add_without("coefficients.axial_n_per_mm2", "Axial force of the edges", "none");
  if (edges) defaults.add_without("coefficients.tangential_edge_n_per_mm", "Edge forces", "none");
}

}  // namespace

std::vector<Assumption> assumed_of(const LobesFile& file, CutUse use) {
  Defaults defaults(file.document, file.path);
  const bool motion = use == CutUse::motion;
  if (file.drilling) {
    defaults.add_without("tool.point_angle_deg", "Point angle", "118°");
  } else {
    defaults.add_without("tool.kind", "Cutter", "flat end");
    defaults.add_helix();
    defaults.add_without("cut.feed_direction_deg", "Feed direction", "0°, along x of the structure");
    if (motion) defaults.add_without("tool.runout_um", "Runout", "0 µm");
  }
  add_coefficients(defaults, motion, file.problem.spatial.has_value());
  defaults.add_without("workpiece_dynamics", "Workpiece and its fixture", "rigid");
  return defaults.with(file.assumed);
}

std::vector<Assumption> assumed_of(const process::ForcesFile& file, bool with_cell) {
  Defaults defaults(file.document, file.path);
  defaults.add_helix();
  defaults.add_without("tool.runout_um", "Runout", "0 µm");
  const bool sought = file.job == process::ForcesJob::identification;
  if (!sought) add_coefficients(defaults, true, true);
  if (!with_cell) defaults.add("Machine", "rigid, its deflection is left out", "robot.cell");
  const bool posed = with_cell && !file.joints_rad.empty() && file.job == process::ForcesJob::revolution;
  if (posed) defaults.add_without("robot.feed_direction", "Feed direction", "along x of the work frame");
  if (!sought && !file.dynamics.modes.empty()) {
    defaults.add_without("cut.feed_direction_deg", "Feed direction in the axes of the structure", "0°, along x");
    defaults.add_without("workpiece_dynamics", "Workpiece and its fixture", "rigid");
  }
  return defaults.with(file.assumed);
}

}  // namespace robomill::jobs
