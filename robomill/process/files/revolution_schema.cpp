#include "robomill/process/files/revolution_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/simulation/files/simulation_files.hpp"

namespace robomill::process {
namespace {

using cutting::Engagement;
using cutting::StaticDeflection;
using io::add_rows;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::Use;
using simulation::Simulation;

constexpr Name<StaticDeflection::Status> settled_names[] = {{"found", StaticDeflection::Status::found},
                                                            {"digs in", StaticDeflection::Status::diverged},
                                                            {"lifts off", StaticDeflection::Status::lifts_off}};
struct RingView {
  const Engagement* engagement = nullptr;
  std::size_t index = 0;
  [[nodiscard]] const cutting::EdgeSlice& slice() const { return engagement->slices[index]; }
};

const Schema<RingView>& ring_table() {
  static const Schema<RingView> table(
      "engaged_ring", "a ring of the cutter",
      {key(
           "height_mm", [](const RingView& at) { return at.slice().height_m; }, "above the tip"),
       key(
           "radius_mm", [](const RingView& at) { return at.slice().radius_m; }, "of the ring"),
       key(
           "position_deg", [](const RingView& at) { return at.slice().position_rad; }, "angle of the profile's normal"),
       key(
           "arcs_deg",
           [](const RingView& at) {
             std::vector<std::array<double, 2>> out;
             for (const cutting::Arc& arc : at.engagement->of(at.index)) out.push_back({arc.entry_rad, arc.exit_rad});
             return out;
           },
           "[entry, exit] of each arc in the cut")
           .entries(2)},
      Use::written);
  return table;
}

struct RotationView {
  const robot::Redundancy* rotation = nullptr;
  double used_rad = 0.0;
};

/// A list of what is known of each turn; null where the robot cannot stand so, or hold the force.
template <class F>
Row<RotationView> of_turns(const std::string& name, F value, const std::string& meaning) {
  return key(
             name,
             [value](const RotationView& view) {
               std::vector<std::optional<double>> out;
               for (const robot::RedundancySample& sample : view.rotation->samples) {
                 const bool stands = sample.status == robot::Reach::Status::found && !sample.buckled;
                 out.push_back(stands ? std::optional<double>(value(sample)) : std::nullopt);
               }
               return out;
             },
             meaning)
      .nullable();
}

const Schema<RotationView>& rotation_table() {
  using Sample = robot::RedundancySample;
  const auto best = [](auto value) {
    return [value](const RotationView& view) {
      const bool found = view.rotation->status == robot::Redundancy::Status::found;
      return found ? std::optional<double>(value(view.rotation->best)) : std::nullopt;
    };
  };
  static const Schema<RotationView> table(
      "spindle_rotation", "what turning the flange about the tool's axis does",
      {key(
           "rotation_deg",
           [](const RotationView& view) {
             std::vector<double> out;
             for (const Sample& sample : view.rotation->samples) out.push_back(sample.gamma_rad);
             return out;
           },
           "each turn"),
       of_turns(
           "deflection_um", [](const Sample& sample) { return sample.error_m.norm(); }, "of the tip"),
       of_turns(
           "along_normal_um", [](const Sample& sample) { return sample.error_along_normal_m; },
           "its part along the surface's normal"),
       of_turns(
           "condition_number", [](const Sample& sample) { return sample.condition_number; }, "of the Jacobian"),
       of_turns(
           "limit_distance_deg", [](const Sample& sample) { return sample.limit_distance_rad; },
           "of the joint nearest to its limit"),
       key("best_deg", best([](const Sample& sample) { return sample.gamma_rad; }), "turn of least deflection")
           .nullable(),
       key("best_deflection_um", best([](const Sample& sample) { return sample.error_m.norm(); }), "there").nullable(),
       key("used_deg", &RotationView::used_rad, "turn of this cut")},
      Use::written);
  return table;
}

const Schema<Simulation>& vibration_table() {
  static const Schema<Simulation> table(
      "cut_vibration", "the same cut in time, with what vibrates",
      {key("verdict", &Simulation::verdict, simulation::verdict_names, "of the last half of the time"),
       key(
           "chatter_frequency_hz", [](const Simulation& s) { return io::if_positive(s.chatter_frequency_hz); },
           "none: stable")
           .nullable(),
       key("chatter_amplitude_um", &Simulation::chatter_amplitude_m, "of that motion"),
       key(
           "spectral_radius",
           [](const Simulation& s) {
             const bool found = s.small.status == simulation::SmallVibration::Status::found;
             return found ? std::optional(s.small.spectral_radius) : std::nullopt;
           },
           "of small vibration")
           .nullable(),
       key("missed_share", &Simulation::missed_share, "of the time in which an edge in the cut touches nothing")
           .nullable(),
       key("error_estimate", &Simulation::error_estimate, "of the displacement, relative").nullable()},
      Use::written);
  return table;
}

/// Of the same cut on a rigid robot.
template <class Value>
Row<RevolutionView> rigid(const char* name, Value value, const char* meaning) {
  return key(
             name,
             [value](const RevolutionView& v) {
               const std::optional<cutting::ForceSummary>& force = v.revolution->rigid;
               return force ? std::optional<Eigen::Vector3d>(v.sign * value(*force)) : std::nullopt;
             },
             meaning)
      .entries(3)
      .null_list();
}

std::vector<Row<RevolutionView>> revolution_keys() {
  using View = RevolutionView;
  return {
      key(
          "mean_n", [](const View& v) { return Eigen::Vector3d(v.sign * v.force().mean_n); }, "mean in x, y, z")
          .entries(3),
      key(
          "peak_n", [](const View& v) { return Eigen::Vector3d(v.sign * v.force().peak_n); }, "largest, with its sign")
          .entries(3),
      key(
          "rms_n", [](const View& v) { return v.force().rms_n; }, "root mean square")
          .entries(3),
      key(
          "peak_force_n", [](const View& v) { return v.force().peak_force_n; }, "largest magnitude"),
      rigid(
          "rigid_mean_n", [](const cutting::ForceSummary& force) { return force.mean_n; },
          "mean in x, y, z as if the robot did not deflect; none: no robot"),
      rigid(
          "rigid_peak_n", [](const cutting::ForceSummary& force) { return force.peak_n; },
          "the same, largest with its sign; none: no robot"),
      key(
          "torque_n_m", [](const View& v) { return v.force().mean_torque_n_m; }, "mean"),
      key(
          "peak_torque_n_m", [](const View& v) { return v.force().peak_torque_n_m; }, "largest"),
      key(
          "power_w", [](const View& v) { return v.force().power_w; }, "mean"),
      key(
          "chip_area_mm2", [](const View& v) { return v.force().chip_area_m2; }, "of the cut across the feed"),
      key(
          "patch_area_mm2", [](const View& v) { return cutting::patch_area_m2(v.revolution->deflected.engagement); },
          "of the cutter in the material"),
      key(
          "removal_rate_mm3_per_s", [](const View& v) { return v.force().removal_rate_m3_per_s; }, "material a second"),
      key(
          "missed_share", [](const View& v) { return v.force().missed_share; },
          "of the engaged edge, what cuts nothing because of runout"),
      key(
          "deflection_um",
          [](const View& v) {
            return v.on_robot() ? std::optional(v.revolution->deflected.deflection_m) : std::nullopt;
          },
          "of the tip under the mean force; none: no robot")
          .entries(3)
          .null_list(),
      key(
          "peak_deflection_um",
          [](const View& v) {
            return v.on_robot() ? std::optional(v.revolution->deflected.peak_deflection_m) : std::nullopt;
          },
          "greatest over the revolution; none: no robot")
          .nullable(),
      key(
          "axial_depth_left_mm", [](const View& v) { return v.revolution->deflected.cut.axial_depth_m; },
          "of the deflected tool"),
      key(
          "settled", [](const View& v) { return v.revolution->deflected.status; }, settled_names,
          "whether depth and force agree"),
      key(
          "condition_number",
          [](const View& v) {
            return v.on_robot() ? std::optional(v.revolution->posture->condition_number) : std::nullopt;
          },
          "of the Jacobian; none: no robot")
          .nullable(),
      key(
          "spindle_rotation",
          [](const View& v) {
            const RevolutionForces& r = *v.revolution;
            return r.spindle_rotation ? std::optional(RotationView{&*r.spindle_rotation, r.posture->pose.gamma_rad})
                                      : std::nullopt;
          },
          rotation_table(), "of a robot")
          .nullable(),
      key(
          "vibration", [](const View& v) { return v.revolution->vibration ? &*v.revolution->vibration : nullptr; },
          vibration_table(), "where the dynamics are known")
          .nullable(),
      key(
          "engagement",
          [](const View& v) {
            std::vector<RingView> out;
            const Engagement& engagement = v.revolution->deflected.engagement;
            for (std::size_t i = 0; i < engagement.slices.size(); ++i) out.push_back({&engagement, i});
            return out;
          },
          ring_table(), "rings of the cutter with their angles in the cut"),
      key(
          "rotation_deg", [](const View& v) { return v.force().rotation_rad; }, "of the first tooth at the tip")
          .exact()};
}

/// Forces over the rotation, by axis.
std::vector<Row<RevolutionView>> course_keys() {
  using View = RevolutionView;
  std::vector<Row<View>> rows;
  const auto by_axis = [&rows](const std::string& before, auto force, const char* meaning) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto course = [axis, force](const View& v) {
        return Eigen::VectorXd(v.sign * force(v).row(axis).transpose());
      };
      rows.push_back(key(fmt::format("{}f{}_n", before, "xyz"[axis]), course, meaning).exact());
    }
  };
  by_axis(
      "", [](const View& v) -> const Eigen::Matrix3Xd& { return v.force().force_n; }, "over the rotation");
  rows.push_back(key(
                     "torque_by_rotation_n_m", [](const View& v) { return v.force().torque_n_m; }, "over the rotation")
                     .exact());
  const std::size_t rigid = rows.size();
  by_axis(
      "vibrating_", [](const View& v) -> const Eigen::Matrix3Xd& { return v.revolution->vibrating_force_n; },
      "of the tool that vibrates, over its last revolution");
  for (std::size_t k = rigid; k < rows.size(); ++k) {
    rows[k] = where([](const View& v) { return v.revolution->vibrating_force_n.cols() > 0; }, std::move(rows[k]));
  }
  return rows;
}

}  // namespace

std::vector<Row<RevolutionView>> revolution_rows() {
  std::vector<Row<RevolutionView>> rows = revolution_keys();
  add_rows(rows, course_keys());
  return rows;
}

}  // namespace robomill::process
