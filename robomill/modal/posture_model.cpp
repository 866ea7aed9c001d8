#include "robomill/modal/posture_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/posture/calibrated_arm.hpp"
#include "robomill/modal/posture/inverse_distance.hpp"

namespace robomill::modal {
namespace {

using namespace detail;
using std::numbers::pi;

void require_position(const robot::Cell& cell, const Eigen::VectorXd& joints, const std::string& name) {
  if (joints.size() != cell.arm.size()) {
    throw InvalidInput(name, fmt::format("must have {} joints; it has {}", cell.arm.size(), joints.size()));
  }
  for (Eigen::Index i = 0; i < joints.size(); ++i) require_finite("joints", joints(i), "rad");
  const robot::LimitCheck limits = robot::within_limits(cell.arm, joints);
  if (limits.inside) return;
  const bool slides = cell.arm.joints[static_cast<std::size_t>(limits.joint)].prismatic;
  throw InvalidInput(
      name, fmt::format("takes joint {} {:.4g} {} beyond its limit", limits.joint + 1,
                        slides ? -limits.distance * 1e3 : -limits.distance * 180.0 / pi, slides ? "mm" : "deg"));
}

std::vector<FrfName> names_of(const MeasuredPosture& posture) {
  std::vector<FrfName> out;
  if (posture.modes) {
    for (const Dof& response : posture.modes->responses) {
      for (const Dof& excitation : posture.modes->excitations) out.push_back({response, excitation});
    }
  } else {
    for (const Frf& frf : posture.frfs.frfs) out.push_back(frf.name);
  }
  std::ranges::sort(out);
  return out;
}

/// Postures are compared with each other: the same directions over the same band.
void require_alike(const std::vector<MeasuredPosture>& measured) {
  for (const MeasuredPosture& posture : measured) {
    const MeasuredPosture& first = measured.front();
    if (names_of(posture) != names_of(first)) {
      throw InvalidInput(posture.name, "has other directions than " + first.name,
                         "Measure every posture with the same forces and responses");
    }
    if (posture.modes || first.modes) continue;
    const Eigen::VectorXd &a = first.frfs.frequency_hz, &b = posture.frfs.frequency_hz;
    const double step = a.size() > 1 ? (a(a.size() - 1) - a(0)) / static_cast<double>(a.size() - 1) : 0.0;
    if (std::abs(a(0) - b(0)) > 2.0 * step || std::abs(a(a.size() - 1) - b(b.size() - 1)) > 2.0 * step) {
      throw InvalidInput(posture.name,
                         fmt::format("covers {:.5g} to {:.5g} Hz, {} {:.5g} to {:.5g} Hz: the bands must be one", b(0),
                                     b(b.size() - 1), first.name, a(0), a(a.size() - 1)));
    }
  }
}

/// Whether the cell says enough for a model of the arm.
bool has_model(const robot::Cell& cell) {
  return std::ranges::all_of(cell.arm.joints, [](const robot::Joint& j) { return j.stiffness > 0.0; }) &&
         std::ranges::any_of(cell.arm.joints, [](const robot::Joint& j) { return j.link.mass_kg > 0.0; });
}

/// How far apart measured postures are: beyond that nothing was measured nearby.
double region_of(const std::vector<Eigen::VectorXd>& postures) {
  double widest = 0.0;
  for (std::size_t a = 0; a < postures.size(); ++a) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < postures.size(); ++b) {
      if (a != b) nearest = std::min(nearest, posture_distance(postures[a], postures[b]));
    }
    if (std::isfinite(nearest)) widest = std::max(widest, nearest);
  }
  return widest;
}

/// Measured modes weighted by inverse distance, for a cell that says too little of its arm.
class Interpolated final : public PostureSource {
 public:
  Interpolated(const robot::Cell& told, const std::vector<MeasuredPosture>& measured,
               const PostureModelOptions& options, Progress& progress) {
    cell = told;
    report.source = PostureReport::Source::interpolated;
    for (const FrfName& name : names_of(measured.front())) {
      const auto axis = static_cast<std::size_t>(name.excitation.axis) - 1;
      if (name.excitation.point == 0 && axis < report.direct.size()) report.direct[axis].measured = true;
    }
    for (const MeasuredPosture& posture : measured) {
      postures.push_back(posture.joints);
      if (posture.modes) {
        modes_.push_back({posture.joints, *posture.modes});
        continue;
      }
      FitOptions fit;
      fit.band_low_hz = options.band_low_hz;
      fit.band_high_hz = options.band_high_hz;
      modes_.push_back({posture.joints, fit_modes(posture.frfs, fit, progress).model});
    }
    report.notes.push_back(
        "The cell has no masses (robot.links) or no joint stiffness: measured modes are interpolated by inverse "
        "distance, which is far less accurate than a calibrated arm.");
  }
  [[nodiscard]] ModalModel at(const Eigen::VectorXd& joints) const override {
    return inverse_distance(modes_, cell.arm, joints, ResidueAxes::flange);
  }
  [[nodiscard]] Eigen::Vector3d direct_deviation(const Eigen::VectorXd& /*joints*/) const override {
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  [[nodiscard]] std::optional<PostureCalibration> calibration() const override { return std::nullopt; }

 private:
  std::vector<PostureModes> modes_;
};

}  // namespace

void PostureModelOptions::validate() const {
  require_non_negative("band_low_hz", band_low_hz, "Hz");
  require_finite("band_high_hz", band_high_hz, "Hz");
  if (!(band_high_hz > band_low_hz)) throw InvalidInput("band_high_hz", band_high_hz, "Hz", "must be > band_low_hz");
}

namespace {

/// A calibration looks at every line of every posture.
void require_affordable_calibration(const std::vector<MeasuredPosture>& measured, const PostureModelOptions& options) {
  constexpr double operations_of_value = 2.4e5, bytes_of_value = 1e3;
  double values = 0.0;
  for (const MeasuredPosture& posture : measured) {
    const Eigen::VectorXd& lines = posture.frfs.frequency_hz;
    const auto in_band = (lines.array() >= options.band_low_hz && lines.array() <= options.band_high_hz).count();
    values += static_cast<double>(in_band) * static_cast<double>(posture.frfs.frfs.size());
  }
  require_affordable({.operations = operations_of_value * values,
                      .bytes = bytes_of_value * values,
                      .dominant = {.field = "postures", .value = values, .unit = "values of FRFs"}});
}

}  // namespace

PostureModel::PostureModel(const robot::Cell& cell, const std::optional<robot::Link>& payload,
                           const std::vector<MeasuredPosture>& measured, const PostureModelOptions& options,
                           Progress& progress, const PostureCalibration* kept) {
  cell.validate();
  options.validate();
  for (const MeasuredPosture& posture : measured) require_position(cell, posture.joints, posture.name);
  if (!measured.empty()) require_alike(measured);
  if (has_model(cell)) {
    require_affordable_calibration(measured, options);
    source_ = calibrated_arm(cell, payload, measured, options, kept, searched_, progress);
  } else if (!measured.empty()) {
    source_ = std::make_unique<Interpolated>(cell, measured, options, progress);
  } else {
    throw InvalidInput("cell", "has neither measured postures nor masses and joint stiffness",
                       "Write [[postures]], or robot.links and robot.joint_stiffness_n_m_per_rad");
  }
  for (const MeasuredPosture& posture : measured) source_->names.push_back(posture.name);
  source_->report.postures = measured.size();
  source_->report.region_rad = region_of(source_->postures);
}
PostureModel::~PostureModel() = default;
PostureModel::PostureModel(PostureModel&&) noexcept = default;
PostureModel& PostureModel::operator=(PostureModel&&) noexcept = default;

PosturePrediction PostureModel::at(const Eigen::VectorXd& joints) const {
  require_position(source_->cell, joints, "joints");
  PosturePrediction out;
  out.modes = source_->at(joints);
  out.distance_rad = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < source_->postures.size(); ++k) {
    const double distance = posture_distance(source_->postures[k], joints);
    if (distance >= out.distance_rad) continue;
    out.distance_rad = distance;
    out.nearest = source_->names[k];
  }
  out.measured_nearby = out.distance_rad <= source_->report.region_rad;
  return out;
}

Eigen::Vector3d PostureModel::direct_deviation(const Eigen::VectorXd& joints) const {
  require_position(source_->cell, joints, "joints");
  return source_->direct_deviation(joints);
}

std::optional<PostureCalibration> PostureModel::calibration() const {
  return source_->calibration();
}

const PostureReport& PostureModel::report() const {
  return source_->report;
}

}  // namespace robomill::modal
