#include "robomill/report/forces.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/report/checks.hpp"

namespace robomill::report {
namespace {

/// NaN says "missing"; an infinity is a mistake.
void require_no_infinity(const char* field, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  if (values.array().isInf().any()) throw InvalidInput(field, "must be finite, or NaN where missing");
}

void require_known_or_missing(const char* field, double value, const char* unit) {
  if (std::isinf(value)) throw InvalidInput(field, value, unit, "must be finite, or NaN where missing");
}

void validate_engagement(const std::vector<EngagementRing>& rings) {
  for (std::size_t k = 0; k < rings.size(); ++k) {
    const EngagementRing& ring = rings[k];
    require_finite(member("revolution.engagement", k, "height_m").c_str(), ring.height_m, "m");
    if (k > 0 && ring.height_m <= rings[k - 1].height_m) {
      throw InvalidInput(member("revolution.engagement", k, "height_m"), ring.height_m, "m", "must increase");
    }
    require_known_or_missing(member("revolution.engagement", k, "position_rad").c_str(), ring.position_rad, "rad");
    for (const EngagementArc& arc : ring.arcs) {
      require_finite(member("revolution.engagement", k, "arcs.entry_rad").c_str(), arc.entry_rad, "rad");
      require_finite(member("revolution.engagement", k, "arcs.exit_rad").c_str(), arc.exit_rad, "rad");
      if (arc.exit_rad < arc.entry_rad) {
        throw InvalidInput(member("revolution.engagement", k, "arcs.exit_rad"), arc.exit_rad, "rad",
                           "must not be below the entry");
      }
    }
  }
}

void validate_revolution(const ForceRevolution& turn) {
  const Eigen::Index n = turn.rotation_rad.size();
  require_axis("revolution.rotation_rad", turn.rotation_rad);
  require_length("revolution.force_n", turn.force_n.cols(), n, false);
  require_length("revolution.torque_n_m", turn.torque_n_m.size(), n, false);
  require_all_finite("revolution.force_n", turn.force_n);
  require_all_finite("revolution.torque_n_m", turn.torque_n_m);
  require_all_finite("revolution.mean_n", turn.mean_n);
  require_all_finite("revolution.peak_n", turn.peak_n);
  require_all_finite("revolution.rms_n", turn.rms_n);
  require_known_or_missing("revolution.mean_torque_n_m", turn.mean_torque_n_m, "N m");
  require_known_or_missing("revolution.peak_torque_n_m", turn.peak_torque_n_m, "N m");
  require_known_or_missing("revolution.power_w", turn.power_w, "W");
  require_known_or_missing("revolution.chip_area_m2", turn.chip_area_m2, "m^2");
  require_known_or_missing("revolution.removal_rate_m3_per_s", turn.removal_rate_m3_per_s, "m^3/s");
  require_no_infinity("revolution.deflection_m", turn.deflection_m);
  require_known_or_missing("revolution.peak_deflection_m", turn.peak_deflection_m, "m");
  require_known_or_missing("revolution.chatter_frequency_hz", turn.chatter_frequency_hz, "Hz");
  validate_engagement(turn.engagement);
}

void require_never_decreasing(const char* field, const Eigen::VectorXd& values) {
  require_all_finite(field, values);
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    if (values[i] < values[i - 1]) throw InvalidInput(field, "must not decrease");
  }
}

void require_counts(const char* field, const Eigen::VectorXd& values) {
  constexpr double most = 1e15;  // what a double counts exactly
  for (const double value : values) {
    if (!(value >= 0.0 && value <= most && value == std::floor(value))) {
      throw InvalidInput(field, value, "", "must be a whole number, not negative");
    }
  }
}

void require_limit(const char* field, double limit, const char* unit) {
  if (!std::isnan(limit)) require_positive(field, limit, unit);
}

void validate_path(const ForcePath& path) {
  const Eigen::Index n = path.block.size();
  const std::array<std::pair<const char*, const Eigen::VectorXd*>, 6> required = {
      {{"path.axial_depth_m", &path.axial_depth_m},
       {"path.radial_depth_m", &path.radial_depth_m},
       {"path.peak_force_n", &path.peak_force_n},
       {"path.torque_n_m", &path.torque_n_m},
       {"path.peak_torque_n_m", &path.peak_torque_n_m},
       {"path.power_w", &path.power_w}}};
  for (const auto& [field, values] : required) {
    require_length(field, values->size(), n, false);
    require_no_infinity(field, *values);
  }
  require_counts("path.block", path.block);
  require_length("path.line", path.line.size(), n, false);
  require_counts("path.line", path.line);
  require_length("path.tip_m", path.tip_m.cols(), n, false);
  require_all_finite("path.tip_m", path.tip_m);
  require_length("path.path_m", path.path_m.size(), n, false);
  require_never_decreasing("path.path_m", path.path_m);
  require_length("path.time_s", path.time_s.size(), n, true);
  require_never_decreasing("path.time_s", path.time_s);
  require_length("path.mean_force_n", path.mean_force_n.cols(), n, false);
  require_no_infinity("path.mean_force_n", path.mean_force_n);
  require_length("path.deflection_m", path.deflection_m.size(), n, true);
  require_no_infinity("path.deflection_m", path.deflection_m);
  require_length("path.cuts", static_cast<Eigen::Index>(path.cuts.size()), n, false);
  require_limit("path.torque_limit_n_m", path.torque_limit_n_m, "N m");
  require_limit("path.power_limit_w", path.power_limit_w, "W");
}

void validate_sweep(const RedundancySweep& sweep) {
  require_axis("spindle_rotation.rotation_rad", sweep.rotation_rad);
  require_length("spindle_rotation.deflection_m", sweep.deflection_m.size(), sweep.rotation_rad.size(), false);
  require_no_infinity("spindle_rotation.deflection_m", sweep.deflection_m);
  // A singular posture has an infinite condition number: the JSON has null there.
  require_length("spindle_rotation.condition_number", sweep.condition_number.size(), sweep.rotation_rad.size(), true);
  require_known_or_missing("spindle_rotation.best_rad", sweep.best_rad, "rad");
  require_known_or_missing("spindle_rotation.used_rad", sweep.used_rad, "rad");
}

}  // namespace

void Forces::validate() const {
  if (revolution) validate_revolution(*revolution);
  if (path) validate_path(*path);
  if (spindle_rotation) validate_sweep(*spindle_rotation);
}

}  // namespace robomill::report
