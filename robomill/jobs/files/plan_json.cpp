#include "robomill/jobs/files/plan_json.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/decision/files/result_schema.hpp"
#include "robomill/modal/files/frf_schema.hpp"
#include "robomill/modal/files/modes_schema.hpp"
#include "robomill/page/thin.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/process/files/blocks_json.hpp"
#include "robomill/process/files/decision_json.hpp"
#include "robomill/process/files/forces_schema.hpp"
#include "robomill/stability/files/lobes_schema.hpp"

namespace robomill::jobs {
namespace {

using io::Json;
using io::key;
using io::Row;
using io::Schema;
using io::Use;
using process::Fact;

std::vector<Fact> facts_of(const PlanResult& result) {
  const cutting::Milling& cut = result.cut.problem.milling;
  return {{"Cutter", fmt::format("{} teeth, {:.4g} mm, helix {:.3g}°", cut.tool.teeth, cut.tool.diameter_m / units::mm,
                                 cut.tool.helix_rad / units::deg)},
          {"Cut", fmt::format("radial depth {:.4g} mm, teeth in cut from {:.1f}° to {:.1f}°, {:.4g} mm a tooth",
                              result.cut.radial_depth_m / units::mm, cut.immersion.entry_rad / units::deg,
                              cut.immersion.exit_rad / units::deg, cut.feed_per_tooth_m / units::mm)},
          {"Material", fmt::format("tangential {:.4g} N/mm², radial {:.4g} N/mm²",
                                   cut.coefficients.tangential_n_per_m2 / units::n_per_mm2,
                                   cut.coefficients.radial_n_per_m2 / units::n_per_mm2)},
          {"Feed direction", fmt::format("{:.4g}° from x", result.cut.problem.feed_direction_rad / units::deg)}};
}

/// The plan with or without the documents of its stages.
struct PlanView {
  const PlanResult* result = nullptr;
  bool stages = true;
};
std::optional<process::DecisionView> decision_of(const PlanResult& result) {
  if (!result.decision) return std::nullopt;
  process::DecisionView out{.decision = &*result.decision,
                            .forces = &*result.shown().forces,
                            .options = &result.job.decide,
                            .output = {.collisions_checked = collisions_checked(result)}};
  if (result.decided && result.decided->text) out.output.changed_lines = result.decided->text->changed_lines;
  return out;
}

std::vector<Row<PlanResult>> decision_keys() {
  using Plan = PlanResult;
  return {
      where([](const Plan& plan) { return plan.recommends(); },
            key(
                "facts", [](const Plan& plan) { return facts_of(plan); }, process::fact_table(), "in words")),
      key(
          "agreement", [](const Plan& plan) { return decision::agreement(plan.cuts); }, decision::agreement_table(),
          "of the test cuts"),
      key(
          "recommended", [](const Plan& plan) { return plan.recommendation.recommended; }, decision::operation_table(),
          "none: see reason")
          .nullable(),
      key(
          "alternatives", [](const Plan& plan) { return plan.recommendation.alternatives; },
          decision::operation_table(), "by falling removal rate"),
      where([](const Plan& plan) { return !plan.recommendation.recommended; },
            key(
                "reason", [](const Plan& plan) { return plan.recommendation.reason; }, "why there is none")),
      key(
          "finishing", [](const Plan& plan) { return plan.job.finish; }, decision::asked_finish_table(), "of the job"),
      key(
          "other_limits",
          [](const Plan& plan) {
            return plan.recommends()
                       ? decision::other_limits(plan.cut.problem.milling, plan.job.recommend, plan.cut.options)
                       : std::vector<decision::DepthCurve>();
          },
          decision::curve_table(), "beside chatter"),
      key("pairs", &Plan::pairs, decision::pair_table(), "of neighbouring modes"),
      key(
          "limit_share",
          [](const Plan& plan) {
            return decision::limit_share(plan.lobes.limit, plan.model, plan.cut.problem.workpiece_dynamics);
          },
          decision::share_table(), "of the modes"),
      key("cuts", &Plan::cuts, decision::cut_table(), "test cuts"),
      where([](const Plan& plan) { return plan.feed_directions.has_value(); },
            key(
                "feed_direction_deg", [](const Plan& plan) { return plan.cut.problem.feed_direction_rad; },
                "of the cut, from x")),
      where([](const Plan& plan) { return plan.feed_directions.has_value(); },
            key(
                "feed_directions",
                [](const Plan& plan) {
                  std::vector<decision::DirectionView> out;
                  for (Eigen::Index i = 0; i < plan.feed_directions->direction_rad.size(); ++i)
                    out.push_back({&*plan.feed_directions, i});
                  return out;
                },
                decision::direction_table(), "the limit in each")),
      where([](const Plan& plan) { return plan.hits.has_value(); },
            key("hit_directions", &Plan::hit_directions, "of each hit")),
      key(
          "decision", [](const Plan& plan) { return decision_of(plan); }, process::decision_table(), "of the program")
          .optional(),
      key("warnings", &Plan::warnings, "sentences for the user"),
      key("notes", &Plan::notes, "sentences for the user")};
}

/// The documents of the stages.
std::vector<Row<PlanResult>> stage_keys() {
  using Plan = PlanResult;
  return {key("assumed", &Plan::assumed, io::assumption_table(), "what the input did not give"),
          key(
              "assembly", [](const Plan& plan) { return plan.prediction ? &*plan.prediction : nullptr; },
              assembly_table(), "of a job that starts from it")
              .optional(),
          key(
              "frf", [](const Plan& plan) { return plan.hits ? &*plan.hits : nullptr; }, modal::hits_table(),
              "of a job that starts from hits")
              .optional(),
          where([](const Plan& plan) { return plan.job.has_structure(); },
                key(
                    "modes",
                    [](const Plan& plan) {
                      return modal::ModesView{.model = plan.fit ? &plan.fit->model : &plan.model,
                                              .fit = plan.fit ? &*plan.fit : nullptr};
                    },
                    modal::modes_table(), "of the tool")),
          where([](const Plan& plan) { return plan.has_lobes(); },
                key(
                    "lobes", [](const Plan& plan) { return stability::LobesView(plan.lobes, plan.uncertain, {}); },
                    stability::lobes_table(), "of all modes")),
          where([](const Plan& plan) { return plan.shown().forces.has_value(); },
                key(
                    "forces", [](const Plan& plan) { return &*plan.shown().forces; }, process::forces_table(),
                    "along the program")),
          where([](const Plan& plan) { return plan.shown().blocks.has_value(); },
                key(
                    "blocks",
                    [](const Plan& plan) {
                      return process::BlocksView{&*plan.shown().forces, &*plan.shown().blocks};
                    },
                    process::blocks_summary_table(), "of the program")),
          where([](const Plan& plan) { return plan.shown().path.has_value(); },
                key(
                    "path", [](const Plan& plan) { return &plan.shown().path->smoothed; }, path::smooth_table(),
                    "of the program"))};
}

/// A long recording's spectrum is thinned before it is text, by the page's own rule.
decision::Recording thinned(decision::Recording recording) {
  const std::vector<Eigen::Index> keep = page::thin(recording.amplitude);
  recording.frequency_hz = recording.frequency_hz(keep).eval();
  recording.amplitude = recording.amplitude(keep).eval();
  return recording;
}

}  // namespace

const Schema<PlanResult>& recordings_table() {
  static const Schema<PlanResult> table("recordings", "what is recorded of test cuts for the page alone: their spectra",
                                        {key(
                                            "recordings",
                                            [](const PlanResult& result) {
                                              std::vector<decision::Recording> out;
                                              for (const decision::Recording& recording : result.recordings)
                                                out.push_back(thinned(recording));
                                              return out;
                                            },
                                            decision::recording_table(), "one a recorded cut")},
                                        Use::written, 1);
  return table;
}

namespace {

const Schema<PlanView>& plan_view_table() {
  static const Schema<PlanView> table(
      "plan", "a job: what is recommended, and the documents of its stages",
      [] {
        const auto result = [](const PlanView& view) -> const PlanResult& { return *view.result; };
        std::vector<Row<PlanView>> rows = io::keys_of<PlanView>(decision_keys(), result);
        for (Row<PlanView>& row : io::keys_of<PlanView>(stage_keys(), result))
          rows.push_back(where([](const PlanView& view) { return view.stages; }, std::move(row)));
        return rows;
      }(),
      Use::written, 1);
  return table;
}

}  // namespace

const io::TableInfo& plan_table() {
  return plan_view_table().info();
}

Json decision_json(const PlanResult& result) {
  return plan_view_table().write({.result = &result, .stages = false});
}

Json plan_object(const PlanResult& result) {
  return plan_view_table().write({.result = &result});
}

std::string plan_text(const Json& plan) {
  return plan.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plan_json(const PlanResult& result) {
  return plan_text(plan_object(result));
}

}  // namespace robomill::jobs
