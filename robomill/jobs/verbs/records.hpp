#pragma once
// The records of the verbs, by the data that they take, and what their runs have in common.
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/verbs.hpp"
#include "robomill/jobs/verbs/new_option.hpp"

namespace robomill::jobs {

[[nodiscard]] std::vector<Verb> structure_verbs();  ///< hits, FRFs, modes, the tool in its holder
[[nodiscard]] std::vector<Verb> cut_verbs();        ///< stability, motion and forces of a cut
[[nodiscard]] std::vector<Verb> robot_verbs();      ///< the robot under load, and along a program
[[nodiscard]] Verb calibrate_verb();
[[nodiscard]] Verb sweep_verb();

[[nodiscard]] inline VerbOption seed_option() {
  return whole_option("seed", "seed of random numbers (default: 1)", 0);
}

/// Where an arm begins a program.
[[nodiscard]] inline VerbOption posture_option(std::string_view needs = {}) {
  return {.name = "posture_deg",
          .meaning = "begin the program as near to q1,q2,… as possible, in degrees (default: as at home)",
          .takes = Takes::numbers,
          .flag = "--posture",
          .needs = needs,
          .unit = "deg"};
}

/// Of a result that is written already.
template <class Result>
Outcome outcome_of(Result result, std::string json = {}) {
  using jobs::summary;  // a result may bring its own
  auto kept = std::make_shared<const Result>(std::move(result));
  Outcome out = {
      .shortfall = shortfall(*kept), .summary = summary(*kept), .json = {}, .page = [kept] { return page_of(*kept); }};
  out.json = std::move(json);
  return out;
}

/// Writes what was found where the job asks for it.
/// @param how  more of write_document
template <class Result, class... How>
Outcome finished(const VerbJob& job, Result result, How&&... how) {
  if (!job.output.empty()) write_document(job.output, result, std::forward<How>(how)...);
  std::string json = job.wants_json ? document(result, io::Format::json) : std::string();
  return outcome_of(std::move(result), std::move(json));
}

/// Does work whose errors about a member are about an option.
template <class Work>
auto with_option(const VerbJob& job, std::string_view member, std::string_view option, double unit, Work&& work) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    throw job.about_option(error, member, option, unit);
  }
}

/// The same of posture_option().
template <class Work>
auto with_posture(const VerbJob& job, Work&& work) {
  return with_option(job, "--posture", "posture_deg", 1.0, work);
}

}  // namespace robomill::jobs
