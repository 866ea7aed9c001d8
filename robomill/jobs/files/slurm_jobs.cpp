#include "robomill/jobs/files/slurm_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/system/output_places.hpp"
#include "robomill/io/system/program.hpp"
#include "robomill/io/text.hpp"

namespace robomill::jobs {
namespace {

constexpr const char* jobs_name = "jobs.json";

bool is_job_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// What a program said, as one line.
std::string in_one_line(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!blank)
      out += c;
    else if (!out.empty() && out.back() != ' ')
      out += ' ';
  }
  return printable(io::trimmed(out));
}

/// @param options  of sbatch. @returns the job's number
std::string submitted(const std::filesystem::path& script, std::vector<std::string> options, const std::string& hint) {
  std::vector<std::string> words = {"sbatch", "--parsable"};
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(script.string());
  const io::ProgramEnd end = io::run_program(std::move(words));
  if (!end.started) {
    throw InvalidInput("sbatch", "cannot be started: " + end.complaint,
                       "Slurm's programs must be on PATH. --slurm --dry-run shows the scripts");
  }
  std::string number = end.said.substr(0, end.said.find_first_of(";\n"));  // NUMBER;CLUSTER of several clusters
  if (end.code == 0 && is_job_number(number)) return number;
  const std::string said = in_one_line(end.complaint + " " + end.said);
  throw InvalidInput(
      "sbatch",
      fmt::format("did not take {}: {}", script.string(), said.empty() ? fmt::format("exit code {}", end.code) : said),
      hint);
}

/// What a program prints; empty where it is not there or fails.
std::string answer_of(std::vector<std::string> words) {
  const io::ProgramEnd end = io::run_program(std::move(words), {.time = std::chrono::seconds(30)});
  return end.started && end.code == 0 ? end.said : std::string();
}

}  // namespace

const io::Schema<SlurmJobs>& slurm_jobs_table() {
  static const io::Schema<SlurmJobs> table(
      "slurm_jobs", "a study's jobs on a cluster",
      {io::key("array", &SlurmJobs::array, "number of the job array"),
       io::key("merge", &SlurmJobs::merge,
               "number of the job that writes the tables; empty: it could not be submitted"),
       io::key("shards", &SlurmJobs::shards, "tasks of the array")},
      io::Use::written, 1);
  return table;
}

std::optional<SlurmJobs> SlurmFolder::jobs() const {
  const std::filesystem::path path = at(jobs_name);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  const io::ReadBack own(folder_);
  const io::Json json = io::read_json(path);
  const io::JsonNode root(json, path.string());
  SlurmJobs out{.array = root.at("array").text(), .merge = root.at("merge").text()};
  const double shards = root.at("shards").number();
  if (!(shards >= 1.0 && shards <= 1e6)) throw root.at("shards").reject("must be a count");
  if (!is_job_number(out.array)) throw root.at("array").reject("must be a job's number");
  if (!out.merge.empty() && !is_job_number(out.merge)) throw root.at("merge").reject("must be a job's number");
  out.shards = static_cast<int>(shards);
  return out;
}

SlurmJobs SlurmFolder::submit(const SlurmScripts& scripts, int shards) const {
  io::make_folder(folder_);
  io::write_file(at("array.sh"), scripts.array);
  io::write_file(at("merge.sh"), scripts.merge);
  SlurmJobs out{.shards = shards};
  out.array = submitted(at("array.sh"), {}, "Change [slurm] of the study");
  io::write_file(at(jobs_name), io::dump(slurm_jobs_table().write(out)));
  const std::string after = "--dependency=afterany:" + out.array;
  out.merge =
      submitted(at("merge.sh"), {after},
                fmt::format("The array is job {}. By hand: sbatch {} {}", out.array, after, at("merge.sh").string()));
  io::write_file(at(jobs_name), io::dump(slurm_jobs_table().write(out)));
  return out;
}

SlurmStates SlurmFolder::states(const std::string& array) {
  SlurmStates out = states_of_squeue(
      answer_of({"squeue", "--noheader", "--array", "--states=all", "--format=%K|%T", "--jobs=" + array}));
  // After some minutes squeue does not know a task that has ended; sacct does, where the cluster keeps accounts.
  out.merge(states_of_sacct(
      answer_of({"sacct", "--noheader", "--parsable2", "--allocations", "--format=JobID,State", "--jobs=" + array})));
  return out;
}

std::string SlurmFolder::state(const std::string& job) {
  if (job.empty()) return {};
  std::string out = answer_of({"squeue", "--noheader", "--states=all", "--format=%T", "--jobs=" + job});
  if (out.empty())
    out = answer_of({"sacct", "--noheader", "--parsable2", "--allocations", "--format=State", "--jobs=" + job});
  return out.substr(0, out.find_first_of(" +\r\n"));
}

std::string slurm_program() {
  if (const char* named = std::getenv("ROBOMILL"); named != nullptr && *named != '\0') return named;
  std::error_code error;
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
  return !error && own.filename() == "robomill" ? own.string() : "robomill";
}

}  // namespace robomill::jobs
