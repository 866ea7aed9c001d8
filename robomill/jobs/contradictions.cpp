#include "robomill/jobs/contradictions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>

#include "robomill/base/units.hpp"
#include "robomill/io/toml_file.hpp"

namespace robomill::jobs {
namespace {

constexpr double same_number = 1e-6;  // relative

bool differ(double a, double b) {
  return std::abs(a - b) > same_number * std::max(std::abs(a), std::abs(b));
}

std::string name_of(const std::filesystem::path& path) {
  return path.filename().string();
}

/// Looks at one key after another.
class Comparison {
 public:
  Comparison(const LobesFile& lobes, const process::ForcesFile& forces) : lobes_(lobes), forces_(forces) {}

  void number(const std::string& key, double a, double b, double unit) {
    if (both(key) && differ(a, b)) add(key, fmt::format("{:.6g}", a / unit), fmt::format("{:.6g}", b / unit));
  }
  void numbers(const std::string& key, const std::vector<double>& a, const std::vector<double>& b, double unit) {
    if (!both(key) || std::ranges::equal(a, b, [](double x, double y) { return !differ(x, y); })) return;
    add(key, list(a, unit), list(b, unit));
  }
  void text(const std::string& key, const std::string& a, const std::string& b) {
    if (both(key) && a != b) add(key, '"' + a + '"', '"' + b + '"');
  }
  std::vector<std::string> found = {};

 private:
  [[nodiscard]] bool both(const std::string& key) const {
    return lobes_.document && forces_.document && lobes_.document->has(key) && forces_.document->has(key);
  }
  static std::string list(const std::vector<double>& values, double unit) {
    std::vector<double> shown = values;
    for (double& value : shown) value /= unit;
    return fmt::format("[{:.6g}]", fmt::join(shown, ", "));
  }
  void add(const std::string& key, const std::string& a, const std::string& b) {
    found.push_back(fmt::format("{} is {} in {} and {} in {}: one cut has one value. Correct the one that is wrong.",
                                key, a, name_of(lobes_.path), b, name_of(forces_.path)));
  }

  const LobesFile& lobes_;
  const process::ForcesFile& forces_;
};

const char* word(cutting::MillingDirection direction) {
  switch (direction) {
    case cutting::MillingDirection::up:
      return "up";
    case cutting::MillingDirection::down:
      return "down";
    case cutting::MillingDirection::slot:
      break;
  }
  return "slot";
}

}  // namespace

std::vector<std::string> contradictions(const LobesFile& lobes, const process::ForcesFile& forces) {
  Comparison compare(lobes, forces);
  const cutting::FlatEndMill& a = lobes.problem.milling.tool;
  const cutting::FlatEndMill& b = forces.cutter.mill;
  compare.number("tool.teeth", a.teeth, b.teeth, 1.0);
  compare.number("tool.diameter_mm", a.diameter_m, b.diameter_m, units::mm);
  compare.number("tool.helix_deg", a.helix_rad, b.helix_rad, units::deg);
  compare.numbers("tool.pitch_deg", a.pitch_rad, b.pitch_rad, units::deg);
  compare.number("tool.runout_um", a.runout_m, b.runout_m, units::um);
  const auto coefficient = [&](const char* key, double of_lobes, const std::vector<double>& of_forces, double unit) {
    if (of_forces.size() == 1 && of_lobes > 0.0) compare.number(key, of_lobes, of_forces[0], unit);
  };
  const cutting::ForceCoefficients& k = lobes.problem.milling.coefficients;
  coefficient("coefficients.tangential_n_per_mm2", k.tangential_n_per_m2, forces.coefficients.tangential_n_per_m2,
              units::n_per_mm2);
  coefficient("coefficients.radial_n_per_mm2", k.radial_n_per_m2, forces.coefficients.radial_n_per_m2,
              units::n_per_mm2);
  coefficient("coefficients.tangential_edge_n_per_mm", k.tangential_edge_n_per_m,
              forces.coefficients.tangential_edge_n_per_m, units::n_per_mm);
  coefficient("coefficients.radial_edge_n_per_mm", k.radial_edge_n_per_m, forces.coefficients.radial_edge_n_per_m,
              units::n_per_mm);
  if (forces.job == process::ForcesJob::revolution) {
    if (lobes.direction) compare.text("cut.direction", word(*lobes.direction), word(forces.cut.direction));
    compare.number("cut.radial_depth_mm", lobes.radial_depth_m, forces.cut.radial_depth_m, units::mm);
    compare.number("cut.feed_per_tooth_mm", lobes.problem.milling.feed_per_tooth_m, forces.motion.feed_per_tooth_m,
                   units::mm);
  }
  return compare.found;
}

std::vector<std::string> contradictions(const Job& job, const process::ForcesFile& forces) {
  const double edges_m = forces.cutter.cutting_height_m;
  const bool stated = forces.document && forces.document->has("tool.cutting_height_mm");
  if (!stated || !(job.recommend.max_axial_depth_m > edges_m * (1.0 + same_number))) return {};
  return {fmt::format(
      "tool.max_axial_depth_mm is {:.6g} in {}, and the edges reach {:.6g} mm up in {} "
      "(tool.cutting_height_mm): a deeper cut runs the shank into material.",
      job.recommend.max_axial_depth_m / units::mm, name_of(job.file), edges_m / units::mm, name_of(forces.path))};
}

}  // namespace robomill::jobs
