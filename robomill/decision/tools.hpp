#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/coupling/holder.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/decision/README.md, "A list of tools (`tools.hpp`)"

namespace robomill::decision {

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
  std::optional<Recommendation> recommendation = {};
  std::string no_cut = {};  ///< why the cut does not suit the tool, whose FRFs and modes stand all the same
  std::vector<std::string> notes = {};
};

/// The cut that each tool is to make.
struct ToolCut {
  stability::LobesProblem problem = {};
  stability::LobesOptions options = {};
  std::optional<cutting::MillingDirection> direction = {};  ///< none: by the immersion's angles
  double radial_depth_m = 0.0;
};

/// Puts every tool of a list into the assembly's joint and holder: the FRFs at its tip, their modes, and, with a cut,
/// the best speed and depth. The tool's teeth and tip diameter stand in place of the cut's, whose immersion follows
/// from its radial depth (an unequal pitch, a runout and a helix a tooth are those of the cut's own cutter and must not
/// be there). Tools run in parallel; one that fails, or that the cut does not suit, says why in its row and
/// stops no other.
/// @param frequency_hz  lines of the FRFs
/// @param cut           without dynamics: those of each tool are put in
/// @throws InvalidInput  if the list is empty, or the assembly's tool hangs free or carries an accelerometer
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API std::vector<ToolResult> try_tools(const coupling::Assembly& assembly,
                                                             const Eigen::VectorXd& frequency_hz,
                                                             const std::vector<coupling::ListedTool>& tools,
                                                             const std::optional<ToolCut>& cut, std::uint64_t seed,
                                                             Progress& progress);

/// A row a tool. Columns that hold nothing for any tool are empty.
[[nodiscard]] ROBOMILL_API std::string tools_csv(const std::vector<ToolResult>& results);
/// @param holder  where it was found from a measurement: its unreliable lines and notes stand beside the rows
[[nodiscard]] ROBOMILL_API std::string tools_json(const std::vector<ToolResult>& results,
                                                  const std::optional<coupling::HolderResult>& holder = {});

/// The FRFs at each tool's tip as N_TOOL.uff, N its row from 1, in a folder that is made where it is missing. A tool
/// that failed has none.
/// @throws InvalidInput if the folder cannot be made or written to
ROBOMILL_API void write_tips(const std::filesystem::path& folder, const std::vector<ToolResult>& results);

}  // namespace robomill::decision
