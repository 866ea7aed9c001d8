#include "robomill/jobs/planned_cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/plan_stages.hpp"

namespace robomill::jobs {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_job_bytes = std::uintmax_t{1} << 20;

/// Whether what the structure of a job comes from is there.
bool is_measured(const Job& job) {
  std::vector<fs::path> sources = job.frf;
  sources.insert(sources.end(), {job.hits, job.modes, job.assembly});
  std::erase(sources, fs::path());
  std::error_code error;
  return job.has_structure() &&
         std::ranges::all_of(sources, [&](const fs::path& path) { return fs::exists(path, error); });
}

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return a.lexically_normal() == b.lexically_normal() || fs::equivalent(a, b, error);
}

/// Whether a document is a job that measures or predicts a structure, and names the cut or is it.
bool plans(const fs::path& document, const fs::path& lobes) {
  try {
    const std::string text = io::read_file(document, largest_job_bytes);
    if (text.find("job") == std::string::npos) return false;
    const io::TomlSource source(document, text);
    if (!io::TomlFile(source).has("job")) return false;
    const Job job = read_job(source);
    return is_measured(job) && (is_same(document, lobes) || is_same(job.lobes, lobes));
  } catch (const InvalidInput&) {
    return false;  // another document, or a job that cannot be planned
  }
}

}  // namespace

std::vector<fs::path> jobs_of_cut(const fs::path& lobes) {
  if (plans(lobes, lobes)) return {lobes};
  const fs::path folder = lobes.parent_path().empty() ? fs::path(".") : lobes.parent_path();
  std::vector<fs::path> out;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path path = lobes.parent_path() / entry->path().filename();
    if (io::format_of(path) == io::Format::toml && plans(path, lobes)) out.push_back(path);
  }
  std::ranges::sort(out);
  return out;
}

std::string several_jobs_text(const std::vector<fs::path>& jobs, const fs::path& lobes) {
  std::string names;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (i > 0) names += i + 1 == jobs.size() ? " and " : ", ";
    names += jobs[i].filename().string();
  }
  return fmt::format("{} plan the cut of {}: the structure of none of them was taken, nor their range of speeds.",
                     names, lobes.filename().string());
}

std::string other_structure_text(const fs::path& job, const LobesFile& cut) {
  const Job plan = read_job(io::TomlSource(job, io::read_file(job, largest_job_bytes)));
  if (!plan.modes.empty() && !cut.modes.empty() && is_same(plan.modes, cut.modes)) return {};
  return fmt::format("{} plans this cut with the structure {}, not with [dynamics] of {}.", job.filename().string(),
                     plan.assembly.empty() ? "of its own measurement" : "that its assembly predicts",
                     cut.path.filename().string());
}

void take_plan(LobesFile& cut, const PlanResult& structure) {
  cut.drop_dynamics();
  load_dynamics(cut);
  cut.problem.dynamics = structure.model;
  if (std::string text = cover_spindle(cut, structure.job.recommend); !text.empty()) {
    cut.notes.push_back(std::move(text));
  }
  add_assumed(cut.assumed, structure.assumed);
  for (const std::string& text : structure.warnings) {
    cut.notes.push_back(fmt::format("{}{}", io::warning_label, text));
  }
  cut.notes.push_back(
      fmt::format("The structure and the range of speeds are those of {}.", structure.job.file.filename().string()));
}

}  // namespace robomill::jobs
