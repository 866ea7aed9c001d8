#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/jobs/verbs.hpp"
#include "verbs.hpp"

namespace robomill::app {

/// A verb with those that an option makes of it: "couple" and "couple --tools".
struct VerbGroup {
  std::string_view name = {};                 ///< "couple", "cell check"
  std::vector<const jobs::Verb*> verbs = {};  ///< the plain one first
  [[nodiscard]] const jobs::Verb& plain() const { return *verbs.front(); }
  /// Of all of them, each name once; those that every verb takes last.
  [[nodiscard]] std::vector<const jobs::VerbOption*> options() const;
};
/// Every verb: init, the jobs, then those that are no jobs.
[[nodiscard]] const std::vector<jobs::Verb>& all_verbs();
[[nodiscard]] std::vector<VerbGroup> verb_groups();

/// The option that makes a verb of a plain one: "--tools".
[[nodiscard]] std::string_view key_of(const jobs::Verb& verb);

/// What one value of an option is called in help: "FILE".
[[nodiscard]] const char* value_name(jobs::Takes takes);

/// Options that every verb takes; those after the first ones, verbs that compute.
[[nodiscard]] const std::vector<jobs::VerbOption>& common_options();

/// What the arguments ask for.
struct Asked {
  Common common;
  jobs::VerbJob job;
  std::vector<std::filesystem::path> outputs;  ///< where the verb writes, in whatever option that stands
};

/// The arguments, parsed by the records of the verbs.
class CommandLine {
 public:
  CommandLine();
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Prints help to standard output, or what is wrong with the arguments, whose bytes may be anybody's.
  /// @returns the exit code where that is all
  [[nodiscard]] std::optional<Exit> parse(int argc, const char* const* argv);
  /// @throws InvalidInput if the value of an option breaks a rule
  [[nodiscard]] Asked asked() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::app
