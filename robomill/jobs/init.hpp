#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"

// Method: robomill/jobs/README.md, "Files to begin with (`init.hpp`)"

namespace robomill::jobs {

/// What `robomill init` writes.
enum class Template { job, hits, lobes, cell, assembly, forces, monitor };
inline constexpr Name<Template> template_names[] = {{"job", Template::job},           {"hits", Template::hits},
                                                    {"lobes", Template::lobes},       {"cell", Template::cell},
                                                    {"assembly", Template::assembly}, {"forces", Template::forces},
                                                    {"monitor", Template::monitor}};

/// The commented document of templates/. Of an example every value is there, made up such that its verb runs, and
/// marked as a sample (io::sample_values); else what only its reader can know stands behind a #, to be filled in.
[[nodiscard]] ROBOMILL_API std::string template_text(Template kind, bool example);

struct InitOptions {
  Template kind = Template::job;
  std::filesystem::path file = {};  ///< where the document is to stand; a folder or nothing: KIND.toml there
  std::filesystem::path data = {};  ///< a folder with records of hits; nothing: that of `file`
  std::string robot = {};           ///< of a cell: one of cell::known_arms(); nothing: that of the template
  bool example = false;             ///< made up such that it runs as it is; without records of the folder
  /// With the schemas: documents begin with "#:schema PATH", as editors with Taplo read it. Nothing: without that line.
  std::filesystem::path schemas = {};
};

/// A file that is to be written.
struct NewFile {
  std::filesystem::path path = {};
  std::string text = {};
  std::optional<Template> kind = {};  ///< nothing: a record
  bool holds_cut = false;             ///< a job with the tables of lobes.toml
};

/// Files to begin with, not written yet.
struct InitFiles {
  std::vector<NewFile> files = {};               ///< the document that was asked for, then what it names
  std::vector<std::filesystem::path> kept = {};  ///< what it names that was there before
  std::vector<std::string> notes = {};           ///< what was found in records
  std::string next = {};                         ///< the command that runs the document, without the program's name
  bool example = false;                          ///< as asked for
  char unmeasured = 0;                           ///< 'x' or 'y' of a job whose hits leave that direction out; 0: none

  /// The document of a kind among `files`, of lobes.toml also the job that has its tables; or null.
  [[nodiscard]] ROBOMILL_API NewFile* document(Template kind);
};

/// Makes the files. Where records of hits lie in the folder, hits.toml names them, with guesses of their columns and
/// directions that are marked as such (modal::guess_hit); what looks like a record and is not read is named in the
/// notes. An example names a record that is made up beside it. A job brings hits.toml along, unless it is there, and
/// contains the cut, unless a lobes.toml is there.
/// @throws InvalidInput if a name does not end in .toml, a robot is not known, or the folder of data cannot be read
[[nodiscard]] ROBOMILL_API InitFiles init_files(const InitOptions& options);

/// @throws InvalidInput naming a file of theirs that exists
ROBOMILL_API void require_new(const InitFiles& files);
/// Writes all of them, the document that was asked for last. @throws InvalidInput as require_new, and where a place
/// cannot be written
ROBOMILL_API void write_init(const InitFiles& files);

/// Questions in shop terms whose answers are put into the documents that robomill init is to write: a value each in its
/// place, comments as they were. Answers have units or none: "0.25 in", "100 mV/g", "12 Nm", "7.5 kW".
class ROBOMILL_API Interview {
 public:
  /// @param files  outlives the interview; a question whose keys none of its documents has is not asked
  Interview(Template kind, InitFiles& files);
  ~Interview();
  Interview(const Interview&) = delete;
  Interview& operator=(const Interview&) = delete;

  /// What is asked next, with its default in brackets; nothing after the last.
  [[nodiscard]] std::optional<std::string> question() const;
  /// An empty answer takes the default.
  /// @throws InvalidInput saying what is wrong with it: the question stays the same
  void answer(std::string_view text);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robomill::jobs
