#include "robomill/process/files/decision_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/process/blocks/named_block.hpp"

namespace robomill::process {
namespace {

using decision::ProgramLimit;
using io::key;
using io::Row;
using io::Schema;
using io::Use;

/// How a limit is written: its name, its unit, and what that is in SI.
struct LimitWords {
  ProgramLimit limit;
  const char* name;
  const char* unit;
  double factor;
  bool at_least;
};
constexpr LimitWords limit_words[] = {
    {ProgramLimit::stability, "stability margin", "", 1.0, true},
    {ProgramLimit::force, "peak force", "N", 1.0, false},
    {ProgramLimit::torque, "torque, mean of a revolution,", "N·m", 1.0, false},
    {ProgramLimit::power, "sustained power", "kW", units::kw, false},
    {ProgramLimit::deflection, "deflection", "µm", units::um, false},
    {ProgramLimit::surface_error, "surface error", "µm", units::um, false},
    {ProgramLimit::greatest_chip, "chip thickness", "mm", units::mm, false},
    {ProgramLimit::least_chip, "chip thickness", "mm", units::mm, true},
    {ProgramLimit::cutting_speed, "cutting speed", "m/min", 1.0 / units::minute, false},
    {ProgramLimit::spindle_range, "spindle speed", "rpm", units::rpm, false},
    {ProgramLimit::tip_speed, "feed", "mm/min", units::mm / units::minute, false},
    {ProgramLimit::joint_speed, "speed of a joint", "°/s", units::deg, false},
    {ProgramLimit::joint_torque, "torque of a joint", "of its drive's", 1.0, false},
    {ProgramLimit::forced_vibration, "forced vibration", "µm", units::um, false},
    {ProgramLimit::reversal, "reversal of a joint's load", "", 1.0, false},
};

/// None of `none` and `posture`.
const LimitWords* words_of(ProgramLimit limit) {
  const auto* words = std::ranges::find(limit_words, limit, &LimitWords::limit);
  return words == std::end(limit_words) ? nullptr : words;
}

template <class E, std::size_t n>
std::vector<std::string> names_of(const Name<E> (&names)[n]) {
  std::vector<std::string> out;
  for (const auto& [name, value] : names) out.emplace_back(name);
  return out;
}

/// "chip thickness of 0.05 mm": the limit that a feed goes up to.
std::string reached_text(const decision::LimitUse& use) {
  const LimitWords* words = words_of(use.limit);
  if (words == nullptr) return "its programmed feed";
  const std::string unit = *words->unit == '\0' ? "" : std::string(" ") + words->unit;
  return fmt::format("{} of {:.3g}{}", words->name, use.allowed / words->factor, unit);
}

// What a table is written from: a part of the decision, with the program whose blocks it names.

template <class Part>
struct Of {
  const Part* part = nullptr;
  const ForcesResult* forces = nullptr;
  [[nodiscard]] std::size_t line(std::size_t block) const { return forces->program->program.blocks[block].line; }
};
template <class Part>
std::vector<Of<Part>> each_of(const std::vector<Part>& parts, const ForcesResult* forces) {
  std::vector<Of<Part>> out;
  out.reserve(parts.size());
  for (const Part& part : parts) out.push_back({&part, forces});
  return out;
}
/// Keys of the part itself.
template <class Part>
std::vector<Row<Of<Part>>> own(const std::vector<Row<Part>>& rows) {
  return io::keys_of<Of<Part>>(rows, [](const Of<Part>& at) -> const Part& { return *at.part; });
}

const Schema<Of<Violation>>& violation_table() {
  using At = Of<Violation>;
  const auto in_words = [](double value, const Violation& violation) {
    const LimitWords* words = words_of(violation.limit);
    return words != nullptr ? value / words->factor : value;
  };
  static const Schema<At> table(
      "violation", "the worst violation of a limit",
      {key(
           "limit", [](const At& at) { return at.part->limit; }, decision::program_limit_names, "which"),
       key(
           "block", [](const At& at) { return at.part->block + 1; }, "where"),
       key(
           "line", [](const At& at) { return at.line(at.part->block); }, "its line"),
       key(
           "value", [in_words](const At& at) { return in_words(at.part->value, *at.part); }, "in `unit`")
           .nullable(),
       key(
           "allowed", [in_words](const At& at) { return in_words(at.part->allowed, *at.part); }, "in `unit`")
           .nullable(),
       key(
           "unit",
           [](const At& at) {
             const LimitWords* words = words_of(at.part->limit);
             return words != nullptr ? words->unit : "";
           },
           "of both; empty: none")},
      Use::written);
  return table;
}

const Schema<Of<Outcome>>& outcome_table() {
  static const Schema<Of<Outcome>> table(
      "outcome", "what a program comes to",
      [] {
        std::vector<Row<Of<Outcome>>> rows = own<Outcome>(
            {key("cutting_time_s", &Outcome::cutting_time_s, "of the blocks that cut, by their feeds").nullable(),
             key("robot_time_s", &Outcome::robot_time_s, "of the robot's trajectory; none: not known").nullable(),
             key("total_time_s", &Outcome::total_time_s, "of the program").nullable(),
             key("lowest_spindle_speed_rpm", &Outcome::lowest_spindle_speed_rad_per_s, "while it cuts").nullable(),
             key("highest_spindle_speed_rpm", &Outcome::highest_spindle_speed_rad_per_s, "while it cuts").nullable(),
             key("unstable_blocks", &Outcome::unstable_blocks, "predicted to chatter"),
             key("uncertain_blocks", &Outcome::uncertain_blocks, "stable, with a margin below 0"),
             key("least_stability_margin", &Outcome::least_stability_margin, "of the blocks").nullable(),
             key("peak_force_n", &Outcome::peak_force_n, "largest").nullable(),
             key("revolution_torque_n_m", &Outcome::revolution_torque_n_m, "largest mean over a revolution").nullable(),
             key("sustained_power_w", &Outcome::sustained_power_w, "largest").nullable(),
             key("peak_deflection_um", &Outcome::peak_deflection_m, "largest, of the tip").nullable(),
             key("worst_surface_error_um", &Outcome::worst_surface_error_m, "of greatest magnitude").nullable(),
             key("peak_vibration_um", &Outcome::peak_vibration_m, "largest forced vibration").nullable(),
             key(
                 "greatest_torque_share",
                 [](const Outcome& outcome) { return io::if_positive(outcome.greatest_torque_share); },
                 "of a drive's limit; none: not known")
                 .nullable(),
             key("reversals", &Outcome::reversals, "blocks in which the load of a joint reverses")});
        rows.push_back(key(
            "violations", [](const Of<Outcome>& at) { return each_of(at.part->violations, at.forces); },
            violation_table(), "the worst of each limit"));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<Of<RejectedAlternative>>& alternative_table() {
  using At = Of<RejectedAlternative>;
  const auto slower = [](const At& at) { return at.part->speed.stopped_by.limit == ProgramLimit::none; };
  static const Schema<At> table(
      "rejected_alternative", "a speed that was not taken",
      {key(
           "spindle_speed_rpm", [](const At& at) { return at.part->speed.spindle_speed_rad_per_s; }, "spindle speed"),
       key(
           "stretch", [](const At& at) { return at.part->speed.stretch + 1; }, "of the program, from 1"),
       key(
           "cutting_time_s", [](const At& at) { return at.part->speed.cutting_time_s; }, "with it")
           .nullable(),
       key(
           "stopped_by",
           [slower](const At& at) {
             const std::string text = limit_text(at.part->speed.stopped_by);
             return slower(at) ? text : text + " in " + named_block(*at.forces, at.part->block);
           },
           "in words"),
       key(
           "limit",
           [slower](const At& at) { return slower(at) ? "" : decision::to_string(at.part->speed.stopped_by.limit); },
           "which; none: slower")
           .words(names_of(decision::program_limit_names))
           .nullable(),
       key(
           "block", [slower](const At& at) { return slower(at) ? std::nullopt : std::optional(at.part->block + 1); },
           "where")
           .nullable(),
       key(
           "line",
           [slower](const At& at) { return slower(at) ? std::nullopt : std::optional(at.line(at.part->block)); },
           "its line")
           .nullable()},
      Use::written);
  return table;
}

const Schema<Of<DecidedLines>>& stretch_table() {
  using At = Of<DecidedLines>;
  static const Schema<At> table(
      "decided_stretch", "lines that cut one after the other, at one spindle speed",
      {key(
           "first_block", [](const At& at) { return at.part->first_block + 1; }, "number in the program"),
       key(
           "last_block", [](const At& at) { return at.part->last_block + 1; }, "number in the program"),
       key(
           "first_line", [](const At& at) { return at.line(at.part->first_block); }, "its line"),
       key(
           "last_line", [](const At& at) { return at.line(at.part->last_block); }, "its line"),
       key(
           "spindle_speed_rpm", [](const At& at) { return at.part->spindle_speed_rad_per_s; }, "decided"),
       key(
           "lead_deg", [](const At& at) { return at.part->lead_rad; }, "from the programmed axis"),
       key(
           "tilt_deg", [](const At& at) { return at.part->tilt_rad; }, "from the programmed axis"),
       key(
           "lowest_feed_mm_per_min",
           [](const At& at) { return at.part->lowest_feed_m_per_s / units::mm * units::minute; }, "decided")
           .in_unit(),
       key(
           "highest_feed_mm_per_min",
           [](const At& at) { return at.part->highest_feed_m_per_s / units::mm * units::minute; }, "decided")
           .in_unit(),
       key(
           "cutting_time_s", [](const At& at) { return at.part->cutting_time_s; }, "of these lines"),
       key(
           "limited_by",
           [](const At& at) {
             return reached_text(at.part->limited_by) + " in " + named_block(*at.forces, at.part->limiting_block);
           },
           "in words")},
      Use::written);
  return table;
}

const Schema<GammaMap>& gamma_map_table() {
  static const Schema<GammaMap> table(
      "gamma_map", "stability margin over the path and the turn of the flange about the tool's axis",
      {key(
           "block",
           [](const GammaMap& map) {
             std::vector<std::size_t> out = map.block;
             for (std::size_t& block : out) ++block;
             return out;
           },
           "of each column"),
       key("path_mm", &GammaMap::path_m, "at the end of each"), key("gamma_deg", &GammaMap::gamma_rad, "of each row"),
       key("margin", &GammaMap::margin, "a row a turn; none: the robot cannot stand there").nullable(),
       key("chosen_deg", &GammaMap::chosen_rad, "of each column"),
       key(
           "programmed_deg", [](const GammaMap& map) { return std::vector<double>(map.chosen_rad.size(), 0.0); },
           "of each column"),
       key("least_margin", &GammaMap::least_margin, "of the chosen turns").nullable()},
      Use::written);
  return table;
}

const Schema<Compensation>& compensation_table() {
  static const Schema<Compensation> table(
      "compensation", "the path of finishing passes moved by the predicted deflection",
      {key(
           "settled", [](const Compensation& c) { return c.status == Compensation::Status::settled; },
           "offsets and what they do to the force agree"),
       key(
           "blocks",
           [](const Compensation& c) {
             return std::ranges::count_if(c.blocks, [](const CompensatedBlock& block) {
               return block.state == CompensatedBlock::State::compensated ||
                      block.state == CompensatedBlock::State::bounded;
             });
           },
           "that were moved"),
       key("passes", &Compensation::passes, "offsets that were tried"),
       key("rms_before_um", &Compensation::rms_before_m, "error of the surface").nullable(),
       key("rms_after_um", &Compensation::rms_after_m, "error of the surface").nullable(),
       key("largest_offset_um", &Compensation::largest_offset_m, "of a block's end").nullable()},
      Use::written);
  return table;
}

const Schema<DecisionView>& changes_table() {
  static const Schema<DecisionView> table(
      "decided_changes", "what the new program changes",
      {key(
           "lines", [](const DecisionView& view) { return view.output.changed_lines; },
           "of the text; none: there is no new one")
           .nullable(),
       key(
           "speeds", [](const DecisionView& view) { return view.decision->speeds_changed; }, "changes of S"),
       key(
           "feeds", [](const DecisionView& view) { return view.decision->feeds_changed; }, "changes of F")},
      Use::written);
  return table;
}

}  // namespace

std::string limit_text(const decision::LimitUse& use) {
  const LimitWords* words = words_of(use.limit);
  if (words == nullptr) return use.limit == ProgramLimit::posture ? "the robot cannot stand so" : "slower";
  const std::string unit = *words->unit == '\0' ? "" : std::string(" ") + words->unit;
  const bool both_sides = use.limit == ProgramLimit::cutting_speed || use.limit == ProgramLimit::spindle_range;
  const bool at_least = words->at_least || (both_sides && use.value < use.allowed);
  if (!both_sides && (at_least ? use.value >= use.allowed : use.value <= use.allowed)) {
    // What is predicted keeps the limit, but not with what is kept in reserve for the run through the material.
    return fmt::format("{} {:.3g}{}; {} {:.3g}{} and a reserve", words->name, use.value / words->factor, unit,
                       at_least ? "at least" : "at most", use.allowed / words->factor, unit);
  }
  return fmt::format("{} {:.3g}{}; {} {:.3g}{}", words->name, use.value / words->factor, unit,
                     at_least ? "at least" : "at most", use.allowed / words->factor, unit);
}

const Schema<DecisionView>& decision_table() {
  using View = DecisionView;
  static const Schema<View> table(
      "decision", "spindle speeds, feeds and γ of a program, as chosen",
      {key(
           "status",
           [](const View& v) { return v.decision->status == Decision::Status::found ? "found" : "infeasible"; },
           "whether conditions keep every limit")
           .words({"found", "infeasible"}),
       key(
           "reason", [](const View& v) { return v.decision->reason; }, "in words"),
       key(
           "goal", [](const View& v) { return v.options->goal; }, goal_names, "that was asked for"),
       key(
           "free",
           [](const View& v) {
             std::vector<std::string> out;
             for (const Free what : v.options->free) out.emplace_back(name_in(free_names, what));
             return out;
           },
           "what could be chosen")
           .words(names_of(free_names)),
       key(
           "collisions_checked", [](const View& v) { return v.output.collisions_checked; }, "along the way to run"),
       key(
           "evaluations", [](const View& v) { return v.decision->evaluations; }, "cuts computed"),
       key(
           "exact_runs", [](const View& v) { return v.decision->exact_runs; }, "of the whole program"),
       key(
           "seconds", [](const View& v) { return v.decision->seconds; }, "computing time"),
       key(
           "as_programmed",
           [](const View& v) {
             return Of<Outcome>{&v.decision->as_programmed, v.forces};
           },
           outcome_table(), "the program as it is"),
       key(
           "decided",
           [](const View& v) {
             return v.decision->decided ? std::optional(Of<Outcome>{&*v.decision->decided, v.forces}) : std::nullopt;
           },
           outcome_table(), "the program as decided")
           .nullable(),
       key(
           "alternatives", [](const View& v) { return each_of(v.decision->alternatives, v.forces); },
           alternative_table(), "speeds that were not taken"),
       key(
           "stretches", [](const View& v) { return each_of(v.decision->stretches, v.forces); }, stretch_table(),
           "of one speed each"),
       key(
           "notes", [](const View& v) { return v.decision->notes; }, "sentences for the user"),
       key(
           "compensation", [](const View& v) { return v.decision->compensation; }, compensation_table(),
           "where it was asked for")
           .nullable(),
       key(
           "gamma_map", [](const View& v) { return v.decision->gamma_map; }, gamma_map_table(), "where γ was free")
           .nullable(),
       key(
           "changes", [](const View& v) { return &v; }, changes_table(), "of the program")},
      Use::written);
  return table;
}

}  // namespace robomill::process
