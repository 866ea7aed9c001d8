#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/decision/limit_breakdown.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/decision/test_cuts.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/hits.hpp"
#include "robomill/monitor/files/monitor_plan.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/process/turned.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/uncertainty.hpp"

// Method: robomill/jobs/README.md, "What `robomill plan` does (`plan.hpp`)"

namespace robomill::jobs {

/// A program with what the job found of it. What the job did not ask for is empty.
struct PlannedProgram {
  std::optional<process::ForcesResult> forces = {};   ///< of a job without a program, over one revolution
  std::optional<process::ProgramBlocks> blocks = {};  ///< of a job with forces, a cell and a program
  std::optional<process::SmoothResult> path = {};     ///< of a job with a program and a cell with [smoothing]
};

/// A program at the conditions that were decided.
struct DecidedProgram : PlannedProgram {
  std::optional<program::Rewritten> text = {};          ///< in its dialect; none: on its way it strikes something
  std::string name = {};                                ///< of its file
  std::optional<monitor::PlannedMonitor> monitor = {};  ///< none where there is no text
};

/// Everything a job came to, stage by stage. What the job did not ask for is empty.
struct PlanResult {
  Job job;
  LobesFile cut;                            ///< with the dynamics that the job gave
  std::optional<modal::FrfResult> hits;     ///< of a job that starts from hits
  std::vector<std::string> hit_directions;  ///< one a hit: "x", "-y"
  std::optional<TipPrediction> prediction;  ///< of a job that starts from an assembly
  std::optional<modal::FrfSet> frfs;        ///< measured, from hits or files, or predicted
  double added_decay_per_s = 0.0;           ///< of an exponential window, still in frfs
  std::optional<modal::FitResult> fit;      ///< unless the job starts from modes
  modal::ModalModel model;
  stability::LobesResult lobes;             ///< of all modes; empty where these do not describe the FRFs
  stability::UncertainLimits uncertain;     ///< samples: 0 where nothing is known to be uncertain
  std::vector<decision::PartLimits> pairs;  ///< of modes 1–2, 3–4, …
  std::optional<decision::FeedDirections> feed_directions;
  decision::Recommendation recommendation;
  PlannedProgram programmed;                      ///< the program as it is
  std::optional<process::BlocksJudging> judging;  ///< how its blocks were judged
  std::optional<process::Decision> decision;      ///< of a job that judges blocks and leaves something free
  std::optional<DecidedProgram> decided;          ///< where the decision found conditions
  std::vector<decision::ComparedCut> cuts;
  std::vector<decision::Recording> recordings;
  std::vector<std::string> warnings, notes;
  std::vector<Assumption> assumed;  ///< of all stages

  /// The program whose numbers documents show: as decided, where it was, else as it is.
  [[nodiscard]] const PlannedProgram& shown() const { return decided ? *decided : programmed; }
  [[nodiscard]] bool has_lobes() const { return !lobes.limit.empty(); }
  /// Whether the job chooses depth and speed; else it judges the blocks of its program alone.
  [[nodiscard]] bool recommends() const { return !job.lobes.empty(); }
};

/// The seed of a plan where nobody gives one, and of what repeats a part of it.
inline constexpr std::uint64_t default_seed = 1;

/// Runs a job: hits, or tool and holder, ─▶ FRFs ─▶ modes ─▶ lobes ─▶ a recommended speed and depth, and its comparison
/// with test cuts.
/// @param seed    of every random number
/// @param folder  for the trajectory of a program, made where it is missing; write_plan() puts it there in its place.
///     Empty: none is written
/// @param accept_fit  go on with modes that do not describe the FRFs (modal::FitResult::usable); else the result ends
///     with the fit, and the recommendation says why
/// @param near_deg  joints of the cell's arm that a program begins near, in place of robot.start_joints_deg; empty:
/// that
/// @throws InvalidInput with file, line, key and value; Interrupted
[[nodiscard]] ROBOMILL_API PlanResult run_job(const io::TomlSource& job, std::uint64_t seed,
                                              Progress& progress = Progress::none(),
                                              const std::filesystem::path& folder = {}, bool accept_fit = false,
                                              const std::vector<double>& near_deg = {});

/// The structure of a job as run_job() finds it: its FRFs, their fit and the modes, with warnings and what is assumed.
/// @throws InvalidInput as run_job(), and where the modes do not describe the FRFs; Interrupted
[[nodiscard]] ROBOMILL_API PlanResult run_structure(const std::filesystem::path& job, std::uint64_t seed,
                                                    Progress& progress = Progress::none());

/// The blocks of the program that the plan shows, for judge_turned. They refer to the plan.
/// @throws InvalidInput if the plan has no judged blocks
[[nodiscard]] ROBOMILL_API process::JudgedProgram judged_program(const PlanResult& result);

/// Whether the way of the program that is to run was checked for collisions: along its trajectory, or without one from
/// block to block.
[[nodiscard]] ROBOMILL_API bool collisions_checked(const PlanResult& result);

/// Whether the job has the answer that it is for: conditions or a recommendation within every limit, a path that holds.
[[nodiscard]] ROBOMILL_API bool reached(const PlanResult& result);

/// plan.json as text: the recommendation, its alternatives, the test cuts, and every stage's result.
[[nodiscard]] ROBOMILL_API std::string plan_json(const PlanResult& result);

/// Writes report.html, plan.json and each stage's own files (tip.uff, modes.json, lobes.json) into a folder, which is
/// made where it is missing. Each file appears whole or not at all; the trajectory where run_job() was asked to.
ROBOMILL_API void write_plan(const std::filesystem::path& folder, const PlanResult& result);

}  // namespace robomill::jobs
