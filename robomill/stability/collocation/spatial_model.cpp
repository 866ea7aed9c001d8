#include "robomill/stability/collocation/spatial_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/stability/collocation/mesh/given_engagement.hpp"
#include "robomill/stability/collocation/mesh/spatial_mesh.hpp"

namespace robomill::stability::detail {
namespace {

/// The matrices of one piece, from the force's answer and the structure's.
void reduce(const PiecePlan& plan, const Eigen::Matrix3d& compliance, MeshTopology::Form form,
            CollocationCase::Piece& piece) {
  Eigen::MatrixXd response = plan.response;
  for (Eigen::Index i = 0; i < response.rows(); i += 3) response.block<3, 3>(i, i) += compliance;
  if (form == MeshTopology::Form::whole) {
    piece.coupling.noalias() = response * piece.stiffness;
    piece.observation = plan.at_nodes;
    piece.influence.noalias() = plan.influence * piece.stiffness;
    return;
  }
  piece.coupling.noalias() = piece.stiffness * response;
  piece.observation.noalias() = piece.stiffness * plan.at_nodes;
  piece.influence = plan.influence;
  piece.displacement = plan.at_nodes;
  piece.node_response = std::move(response);
}

/// The member of a cut that a chart varies.
double& swept(cutting::Cut& cut, SweptParameter sweep) {
  switch (sweep) {
    case SweptParameter::radial_depth:
      return cut.radial_depth_m;
    case SweptParameter::lead:
      return cut.lead_rad;
    case SweptParameter::tilt:
      return cut.tilt_rad;
    default:
      return cut.axial_depth_m;
  }
}

SpatialModel::Engage engagement_of(const SpatialMilling& milling, SweptParameter sweep) {
  constexpr double least_depth_m = 1e-9;  // below it nothing is cut
  if (milling.engagement) {
    const auto given = std::make_shared<const GivenEngagement>(milling.cutter, *milling.engagement);
    return [given](double depth_m, int rings) { return given->at(depth_m, rings); };
  }
  return [milling, sweep](double value, int rings) {
    cutting::Cut cut = milling.cut;
    swept(cut, sweep) = value;
    const bool slot = cut.direction == cutting::MillingDirection::slot;
    if (cut.axial_depth_m < least_depth_m || (!slot && cut.radial_depth_m < least_depth_m)) {
      cutting::Engagement nothing;
      nothing.first_arc = {0};
      return nothing;
    }
    return cutting::engage(milling.cutter, cut, {.rings_per_stretch = rings});
  };
}

/// A drill's lip is one ring that cuts all round.
SpatialModel::Parts drill_parts(const cutting::Drill& drill) {
  const double half_angle = 0.5 * drill.point_angle_rad;
  SpatialModel::Parts parts;
  parts.cutter.kind = cutting::CutterKind::general;
  parts.cutter.mill = {.teeth = drill.lips, .diameter_m = drill.diameter_m};
  parts.coefficients = {.tangential_n_per_m2 = {drill.coefficients.tangential_n_per_m2},
                        .radial_n_per_m2 = {drill.coefficients.radial_n_per_m2}};
  parts.engage = [drill, half_angle](double width_m, int) {
    cutting::Engagement all_round;
    all_round.slices = {{.radius_m = 0.5 * drill.diameter_m,
                         .position_rad = 0.5 * std::numbers::pi - half_angle,
                         .width_m = width_m / std::sin(half_angle)}};
    all_round.arcs = {{.entry_rad = 0.0, .exit_rad = units::revolution}};
    all_round.first_arc = {0, 1};
    return all_round;
  };
  return parts;
}

}  // namespace

SpatialModel::Parts spatial_parts(const LobesProblem& problem, SweptParameter sweep) {
  SpatialModel::Parts parts;
  if (problem.drilling) {
    parts = drill_parts(*problem.drilling);
  } else {
    const SpatialMilling& milling = *problem.spatial;
    parts = {.cutter = milling.cutter,
             .coefficients = milling.coefficients,
             .feed_per_tooth_m = milling.feed_per_tooth_m,
             .turns_with_tool = milling.modes_turn_with_tool,
             .engage = engagement_of(milling, sweep)};
  }
  parts.structure = tip_modes(problem);
  return parts;
}

SpatialModel::SpatialModel(Parts parts)
    : parts_(std::move(parts)),
      tip_(tip_dynamics<3>(parts_.structure)),
      fastest_rad_per_s_(tip_.pole.cwiseAbs().maxCoeff()) {
  const cutting::FlatEndMill& mill = parts_.cutter.mill;
  equal_teeth_ = mill.has_equal_teeth();
  period_rad_ = equal_teeth_ ? units::revolution / mill.teeth : units::revolution;
}

void SpatialModel::expect(std::span<const double> depths_m, bool picture) {
  picture_ = picture;
  expected_.assign(depths_m.begin(), depths_m.end());
  std::ranges::sort(expected_);
}

int SpatialModel::first_level(const OperatingPoint& point, double tolerance) const {
  const double quicker = std::sqrt(std::max(point.gain, 1.0));
  return level_for(period_rad_ * fastest_rad_per_s_ / point.spindle_speed_rad_per_s, quicker, tolerance);
}

std::shared_ptr<const SpatialModel::Looked> SpatialModel::look(double depth, int rings) const {
  const bool kept = std::ranges::binary_search(expected_, depth);
  const std::pair<double, int> key(depth, rings);
  if (kept) {
    const std::scoped_lock lock(kept_mutex_);
    if (const auto known = kept_.find(key); known != kept_.end()) return known->second;
  }
  const cutting::Engagement engagement = parts_.engage(depth, rings);
  auto looked = std::make_shared<Looked>();
  looked->contacts = edge_contacts(parts_.cutter, engagement, parts_.coefficients, parts_.feed_per_tooth_m);
  looked->feed_from_tool = engagement.feed_from_tool;
  if (kept) {
    const std::scoped_lock lock(kept_mutex_);
    kept_.emplace(key, looked);
  }
  return looked;
}

/// The pieces of a period and what the force answers at their nodes. The speed decides no more than how many pieces
/// there are: in a picture speeds whose ratio is below 2^(1/4) take the same, as many as the slowest one needs.
void SpatialModel::mesh(const OperatingPoint& point, const MeshLevel& level, CollocationCase& out) const {
  double fastest_per_rad = fastest_rad_per_s_ / point.spindle_speed_rad_per_s;
  constexpr int picture_rings = 10;  // of a level and of the one above it, which looks at the same depths
  const int rings = (picture_ ? picture_rings : level.nodes + 4) * level.splits;
  const auto build = [&](CollocationCase& to) {
    const std::shared_ptr<const Looked> looked = look(point.axial_depth_m, rings);
    const Eigen::Matrix3d axes = parts_.turns_with_tool ? Eigen::Matrix3d::Identity() : looked->feed_from_tool;
    build_spatial_mesh(looked->contacts, fastest_per_rad, axes, level, to);
  };
  if (!picture_ || !std::ranges::binary_search(expected_, point.axial_depth_m)) return build(out);
  fastest_per_rad = std::exp2(0.25 * std::ceil(4.0 * std::log2(fastest_per_rad)));
  const std::array<double, 4> key = {point.axial_depth_m, static_cast<double>(level.nodes),
                                     static_cast<double>(level.splits), fastest_per_rad};
  std::shared_ptr<const CollocationCase> known;
  {
    const std::scoped_lock lock(kept_mutex_);
    if (const auto at = meshes_.find(key); at != meshes_.end()) known = at->second;
  }
  if (!known) {
    auto made = std::make_shared<CollocationCase>();
    build(*made);
    const std::scoped_lock lock(kept_mutex_);
    known = meshes_.emplace(key, made).first->second;
  }
  out.mesh = known->mesh;
  out.pieces = known->pieces;
}

/// One more plan of a case, whose speed it has.
void SpatialModel::plan(double length_rad, int nodes, const CollocationCase* beside, CollocationCase& out) const {
  const double speed = out.spindle_speed_rad_per_s;
  if (beside != nullptr && beside->spindle_speed_rad_per_s == speed) {
    const auto fits = [&](const PiecePlan& plan) { return plan.length_rad == length_rad && plan.nodes() == nodes; };
    const auto known = std::ranges::find_if(beside->plans, fits);
    if (known != beside->plans.end()) {
      out.plans.push_back(*known);
      return;
    }
  }
  plan_piece(tip_, Rotation(speed, {}), 0.0, length_rad, nodes, false, out.plans.emplace_back());
}

void SpatialModel::make(const OperatingPoint& point, const MeshLevel& level, const CollocationCase* beside,
                        CollocationCase& out) const {
  out.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  out.axial_depth_m = point.axial_depth_m;
  out.level = level;
  mesh(point, level, out);
  out.plans.clear();
  for (std::size_t e = 0; e < out.pieces.size(); ++e) {
    const bool records = out.mesh.topology.pieces[e].records;
    const double length = out.mesh.pieces[e].length_rad;
    std::size_t known = 0;
    while (known < e && !(out.mesh.topology.pieces[known].records == records &&
                          std::abs(out.mesh.pieces[known].length_rad - length) < 1e-14 * length)) {
      ++known;
    }
    if (known < e) {
      out.pieces[e].plan = out.pieces[known].plan;
    } else {
      out.pieces[e].plan = out.plans.size();
      plan(length, records ? level.nodes : 1, beside, out);
    }
    if (records) reduce(out.plans[out.pieces[e].plan], tip_.compliance, out.mesh.topology.form, out.pieces[e]);
  }
}

Motion SpatialModel::motion(const CollocationCase& at, double factor, std::complex<double> multiplier,
                            const Eigen::VectorXcd& vector) const {
  const NodeForces<3> forces = trace<3>(at, factor, vector);
  const double period_s = period_rad_ / at.spindle_speed_rad_per_s;
  return strongest_line(tip_, multiplier, period_s, vector,
                        [&](std::complex<double> s) { return fourier_coefficient(forces, period_s, s); });
}

}  // namespace robomill::stability::detail
