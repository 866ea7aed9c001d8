#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/sweep/study.hpp"
#include "robomill/jobs/verbs.hpp"

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// What became of a point.
enum class PointState : std::uint8_t {
  done,      ///< its values hold; one that the result does not have is NaN
  short_of,  ///< the same, but the verb did not reach its answer (exit 3)
  rejected   ///< its document is not valid: no values
};
inline constexpr Name<PointState> point_state_names[] = {
    {"done", PointState::done}, {"short", PointState::short_of}, {"rejected", PointState::rejected}};

struct PointOutcome {
  PointState state = PointState::done;
  std::vector<double> values = {};  ///< one for each of Study::collect
  std::string reason = {};          ///< why it is not done; one line
};

/// Of what a study collects: "mm" of "limit@8000"; empty where its name states none.
[[nodiscard]] std::string unit_of_collected(const std::string& name);

/// Does the job of a study with other values of its keys. Of any thread.
class Evaluator {
 public:
  /// @throws InvalidInput naming job or collect
  explicit Evaluator(const Study& study);
  ~Evaluator();
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  /// What breaks a rule of the document is an outcome. @throws Interrupted
  [[nodiscard]] PointOutcome at(const std::vector<io::TomlSetting>& settings, Progress& progress) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::jobs
