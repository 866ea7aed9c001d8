// What charts take, by constants that README.md's "Cost" was measured with; all times of one core.
#include "robomill/stability/chart/cost.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <string>

#include "robomill/base/lanes.hpp"
#include "robomill/base/units.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/stability/collocation/mesh/cut_mesh.hpp"
#include "robomill/stability/collocation/milling_model.hpp"
#include "robomill/stability/frequency_domain/frequency_lobes.hpp"

namespace robomill::stability::detail {
namespace {

constexpr double of_us = 1e3;  // operations of a microsecond
constexpr double nodes_of_piece = 8.0;
constexpr double largest_matrix = 1200.0;  // ArnoldiOptions

/// A structure as far as it costs.
struct CostlyStructure {
  double modes = 0.0;
  double fastest_rad_per_s = 0.0;      ///< of its modes
  double counting_rad_per_s = 0.0;     ///< of those whose resonance is not below a thousandth of the highest
  double least_decay_per_s = 0.0;      ///< of its modes
  std::string field = "frequency_hz";  ///< of the fastest
  double frequency_hz = 0.0;
};

CostlyStructure costly_structure(const LobesProblem& problem) {
  CostlyStructure out;
  if (problem.has_measured()) {
    // Only the frequency domain takes FRFs: what counts is where they are large.
    for (const modal::FrfSet* const set : {&problem.measured, &problem.workpiece_measured}) {
      for (const modal::Frf& frf : set->frfs) {
        Eigen::Index at = 0;
        frf.receptance.cwiseAbs().maxCoeff(&at);
        out.frequency_hz = std::max(out.frequency_hz, set->frequency_hz(at));
      }
    }
    out.modes = 8.0;
    out.counting_rad_per_s = out.fastest_rad_per_s = units::revolution * out.frequency_hz;
    out.least_decay_per_s = 0.01 * out.fastest_rad_per_s;
    return out;
  }
  const modal::TipModes tip = tip_modes(problem);
  const Eigen::VectorXd size = tip.left.colwise().norm().transpose().array() / -tip.pole.real().array();
  const double highest = size.size() > 0 ? size.maxCoeff() : 0.0;
  out.modes = static_cast<double>(tip.pole.size());
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const double natural = std::abs(tip.pole(k));
    const double decay = -tip.pole(k).real();
    out.least_decay_per_s = k == 0 ? decay : std::min(out.least_decay_per_s, decay);
    if (size(k) >= 1e-3 * highest) out.counting_rad_per_s = std::max(out.counting_rad_per_s, natural);
    if (natural <= out.fastest_rad_per_s) continue;
    out.fastest_rad_per_s = natural;
    out.frequency_hz = natural / units::revolution;
    out.field = (tip.id[static_cast<std::size_t>(k)].of == modal::ModeOwner::workpiece ? "workpiece_dynamics.modes["
                                                                                       : "modes[") +
                std::to_string(tip.id[static_cast<std::size_t>(k)].number) + "].frequency_hz";
  }
  return out;
}

/// The cut: the rotation of a period, and of it what is divided into pieces.
struct CostlyTurn {
  double period_rad = units::revolution, in_pieces_rad = units::revolution;
  double arc_rad = units::revolution;  ///< of one tooth
  double base = 1.0;                   ///< factor of what a period without pieces takes
  // Runout with helix: which tooth cuts what another left changes with the height, in slices. Where one of them enters
  // or leaves a piece ends, and looks back to each tooth.
  double slice_pieces = 0.0, delays = 1.0;
};

CostlyTurn costly_turn(const LobesProblem& problem, const LobesOptions& options) {
  CostlyTurn turn;
  if (problem.drilling) {
    turn.period_rad = turn.in_pieces_rad = units::revolution / problem.drilling->lips;
    turn.base = 30.0;
    return turn;
  }
  const cutting::FlatEndMill& tool = problem.spatial ? problem.spatial->cutter.mill : problem.milling.tool;
  const bool alike = tool.has_equal_teeth();
  turn.period_rad = alike ? units::revolution / tool.teeth : units::revolution;
  if (problem.spatial) {
    turn.base = 30.0;
    turn.in_pieces_rad = 0.7 * turn.period_rad;
    return turn;
  }
  const cutting::Milling& milling = problem.milling;
  const double lag_rad = std::abs(tool.lag_rad_per_m(0)) * options.axial_depth_m[1];
  turn.arc_rad = milling.immersion.exit_rad - milling.immersion.entry_rad + lag_rad;
  // Other methods have their own say on a speed that swings.
  if (options.method == Method::collocation) {
    turn.period_rad *= common_repeats(milling.speed_variation, turn.period_rad);
  }
  const bool straight =
      alike && tool.lag_rad_per_m(0) == 0.0 && !milling.speed_variation.active() && !milling.process_damping.active();
  turn.in_pieces_rad = straight ? std::min(turn.period_rad, turn.arc_rad) : turn.period_rad;
  if (tool.runout_m > 0.0 && tool.lag_rad_per_m(0) != 0.0) {
    // mesh_level's, until two levels agree.
    const double slices = std::clamp(128.0 * std::pow(1e-6 / options.tolerance, 0.4), 8.0, 128.0);
    turn.slice_pieces = 2.0 * slices * tool.teeth;
    turn.delays = tool.teeth;
  }
  return turn;
}

double factor_of_modes(double modes) {
  return 1.0 + 0.25 * modes + 0.01 * modes * modes;
}

/// Of a period, as long as they may be.
double pieces_of(const CostlyStructure& structure, const CostlyTurn& turn, double speed) {
  return turn.in_pieces_rad * structure.fastest_rad_per_s / speed / longest_piece_rad;
}

/// Every mode dies out between two teeth: the multipliers are those of the delay, which fade alike.
bool fades(const CostlyStructure& structure, const CostlyTurn& turn, double speed) {
  return structure.least_decay_per_s * turn.period_rad / speed >= 3.0;
}

/// Of one radius by collocation. Where all fades the matrix is formed, up to its largest size, and beyond it the search
/// ends unsettled.
double operations_of_collocation(const CostlyStructure& structure, const CostlyTurn& turn, double speed) {
  const double pieces = pieces_of(structure, turn, speed);
  double time = turn.base * 3.0 * of_us * factor_of_modes(structure.modes) + 8.0 * of_us * pieces +
                20.0 * of_us * turn.slice_pieces * turn.delays;
  if (!fades(structure, turn, speed)) return time + 0.2 * of_us * pieces * pieces;
  const double size = std::min(nodes_of_piece * pieces, largest_matrix);
  time += 8e-5 * of_us * size * size * size;
  return time + 600.0 * of_us * std::max(0.0, pieces - 150.0);
}

double operations_of_steps(const CostlyStructure& structure, const CostlyTurn& turn, const LobesOptions& options,
                           double teeth) {
  const bool first = options.method == Method::semi_discretization_first_order;
  const double steps = options.intervals * std::max(1.0, teeth * turn.period_rad / units::revolution);
  return 3.0 * of_us * factor_of_modes(structure.modes) +
         (first ? 0.4 : 0.15) * of_us * steps * factor_of_modes(structure.modes);
}

double operations_of_limit(const CostlyStructure& structure, const CostlyTurn& turn, const LobesOptions& options,
                           double speed) {
  const double pieces =
      std::min(turn.period_rad, turn.arc_rad) * structure.counting_rad_per_s / speed / longest_piece_rad;
  if (options.method == Method::zeroth_order) return 100.0 * of_us + 30.0 * of_us * pieces;
  return 4e3 * of_us * factor_of_modes(structure.modes) + 530.0 * of_us * pieces * pieces * pieces;
}

/// Of the lanes of one evaluator, which a thread has.
double bytes_of_lanes(const CostlyStructure& structure, const CostlyTurn& turn, const LobesOptions& options,
                      double slowest) {
  constexpr double lanes = lane_count;
  if (options.method != Method::collocation)
    return lanes * options.intervals * 200.0 * factor_of_modes(structure.modes);
  constexpr double bytes_of_piece = 1e4, levels = 2.0;
  const double pieces = pieces_of(structure, turn, slowest);
  const double held = levels * (1.0 + pieces + turn.delays * turn.slice_pieces) * bytes_of_piece;
  // Beyond it even the roughest level's matrix is too large to be formed.
  constexpr double most_pieces = 200.0;
  const bool formed = fades(structure, turn, slowest) && pieces + turn.slice_pieces <= most_pieces;
  const double size = formed ? std::min(nodes_of_piece * pieces, largest_matrix) : 0.0;
  return lanes * (held * (1.0 + 0.1 * structure.modes) + 20.0 * size * size);
}

/// What a look takes over one without runout.
double times_of_runout(const CostlyStructure& structure, const CostlyTurn& turn, double speed) {
  CostlyTurn even = turn;
  even.slice_pieces = 0.0;
  return operations_of_collocation(structure, turn, speed) / operations_of_collocation(structure, even, speed);
}

}  // namespace

Cost cost_of_looks(const LobesProblem& problem, const LobesOptions& options,
                   std::span<const double> spindle_speeds_rad_per_s, const Looks& looks) {
  Cost cost = {.bytes = looks.bytes};
  if (spindle_speeds_rad_per_s.empty()) return cost;
  const CostlyStructure structure = costly_structure(problem);
  const CostlyTurn turn = costly_turn(problem, options);
  const bool at_once = in_frequency_domain(options.method);
  for (const double speed : spindle_speeds_rad_per_s) {
    const double look = at_once ? operations_of_limit(structure, turn, options, speed)
                        : options.method == Method::collocation
                            ? operations_of_collocation(structure, turn, speed)
                            : operations_of_steps(structure, turn, options, problem.milling.tool.teeth);
    cost.operations += (at_once ? 1.0 : looks.a_speed) * look * looks.times;
  }
  const double slowest = std::ranges::min(spindle_speeds_rad_per_s);
  if (at_once) {
    cost.bytes += 1e8;
  } else {
    cost.bytes_a_thread = bytes_of_lanes(structure, turn, options, slowest);
  }
  constexpr double usual_hz = 1000.0, usual_rad_per_s = 4000.0 * units::rpm, usual_intervals = 40.0, usual_modes = 8.0;
  const bool sliced = turn.slice_pieces > 0.0 && options.method == Method::collocation;
  cost.dominant = dominant_of({looks.counted,
                               {.field = structure.field,
                                .value = structure.frequency_hz,
                                .unit = "Hz",
                                .times_usual = structure.frequency_hz / usual_hz},
                               {.field = "spindle_speed_rad_per_s",
                                .value = slowest,
                                .unit = "rad/s",
                                .times_usual = usual_rad_per_s / slowest},
                               {.field = at_once ? "" : "modes",
                                .value = structure.modes,
                                .unit = "modes",
                                .times_usual = factor_of_modes(structure.modes) / factor_of_modes(usual_modes)},
                               {.field = sliced ? "runout_m" : "",
                                .value = problem.milling.tool.runout_m,
                                .unit = "m",
                                .times_usual = sliced ? times_of_runout(structure, turn, slowest) : 1.0},
                               {.field = "intervals",
                                .value = static_cast<double>(options.intervals),
                                .times_usual = options.intervals / usual_intervals}});
  return cost;
}

void add_cost_of_points(const LobesProblem& problem, const LobesOptions& options, Cost& cost) {
  const Cost chart = cost;
  const double most_bytes = cost_limit().bytes;
  double most = chart.operations;
  for (const OperatingPoint& point : options.points) {
    const Cost one =
        cost_of_looks(problem, options, std::array{point.spindle_speed_rad_per_s}, {.a_speed = 2.0 * looks_a_limit});
    cost.operations += one.operations;
    cost.bytes = std::max(cost.bytes, one.bytes);
    cost.bytes_a_thread = std::max(cost.bytes_a_thread, one.bytes_a_thread);
    // What holds too much by itself is to blame; where neither does, what takes longest.
    const bool chart_holds = chart.least_bytes() > most_bytes, point_holds = one.least_bytes() > most_bytes;
    if (chart_holds || (one.operations <= most && !point_holds)) continue;
    most = std::max(most, one.operations);
    cost.dominant = {
        .field = "points.spindle_speed_rad_per_s", .value = point.spindle_speed_rad_per_s, .unit = "rad/s"};
  }
}

}  // namespace robomill::stability::detail
