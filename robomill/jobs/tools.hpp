#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/jobs/README.md, "A list of tools (`tools.hpp`)"

namespace robomill::jobs {

/// What one tool of a list comes to in the holder.
struct ToolResult {
  std::string name;
  int teeth = 0;             ///< of its list, else of the cut; 0: neither says it
  double diameter_m = 0.0;   ///< at the tip
  double overhang_m = 0.0;   ///< from the tip to the joint
  std::string failure = {};  ///< why what follows is not there; empty where all is
  modal::FrfSet tip = {};
  modal::ModalModel modes = {};
  double fit_error = 0.0;     ///< ‖H_fit - H‖ / ‖H‖
  double peak_hz = 0.0;       ///< the line where |xx| is greatest …
  double peak_m_per_n = 0.0;  ///< … and |xx| there
  std::size_t suspect_lines = 0;
  /// With a cut: the lowest limit over its speeds (none: stable at every depth searched), and the best operation.
  std::optional<double> lowest_limit_m = {};
  std::optional<decision::Recommendation> recommendation = {};
  std::string no_cut = {};  ///< why the cut does not suit the tool, whose FRFs and modes stand all the same
  std::vector<std::string> notes = {};
};

/// Puts every tool of a list into the assembly's joint and holder: the FRFs at its tip, their modes, and, with a cut,
/// the best speed and depth. The tool's teeth and tip diameter stand in place of the cut's, whose immersion follows
/// from its radial depth (an unequal pitch, a runout and a helix a tooth are those of the cut's own cutter and must not
/// be there). Tools run in parallel; one that fails, or that the cut does not suit, says why in its row and
/// stops no other.
/// @param cut  without dynamics: those of each tool are put in
/// @throws InvalidInput  if the list is empty or the cut cannot be used for any tool
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API std::vector<ToolResult> try_tools(const coupling::AssemblyFile& assembly,
                                                             const std::vector<coupling::ListedTool>& tools,
                                                             const std::optional<LobesFile>& cut, std::uint64_t seed,
                                                             Progress& progress);

/// A list of tools, the assembly whose holder takes them, and the cut that each is to make.
struct ToolsJob {
  std::filesystem::path assembly, tools;  ///< assembly.toml, tools.csv
  std::filesystem::path lobes = {};       ///< lobes.toml; empty: no cut
  std::uint64_t seed = 1;
};

struct ToolsResult {
  coupling::AssemblyFile assembly;
  std::optional<LobesFile> cut = {};  ///< without the tool's dynamics
  std::vector<ToolResult> tools = {};
};

/// Reads the files and tries every tool of the list.
/// @throws InvalidInput with file, line and key or column, or as try_tools; Interrupted
[[nodiscard]] ROBOMILL_API ToolsResult run_tools(const ToolsJob& job, Progress& progress = Progress::none());

/// A row a tool. Columns that hold nothing for any tool are empty.
[[nodiscard]] ROBOMILL_API std::string tools_csv(const std::vector<ToolResult>& results);
/// @param holder  where it was found from a measurement: its unreliable lines and notes stand beside the rows
[[nodiscard]] ROBOMILL_API std::string tools_json(const std::vector<ToolResult>& results,
                                                  const std::optional<coupling::HolderResult>& holder = {});

/// The FRFs at each tool's tip as N_TOOL.uff, N its row from 1, in a folder that is made where it is missing. A tool
/// that failed has none.
/// @throws InvalidInput if the folder cannot be made or written to
ROBOMILL_API void write_tips(const std::filesystem::path& folder, const std::vector<ToolResult>& results);

}  // namespace robomill::jobs
