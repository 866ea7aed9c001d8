#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/io/toml_source.hpp"

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// How values in a range are chosen.
enum class Sampling {
  grid,  ///< evenly, both ends among them
  lhs,   ///< Latin hypercube: one at random in each of `count` equal parts [McKay1979]
  sobol  ///< Sobol' sequence, shifted at random [JoeKuo2008]
};
inline constexpr Name<Sampling> sampling_names[] = {
    {"grid", Sampling::grid}, {"lhs", Sampling::lhs}, {"sobol", Sampling::sobol}};

/// Keys that vary together, and what they are set to: rows of values, or a range of one key.
struct Variation {
  std::vector<std::string> keys = {};  ///< of the base document: "cut.radial_depth_mm"; one, or the columns of a table
  std::vector<std::vector<std::string>> values = {};  ///< rows of one value a key, as TOML writes them
  std::array<double, 2> range = {0.0, 0.0};           ///< in the key's unit; where there are no values
  int count = 0;                                      ///< of values in the range, >= 1; >= 2 on a grid
  Sampling sampling = Sampling::grid;

  [[nodiscard]] bool is_sampled() const { return values.empty() && sampling != Sampling::grid; }
};

/// Where a value crosses a level, in place of all points of a grid (sweep/boundary.hpp). All keys have ranges on a
/// grid: the coarse one.
struct BoundaryTask {
  std::string value = {};  ///< that is collected
  double level = 1.0;      ///< in the value's unit
  int halvings = 4;        ///< of the grid's steps
  int most_points = 100'000;
  bool interpolate = true;  ///< as BoundaryOptions
};

/// Sobol' indices of all values that are collected (sweep/sensitivity.hpp) over the keys that are sampled, all by the
/// Sobol' sequence. Their count is `samples`; each sample is keys + 2 points.
struct SensitivityTask {
  int samples = 0;  ///< a power of two
};

/// How often values keep a condition over the keys that are sampled, at each combination of the others
/// (sweep/probability.hpp).
struct ProbabilityTask {
  std::vector<std::string> values = {};               ///< that are collected, in one unit
  std::optional<double> at_least = {}, at_most = {};  ///< in that unit; one of both
  double worst_share = 0.05;                          ///< of the quantile that the robust optimum is chosen by
};

/// What a study asks of a Slurm cluster: a job array, whose i-th of n tasks does the chunks i, i + n, ….
struct ROBOMILL_API SlurmSettings {
  int shards = 0;              ///< tasks, at most 100000; 0: the study is for no cluster
  double time_s = 0.0;         ///< that a task may take [s], >= 300; 0: what the cluster allows
  int memory_mb = 0;           ///< of a task [MiB]; 0: what the cluster allows
  int cpus = 1;                ///< of a task, each for a thread
  int restarts = 3;            ///< of a task that ended before its chunks were done
  std::string partition = {};  ///< empty: the cluster's default
  std::string account = {};    ///< the same

  /// @throws InvalidInput naming the member
  void validate() const;
};

/// study.toml: a job that is done again and again with other values of some keys.
///
/// What can be collected:
///   `limit@RPM`              lobes: lowest unstable depth at a speed [mm]; infinity: none in the document's range
///   `chatter_frequency@RPM`  lobes: at that limit [Hz]; NaN where there is none
///   `abs_mu@RPM,MM`          lobes: spectral radius at a speed and a depth
///   `a.b.2`                  any job: a number of its JSON document, by keys and places in lists, counted from 0
struct ROBOMILL_API Study {
  std::filesystem::path file = {};        ///< study.toml
  std::string job = {};                   ///< the verb: "lobes"
  std::filesystem::path base = {};        ///< its document
  std::string options = {};               ///< of the job: the text of a JSON object; empty: none
  std::vector<std::string> collect = {};  ///< what is kept of each result, see above
  int seed = 1;                           ///< of samples, >= 0
  std::vector<Variation> vary = {};
  int chunk_points = 0;  ///< points of a chunk; 0: as many as take a minute
  std::optional<BoundaryTask> boundary = {};
  std::optional<SensitivityTask> sensitivity = {};
  std::optional<ProbabilityTask> probability = {};
  SlurmSettings slurm = {};  ///< [slurm]
  std::vector<std::string> notes = {};

  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Whether a value as TOML writes it is a list.
[[nodiscard]] inline bool is_list_literal(std::string_view value) {
  return value.starts_with('[');
}

/// The points of a study: every value of each grid, list and table with every sample. Keys that are sampled in one way
/// are sampled together and have one count. The last of the varied keys changes fastest; samples of both kinds stand
/// where the first of their kind stands.
class ROBOMILL_API StudyPoints {
 public:
  /// @throws InvalidInput as Study::validate, or if there are more than 1e9
  explicit StudyPoints(const Study& study);
  /// No points; each is added.
  explicit StudyPoints(std::vector<std::string> keys);
  /// @param values  a value a key, as TOML writes it
  void add(std::vector<std::string> values);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The keys that vary, in the order of the study.
  [[nodiscard]] const std::vector<std::string>& keys() const { return keys_; }
  /// What they are set to at a point, in that order, as TOML writes it.
  [[nodiscard]] std::vector<std::string> values(std::size_t point) const;
  [[nodiscard]] std::vector<io::TomlSetting> settings(std::size_t point) const;
  /// Of each key, in that order, whether one of its values is a list.
  [[nodiscard]] std::vector<bool> with_lists() const;

  // The same points as combinations of the values that are not sampled, each with all samples.
  [[nodiscard]] std::size_t combinations() const { return combinations_; }
  [[nodiscard]] std::size_t samples() const { return size_ / combinations_; }
  [[nodiscard]] std::size_t point(std::size_t combination, std::size_t sample) const;
  /// The keys that are not sampled.
  [[nodiscard]] std::vector<io::TomlSetting> settled(std::size_t combination) const;

 private:
  /// Keys of one place in the product.
  struct Axis {
    std::vector<std::size_t> places = {};             ///< of its keys in keys_
    std::vector<std::vector<std::string>> rows = {};  ///< a value a key
    bool sampled = false;
    std::size_t stride = 1;  ///< points between two of its rows
  };
  void set_strides();
  std::vector<std::string> keys_ = {};
  std::vector<Axis> axes_ = {};
  std::size_t size_ = 1, combinations_ = 1;
};

}  // namespace robomill::jobs
