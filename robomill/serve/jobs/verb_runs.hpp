#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/jobs/verbs.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/serve/README.md, "Jobs"

namespace robomill::serve {

/// A request with paths that lead to its files, and its options.
class VerbJob {
 public:
  VerbJob(const JobRequest& request, const std::filesystem::path& root) : request_(request), root_(root) {}

  [[nodiscard]] std::filesystem::path input() const { return root_ / request_.inputs.front(); }
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const { return below(request_.inputs); }
  [[nodiscard]] std::filesystem::path output() const {
    return request_.output.empty() ? std::filesystem::path() : root_ / request_.output;
  }
  [[nodiscard]] bool has(const char* name) const { return request_.options.contains(name); }
  template <class Value>
  [[nodiscard]] Value get(const char* name, const Value& otherwise) const {
    return request_.options.value(name, otherwise);
  }
  [[nodiscard]] bool flag(const char* name) const { return get(name, false); }
  [[nodiscard]] std::uint64_t seed() const { return get("seed", std::uint64_t{1}); }
  /// Empty where it is not given.
  [[nodiscard]] std::filesystem::path file(const char* name) const {
    return has(name) ? root_ / get(name, std::string()) : std::filesystem::path();
  }
  [[nodiscard]] std::vector<std::filesystem::path> files(const char* name) const {
    return below(get(name, std::vector<std::string>()));
  }
  [[nodiscard]] std::vector<std::string> texts(const char* name) const { return get(name, std::vector<std::string>()); }
  [[nodiscard]] std::vector<double> numbers(const char* name, double unit = 1.0) const {
    std::vector<double> out = get(name, std::vector<double>());
    for (double& value : out) value *= unit;
    return out;
  }
  /// What a word stands for; nothing where it is not given.
  template <class Value, std::size_t n>
  [[nodiscard]] std::optional<Value> word(const char* name, const Name<Value> (&names)[n]) const {
    return value_in(names, get(name, std::string()));
  }
  [[nodiscard]] static stability::OperatingPoint point(const io::Json& pair) {
    return {.spindle_speed_rad_per_s = pair[0].get<double>() * units::rpm,
            .axial_depth_m = pair[1].get<double>() * units::mm};
  }
  [[nodiscard]] const io::Json& option(const char* name) const { return request_.options.at(name); }

 private:
  [[nodiscard]] std::vector<std::filesystem::path> below(const std::vector<std::string>& names) const {
    std::vector<std::filesystem::path> out;
    out.reserve(names.size());
    for (const std::string& name : names) out.push_back(root_ / name);
    return out;
  }
  const JobRequest& request_;
  const std::filesystem::path& root_;
};

/// One a verb: runs it, and writes its output.
/// @throws InvalidInput as the job; Interrupted
[[nodiscard]] JobOutcome run_plan(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_frf(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_modes(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_posture_modes(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_couple(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_tools(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_joint(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_lobes(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_simulate(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_explain(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_forces(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_coefficients(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_stiffness(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_cell_check(const VerbJob& job, Progress& progress);
[[nodiscard]] JobOutcome run_smooth(const VerbJob& job, Progress& progress);

}  // namespace robomill::serve
