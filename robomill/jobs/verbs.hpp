#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/page/report.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/jobs/README.md, "Verbs (`verbs.hpp`)"

namespace robomill::jobs {

struct PlanResult;

/// The value of an option, as JSON.
enum class Takes {
  flag,        ///< true, false
  whole,       ///< a whole number
  number,      ///< a number
  numbers,     ///< a list of them
  text,        ///< a text
  texts,       ///< a list of texts
  word,        ///< one of some words
  file,        ///< a path
  files,       ///< a list of paths
  new_file,    ///< a path that is written
  new_folder,  ///< …
  point,       ///< [spindle speed in rpm, depth in mm]
  points       ///< a list of them
};
inline constexpr Name<Takes> takes_names[] = {{"flag", Takes::flag},
                                              {"whole", Takes::whole},
                                              {"number", Takes::number},
                                              {"numbers", Takes::numbers},
                                              {"text", Takes::text},
                                              {"texts", Takes::texts},
                                              {"word", Takes::word},
                                              {"file", Takes::file},
                                              {"files", Takes::files},
                                              {"new_file", Takes::new_file},
                                              {"new_folder", Takes::new_folder},
                                              {"point", Takes::point},
                                              {"points", Takes::points}};

/// An option of a verb, or its input.
struct VerbOption {
  std::string_view name = {};     ///< in a request, with its unit: "band_hz"
  std::string_view meaning = {};  ///< a line, with its default
  Takes takes = Takes::flag;
  bool required = false;
  bool job_gives = false;                                   ///< … but where the input is a job.toml
  std::string_view flag = {};                               ///< on the command line, where that is not --NAME: "--band"
  std::string_view needs = {};                              ///< the option without which it has no meaning
  std::string_view excludes = {};                           ///< … and the one beside which it has none
  std::vector<std::string_view> words = {};                 ///< of a word
  std::vector<std::string_view> kinds = {};                 ///< of a file: what the page proposes
  std::string_view unit = {};                               ///< of numbers, for messages; "rpm": a spindle's speed
  std::size_t count = 0;                                    ///< of numbers; 0: as many as there are
  double above = -std::numeric_limits<double>::infinity();  ///< each number is greater …
  double at_least = -std::numeric_limits<double>::infinity();  ///< … and no less
  double at_most = std::numeric_limits<double>::infinity();
};

/// "--band".
[[nodiscard]] ROBOMILL_API std::string command_line_name(const VerbOption& option);

/// The words of a table of names.
template <class Value, std::size_t n>
[[nodiscard]] std::vector<std::string_view> words_of(const Name<Value> (&names)[n]) {
  std::vector<std::string_view> words;
  for (const auto& [word, value] : names) words.push_back(word);
  return words;
}

/// Who asks: a request over HTTP or the command line. Messages name an option as it is written there.
enum class AskedBy { request, command_line };

struct Verb;

/// What is asked of a verb, its options checked.
struct ROBOMILL_API VerbJob {
  const Verb& verb;
  AskedBy asked_by = AskedBy::request;
  std::vector<std::filesystem::path> inputs = {};
  std::filesystem::path output = {};           ///< empty: no file is written
  io::Json options = io::Json::object();       ///< as checked_options() gives them
  std::filesystem::path root = {};             ///< that paths in options are relative to
  bool wants_json = false;                     ///< the document as JSON too
  bool wants_curves = false;                   ///< of the page those that take long to record
  std::vector<io::TomlSetting> settings = {};  ///< keys of its document that are set to other values

  [[nodiscard]] const std::filesystem::path& input() const { return inputs.front(); }
  /// The document with its settings, of a verb that can vary.
  [[nodiscard]] io::TomlSource source() const { return {input(), {}, settings}; }
  [[nodiscard]] bool has(const char* name) const { return options.contains(name); }
  template <class Value>
  [[nodiscard]] Value get(const char* name, const Value& otherwise) const {
    return options.value(name, otherwise);
  }
  [[nodiscard]] bool flag(const char* name) const { return get(name, false); }
  [[nodiscard]] std::string text(const char* name) const { return get(name, std::string()); }
  [[nodiscard]] std::vector<std::string> texts(const char* name) const { return get(name, std::vector<std::string>()); }
  [[nodiscard]] std::uint64_t seed() const;
  /// Empty where it is not given.
  [[nodiscard]] std::filesystem::path file(const char* name) const { return has(name) ? root / text(name) : ""; }
  [[nodiscard]] std::vector<std::filesystem::path> files(const char* name) const;
  [[nodiscard]] std::vector<double> numbers(const char* name, double unit = 1.0) const;
  /// What a word stands for; nothing where it is not given.
  template <class Value, std::size_t n>
  [[nodiscard]] std::optional<Value> word(const char* name, const Name<Value> (&names)[n]) const {
    return value_in(names, text(name));
  }
  [[nodiscard]] stability::OperatingPoint point(const char* name) const;
  [[nodiscard]] std::vector<stability::OperatingPoint> points(const char* name) const;

  /// An option in messages: "options.band_hz", "--band".
  [[nodiscard]] std::string named(std::string_view option) const;
  /// An error about a member, or what is below it ("joints[3]"), as one about an option, whose unit is `unit` in SI;
  /// any other as it is.
  [[nodiscard]] InvalidInput about_option(const InvalidInput& error, std::string_view member, std::string_view option,
                                          double unit) const;
};

/// What a verb came to.
struct Outcome {
  std::string shortfall = {};                   ///< why its answer was not reached (exit 3); empty: it was
  std::string summary = {};                     ///< in lines of text
  std::string json = {};                        ///< its document, where the job wants it
  std::function<page::Report()> page = {};      ///< made when it is called
  std::shared_ptr<const PlanResult> plan = {};  ///< of a job whose program's blocks were judged
};

/// All that is said of a verb in one place: the command line with its help, the manual and completion, the requests of
/// the page and README's table are made of it.
struct Verb {
  std::string_view name = {};     ///< as on the command line, with the option that makes it another: "couple --tools"
  std::string_view button = {};   ///< its label on the page; empty: the page does not run it
  std::string_view purpose = {};  ///< one line: from what to what
  std::string_view more = {};     ///< sentences for the manual
  std::string_view example = {};  ///< without the program's name
  std::string_view readme = {};   ///< where its method is documented: a file of the source tree, or several
  VerbOption input = {};          ///< several where it takes files; without a flag it follows the verb
  std::string_view output = {};   ///< a name for it
  std::optional<Document> document = {};        ///< none: a folder, or what the run itself knows the endings of
  std::string page::Report::*report = nullptr;  ///< the part of the page that --report FILE.json has; none: all
  bool computes = true;                         ///< has a page, and work that may take long
  bool varies = false;                          ///< its run takes VerbJob::settings: a study can vary it
  std::vector<VerbOption> options = {};
  /// Does the work and writes the output. @throws InvalidInput, Interrupted. None: it is no job, see app/.
  Outcome (*run)(const VerbJob& job, Progress& progress) = nullptr;
};

/// Every verb that is a job, in the order of the page's buttons.
[[nodiscard]] ROBOMILL_API std::span<const Verb> verbs();

/// The job that an option makes of a verb of app/: "monitor --learn". Not among verbs().
[[nodiscard]] ROBOMILL_API Verb learn_verb();

/// Whether a verb needs an option beside its input.
[[nodiscard]] ROBOMILL_API bool is_required(const VerbOption& option, const std::filesystem::path& input);

/// @param input    the verb's first; empty: none
/// @param options  by name; null ones are left out
/// @param require_inside  throws InvalidInput if a path leads out of the folder; none: all may be read
/// @returns the options, all of them checked by their rules
/// @throws InvalidInput naming the option if one is unknown, missing or not what it takes
[[nodiscard]] ROBOMILL_API io::Json checked_options(const Verb& verb, AskedBy asked_by,
                                                    const std::filesystem::path& input, const io::Json& options,
                                                    const std::function<void(const std::string&)>& require_inside = {});

}  // namespace robomill::jobs
