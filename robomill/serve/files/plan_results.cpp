#include "robomill/serve/files/plan_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/files/kind.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;
using io::Json;

constexpr const char* plan_name = "plan.json";
constexpr std::uintmax_t longest_plan = std::uintmax_t{64} << 20;
constexpr int most_beside = 1000;  // entries of a folder
constexpr double percent = 0.01;

/// What an overview does not use, and what is long: it is not kept while the text is read.
bool is_left_out(const std::string& key, int depth) {
  constexpr std::array outermost = {"facts", "other_limits",    "pairs",  "limit_share",
                                    "cuts",  "feed_directions", "forces", "alternatives"};
  constexpr std::array inner = {"boundary",  "stabilisation",   "residuals",   "uncertainty",
                                "gamma_map", "spectral_radius", "convergence", "stretches"};
  return (depth == 1 && std::ranges::find(outermost, key) != outermost.end()) ||
         (depth == 2 && std::ranges::find(inner, key) != inner.end());
}

Json read_json_of(const fs::path& file) {
  const std::string text = io::read_file(file, longest_plan);
  const auto keeps = [](int depth, Json::parse_event_t event, const Json& parsed) {
    return event != Json::parse_event_t::key || !is_left_out(parsed.get_ref<const std::string&>(), depth);
  };
  Json plan = Json::parse(text, keeps, false);
  if (plan.is_discarded() || !plan.is_object()) throw InvalidInput(file.string(), "is no plan.json");
  return plan;
}

/// A value by its keys; null where there is none.
const Json& at(const Json& from, std::initializer_list<const char*> keys) {
  static const Json none;
  const Json* out = &from;
  for (const char* key : keys) {
    if (!out->is_object() || !out->contains(key)) return none;
    out = &(*out)[key];
  }
  return *out;
}

std::optional<double> number_at(const Json& from, std::initializer_list<const char*> keys) {
  const Json& found = at(from, keys);
  return found.is_number() ? std::optional(found.get<double>()) : std::nullopt;
}

std::string text_at(const Json& from, std::initializer_list<const char*> keys) {
  const Json& found = at(from, keys);
  return found.is_string() ? found.get<std::string>() : std::string();
}

bool is_false(const Json& value) {
  return value.is_boolean() && !value.get<bool>();
}

std::string counted(std::size_t count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

void read_hits(const Json& plan, PlanResults& out) {
  const Json& hits = at(plan, {"frf", "hits"});
  const Json& grades = at(plan, {"frf", "grades"});
  if (!hits.is_array() || hits.empty()) return;
  const auto good = std::ranges::count_if(hits, [](const Json& hit) { return at(hit, {"accepted"}) == true; });
  out.hits = fmt::format("{} of {} good", good, counted(hits.size(), "hit"));
  if (!grades.is_object()) return;
  for (const auto& [name, grade] : grades.items()) {
    out.frfs += fmt::format("{}{} {}", out.frfs.empty() ? "" : ", ", name, text_at(grade, {"grade"}));
  }
}

void read_modes(const Json& plan, PlanResults& out) {
  const Json& modes = at(plan, {"modes", "modes"});
  if (!modes.is_array()) return;
  out.modes = counted(modes.size(), "mode");
  if (const auto error = number_at(plan, {"modes", "fit", "relative_error"}))
    out.modes += fmt::format(", {:.1f} % off", *error / percent);
  out.modes_usable = !is_false(at(plan, {"modes", "fit", "usable"}));
}

/// At the recommended speed; without one the lowest of the chart.
void read_lobes(const Json& plan, PlanResults& out) {
  const auto speed = number_at(plan, {"recommended", "spindle_speed_rpm"});
  const auto limit = number_at(plan, {"recommended", "window_limit_mm"});
  if (speed && limit) {
    const bool chatters = at(plan, {"recommended", "window_chatter_frequency_hz"}).is_number();
    out.lobes =
        fmt::format(fmt::runtime(chatters ? "limit {:.3g} mm at {:.0f} rpm" : "no limit up to {:.3g} mm at {:.0f} rpm"),
                    *limit, *speed);
    return;
  }
  const Json& limits = at(plan, {"lobes", "limit"});
  if (!limits.is_array()) return;
  std::optional<double> lowest, lowest_speed;
  for (const Json& one : limits) {
    const auto depth = number_at(one, {"axial_depth_mm"});
    if (!depth || (lowest && *lowest <= *depth)) continue;
    lowest = depth;
    lowest_speed = number_at(one, {"spindle_speed_rpm"});
  }
  out.lobes = "no limit in the chart";
  if (lowest && lowest_speed) out.lobes = fmt::format("lowest limit {:.3g} mm at {:.0f} rpm", *lowest, *lowest_speed);
}

void read_program(const Json& plan, PlanResults& out) {
  const auto cutting = number_at(plan, {"blocks", "cutting"}), unstable = number_at(plan, {"blocks", "unstable"});
  const auto duration = number_at(plan, {"path", "duration_s"}), violations = number_at(plan, {"path", "violations"});
  if (cutting && unstable) out.program = fmt::format("{:.0f} of {:.0f} blocks chatter", *unstable, *cutting);
  if (!duration) return;
  out.program += fmt::format("{}path of {:.3g} s", out.program.empty() ? "" : "; ", *duration);
  if (violations && *violations > 0) out.program += fmt::format(" with {:.0f} samples beyond a limit", *violations);
}

void read_decision(const Json& plan, PlanResults& out) {
  if (at(plan, {"decision"}).is_object()) {
    out.decided = text_at(plan, {"decision", "status"}) == "found";
    const auto time = number_at(plan, {"decision", "decided", "total_time_s"}),
               before = number_at(plan, {"decision", "as_programmed", "total_time_s"});
    const auto margin = number_at(plan, {"decision", "decided", "least_stability_margin"});
    if (!out.decided) out.decision = text_at(plan, {"decision", "reason"});
    if (out.decided && time) out.decision = fmt::format("{:.3g} s", *time);
    if (out.decided && time && before) out.decision += fmt::format(", as programmed {:.3g} s", *before);
    if (out.decided && margin) out.decision += fmt::format("; least margin {:.0f} %", *margin / percent);
    return;
  }
  const auto speed = number_at(plan, {"recommended", "spindle_speed_rpm"}),
             depth = number_at(plan, {"recommended", "axial_depth_mm"});
  if (speed && depth) {
    out.decision = fmt::format("{:.3g} mm at {:.0f} rpm", *depth, *speed);
  } else {
    out.decision = text_at(plan, {"reason"});
    out.decided = out.decision.empty();
  }
}

PlanResults results_in(const fs::path& folder) {
  PlanResults out{.folder = folder};
  std::error_code ignored;
  out.made = fs::last_write_time(folder / plan_name, ignored);
  try {
    const Json plan = read_json_of(folder / plan_name);
    read_hits(plan, out);
    if (out.frfs.empty() && at(plan, {"assembly"}).is_object()) out.frfs = "predicted";
    read_modes(plan, out);
    if (at(plan, {"lobes"}).is_object()) read_lobes(plan, out);
    read_program(plan, out);
    read_decision(plan, out);
  } catch (const InvalidInput& error) {
    out.error = error;
  }
  return out;
}

/// Calls f with entries of a folder.
template <class F>
void each_entry(const fs::path& folder, F&& f) {
  std::error_code error;
  fs::directory_iterator it(folder, error);
  for (int seen = 0; !error && it != fs::directory_iterator() && seen < most_beside; it.increment(error), ++seen)
    f(*it);
}

/// The names of all jobs in a folder, without their endings.
std::vector<std::string> jobs_in(const fs::path& folder) {
  std::vector<std::string> out;
  each_entry(folder, [&](const fs::directory_entry& entry) {
    const fs::path& path = entry.path();
    if (io::format_of(path) == io::Format::toml && kind_of_file(path).kind == "job")
      out.push_back(path.stem().string());
  });
  return out;
}

/// "steel-plan" is named after "steel".
bool is_named_after(const std::string& folder, const std::string& job) {
  return folder.starts_with(job) &&
         (folder.size() == job.size() || std::string_view("-_. ").find(folder[job.size()]) != std::string_view::npos);
}

/// Folders beside a job that may be its plan's.
std::vector<fs::path> folders_beside(const fs::path& job) {
  std::vector<fs::path> out;
  const std::vector<std::string> jobs = jobs_in(job.parent_path());
  const std::string stem = job.stem().string();
  const auto is_its = [&](const std::string& name) {
    if (jobs.size() < 2 || (stem == "job" && (name == "out" || name == "plan"))) return true;
    const auto is_other = [&](const std::string& one) { return one.size() > stem.size() && is_named_after(name, one); };
    return is_named_after(name, stem) && std::ranges::none_of(jobs, is_other);
  };
  each_entry(job.parent_path(), [&](const fs::directory_entry& entry) {
    std::error_code ignored;
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') && entry.is_directory(ignored) && !entry.is_symlink(ignored) && is_its(name)) {
      out.push_back(entry.path());
    }
  });
  return out;
}

}  // namespace

fs::path find_plan(const fs::path& job, const std::vector<fs::path>& written) {
  std::vector<fs::path> folders = written;
  std::ranges::move(folders_beside(job), std::back_inserter(folders));
  fs::path newest;
  fs::file_time_type made;
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::file_time_type time = fs::last_write_time(folder / plan_name, error);
    if (error || (!newest.empty() && time <= made)) continue;
    newest = folder;
    made = time;
  }
  return newest;
}

const PlanResults& PlanReader::read(const fs::path& folder) {
  std::error_code ignored;
  const fs::file_time_type made = fs::last_write_time(folder / plan_name, ignored);
  const auto known = kept_.find(folder);
  if (known != kept_.end() && known->second.made == made && !known->second.error) return known->second;
  if (kept_.size() >= most_kept) kept_.clear();
  return kept_[folder] = results_in(folder);
}

}  // namespace robomill::serve
