#include "robomill/coupling/joint_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/distributed.hpp"
#include "robomill/coupling/joint_hybrid.hpp"
#include "robomill/coupling/joint_knowledge.hpp"
#include "robomill/coupling/joint_model.hpp"
#include "robomill/coupling/published/joint_ga.hpp"

namespace robomill::coupling {
namespace {

using Eigen::Index;
using modal::Axis;

struct Unknown {
  const char* name;
  const char* unit;
};
constexpr std::array<Unknown, joint_unknowns> unknowns = {{{"translational stiffness", "N/m"},
                                                           {"translational damping", "N s/m"},
                                                           {"rotational stiffness", "N m/rad"},
                                                           {"rotational damping", "N m s/rad"}}};

void require_share(const char* field, double share) {
  if (share >= 0.0 && share <= 1.0) return;
  throw InvalidInput(field, share, "", "must be in [0, 1]");
}

bool is_left_open(const JointFitOptions& options, std::size_t i) {
  return options.lower[i] == 0.0 && options.upper[i] == 0.0;
}

/// The method's own bounds where none are given.
JointFitOptions with_bounds(JointFitOptions options) {
  const bool ga = options.method == JointMethod::ga;
  for (std::size_t i = 0; i < joint_unknowns; ++i) {
    if (!is_left_open(options, i)) continue;
    const bool stiffness = i % 2 == 0;
    options.lower[i] = stiffness ? (ga ? 1e5 : 1e3) : 0.0;
    options.upper[i] = stiffness ? (ga ? 1e8 : 1e12) : (ga ? 100.0 : 1e6);
  }
  return options;
}

/// The driving-point FRF at the tip: that of the unnumbered point, or the only one.
const modal::Frf& tip_frf(const modal::FrfSet& measured, Axis axis) {
  const modal::FrfName name{.response = {.point = 0, .axis = axis}, .excitation = {.point = 0, .axis = axis}};
  if (const modal::Frf* frf = measured.find(name)) return *frf;
  const modal::Frf* only = nullptr;
  int count = 0;
  for (const modal::Frf& frf : measured.frfs) {
    if (frf.name.response != frf.name.excitation || frf.name.response.axis != axis) continue;
    only = &frf;
    ++count;
  }
  if (count == 1) return *only;
  if (count == 0) {
    throw InvalidInput("measured", "lacks " + modal::to_string(name),
                       "The joint is found from the tip's response at the point and in the direction of the hit");
  }
  throw InvalidInput("measured", "holds several points",
                     "The tip is the one without a number: " + modal::to_string(name));
}

/// The lines above 0 Hz.
std::vector<Index> fitted_lines(const Eigen::VectorXd& frequency_hz, const modal::Frf& frf,
                                std::vector<std::string>& notes) {
  std::vector<Index> lines;
  double largest = 0.0;
  for (Index i = 0; i < frequency_hz.size(); ++i) {
    if (!(frequency_hz(i) > 0.0)) continue;
    lines.push_back(i);
    largest = std::max(largest, std::abs(frf.receptance(i)));
  }
  if (lines.size() < static_cast<std::size_t>(frequency_hz.size())) notes.push_back("The line at 0 Hz is left out.");
  if (lines.size() <= joint_unknowns) {
    throw InvalidInput("measured", fmt::format("has {} lines above 0 Hz; a joint has four unknowns", lines.size()));
  }
  if (!(largest > 0.0)) throw InvalidInput("measured", modal::to_string(frf.name) + " is zero at every line");
  if (largest < 1e-30 || largest > 1e3) {
    throw InvalidInput("measured",
                       fmt::format("{} reaches {:.3g} m/N, which no machine has", modal::to_string(frf.name), largest),
                       "Tips move by 1e-9 to 1e-2 m/N: is the unit right?");
  }
  return lines;
}

void note_suspects(const modal::FrfSet& measured, const modal::Frf& frf, detail::Base& base, JointFitResult& result) {
  result.suspect_hz = std::move(base.suspect_hz);
  if (!result.suspect_hz.empty()) {
    result.notes.push_back(fmt::format(
        "At {} lines, the first at {:.6g} Hz, the measured holder would create energy (Im H > 0 beyond its noise).",
        result.suspect_hz.size(), result.suspect_hz.front()));
  }
  const std::vector<double> tip = detail::suspect_lines(frf, measured.frequency_hz);
  if (2 * tip.size() > static_cast<std::size_t>(measured.frequency_hz.size())) {
    throw InvalidInput("measured",
                       fmt::format("{} has a positive imaginary part at {} of {} lines: it would create energy",
                                   modal::to_string(frf.name), tip.size(), measured.frequency_hz.size()),
                       "Is the sign of a sensor wrong, or the time axis turned round?");
  }
  if (!tip.empty()) {
    result.notes.push_back(fmt::format(
        "At {} lines, the first at {:.6g} Hz, the measured tip would create energy (Im H > 0 beyond its noise).",
        tip.size(), tip.front()));
    result.suspect_hz.insert(result.suspect_hz.end(), tip.begin(), tip.end());
    std::ranges::sort(result.suspect_hz);
    result.suspect_hz.erase(std::unique(result.suspect_hz.begin(), result.suspect_hz.end()), result.suspect_hz.end());
  }
  if (!base.xy.empty()) {
    result.notes.push_back("The holder's receptances between x and y are left out: a joint is found in one plane.");
  }
}

/// The assembly with the joint that is looked for: what of its own joint stays.
Joint joint_frame(const Assembly& assembly, const JointFitOptions& options) {
  if (assembly.holder.free) {
    throw InvalidInput("holder.free", "must not be true where a joint is looked for",
                       "A tool that hangs free has none");
  }
  Joint joint = assembly.joint.value_or(Joint{});
  const double cross = joint.cross_stiffness_n_per_rad;
  require_finite("joint.cross_stiffness_n_per_rad", cross, "N/rad");
  Assembly rest = assembly;  // valid but for the four values, which are looked for
  rest.joint = joint;
  rest.joint->translational_stiffness_n_per_m = rest.joint->rotational_stiffness_n_m_per_rad =
      std::max(1e6, 2.0 * std::abs(cross));
  rest.joint->translational_damping_n_s_per_m = rest.joint->rotational_damping_n_m_s_per_rad = 0.0;
  rest.validate();
  if (!(cross * cross < options.upper[0] * options.upper[2])) {
    throw InvalidInput("joint.cross_stiffness_n_per_rad", cross, "N/rad",
                       "must be below the geometric mean of the two stiffnesses' upper bounds");
  }
  return joint;
}

detail::JointModel model_of(const Assembly& assembly, const Joint& frame, const std::vector<Eigen::Matrix2cd>& base,
                            const Eigen::VectorXd& frequency_hz) {
  std::vector<detail::BeamElement> tool = detail::tool_elements(assembly, frequency_hz);
  const double cross = frame.cross_stiffness_n_per_rad;
  if (frame.points == 1) return detail::JointModel(tool, base, frequency_hz, cross);
  return detail::JointModel(
      std::make_shared<const detail::DistributedTip>(std::move(tool), frame, assembly.holder, base, frequency_hz),
      frequency_hz, cross);
}

void set_values(const detail::JointValues& values, Joint& joint) {
  joint.translational_stiffness_n_per_m = values[0];
  joint.translational_damping_n_s_per_m = values[1];
  joint.rotational_stiffness_n_m_per_rad = values[2];
  joint.rotational_damping_n_m_s_per_rad = values[3];
}

std::string note_of_stall(const JointFitResult& result, const JointFitOptions& options) {
  return fmt::format(
      "The search stalled: {} generations lowered the objective of the best of the {} random joints that it began with "
      "by {:.1g} of itself, {:.6g} m/N. The joint is as good as that one, no better. Another seed, --mutation adaptive "
      "or --method hybrid may go on.",
      options.generations, options.population, 1.0 - result.best.back() / result.start, result.start);
}

void compare(const detail::JointModel& model, const detail::JointValues& values, const Eigen::VectorXcd& measured,
             modal::Frf& found, JointFitResult& result) {
  detail::JointModel::Response response;
  model.receptance(values, response);
  found.receptance.resize(model.lines());
  found.receptance.real() = response.real.head(model.lines()).matrix();
  found.receptance.imag() = response.imag.head(model.lines()).matrix();
  result.objective_m_per_n = (found.receptance.cwiseAbs() - measured.cwiseAbs()).norm();
  result.relative_error = (found.receptance - measured).norm() / measured.norm();
}

}  // namespace

std::string to_string(JointUnknown unknown) {
  return unknowns.at(static_cast<std::size_t>(unknown)).name;
}

void JointFitOptions::validate() const {
  if (axis != Axis::x && axis != Axis::y) throw InvalidInput("axis", "must be x or y");
  for (std::size_t i = 0; i < joint_unknowns; ++i) {
    const auto [name, unit] = unknowns[i];
    const std::string low = fmt::format("lower[{}]", i + 1);
    const std::string high = fmt::format("upper[{}]", i + 1);
    require_non_negative(low.c_str(), lower[i], unit);
    require_non_negative(high.c_str(), upper[i], unit);
    if (is_left_open(*this, i)) continue;
    if (i % 2 == 0) require_positive(low.c_str(), lower[i], unit, "A joint without stiffness does not hold the tool");
    if (lower[i] > upper[i]) {
      throw InvalidInput(low, lower[i], unit, fmt::format("must not be above the upper bound of the {}", name));
    }
  }
  if (population < 4) throw InvalidInput("population", population, "individuals", "must be >= 4");
  if (generations < 1) throw InvalidInput("generations", generations, "generations", "must be >= 1");
  require_share("crossover", crossover);
  require_share("mutation_rate", mutation_rate);
  require_positive("noise_floor", noise_floor, "");
  require_share("noise_floor", noise_floor);
}

namespace {

/// Of a distributed joint, a line: the holder beside the shank makes it two beams.
double operations_of_point(const Holder& holder) {
  constexpr double on_ground = 300.0, in_holder = 1500.0;
  return holder.segments.empty() && holder.receptances.frfs.empty() ? on_ground : in_holder;
}

/// Each individual of each generation is a tip FRF.
void require_affordable_genes(const JointFitOptions& options, Index lines, const Joint& frame, const Holder& holder) {
  constexpr double operations_at_mouth = 6.0, bytes_of_individual = 200.0, usual = 50.0;
  const double operations_of_line = frame.points > 1 ? frame.points * operations_of_point(holder) : operations_at_mouth;
  const double population = options.population, generations = options.generations;
  require_affordable(
      {.operations = population * generations * (1e3 + operations_of_line * static_cast<double>(lines)),
       .bytes = bytes_of_individual * (population + generations),
       .dominant = dominant_of(
           {{.field = "population", .value = population, .unit = "individuals", .times_usual = population / usual},
            {.field = "generations",
             .value = generations,
             .unit = "generations",
             .times_usual = generations / usual}})});
}

/// An evolution on a part of the lines, and least squares with derivatives on all of them.
void require_affordable_points(const Joint& joint, const Holder& holder, Index lines) {
  constexpr double evaluations_of_part = 1e4, lines_of_part = 256.0, evaluations_of_all = 500.0;
  constexpr double bytes_of_point = 500.0, usual_points = 5.0;
  const double all = static_cast<double>(lines);
  require_affordable({.operations = joint.points * operations_of_point(holder) *
                                    (evaluations_of_part * std::min(all, lines_of_part) + evaluations_of_all * all),
                      .bytes = bytes_of_point * joint.points * all,
                      .dominant = {.field = "joint.points",
                                   .value = static_cast<double>(joint.points),
                                   .unit = "points",
                                   .times_usual = joint.points / usual_points}});
}

}  // namespace

JointFitResult fit_joint(const Assembly& assembly, const modal::FrfSet& measured, const JointFitOptions& options,
                         Progress& progress) {
  options.validate();
  const JointFitOptions bounded = with_bounds(options);
  const Joint frame = joint_frame(assembly, bounded);
  measured.validate();
  const modal::Frf& frf = tip_frf(measured, options.axis);

  JointFitResult result;
  const std::vector<Index> lines = fitted_lines(measured.frequency_hz, frf, result.notes);
  const Eigen::VectorXd frequency_hz = measured.frequency_hz(lines);
  if (options.method == JointMethod::ga) require_affordable_genes(options, frequency_hz.size(), frame, assembly.holder);
  if (options.method == JointMethod::hybrid && frame.points > 1)
    require_affordable_points(frame, assembly.holder, frequency_hz.size());
  detail::Base base = detail::base_receptances(assembly.holder, frequency_hz);
  result.notes.insert(result.notes.end(), base.notes.begin(), base.notes.end());
  note_suspects(measured, frf, base, result);
  const detail::JointModel model = model_of(assembly, frame, options.axis == Axis::x ? base.x : base.y, frequency_hz);
  detail::JointData data = detail::joint_data(frf, lines, options.noise_floor);
  detail::JointSearch search = options.method == JointMethod::ga
                                   ? detail::search_by_genes(model, data.measured, bounded, progress)
                                   : detail::search_by_evolution(model, data, bounded, progress);
  detail::update_deviation(model, search.joint, data);

  result.status = search.status;
  result.joint = frame;
  set_values(search.joint, result.joint);
  result.iterations = static_cast<int>(search.best.size());
  result.start = search.start;
  result.best = std::move(search.best);
  modal::Frf found{.name = frf.name, .receptance = {}};
  compare(model, search.joint, data.measured, found, result);
  result.model = {.frequency_hz = frequency_hz, .frfs = {std::move(found)}};
  result.knowledge = detail::joint_knowledge(model, search.joint, data, bounded, result.notes);
  if (result.status == JointFitResult::Status::stalled) result.notes.push_back(note_of_stall(result, bounded));
  return result;
}

}  // namespace robomill::coupling
