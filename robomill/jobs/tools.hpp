#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/decision/tools.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"

// Method: robomill/jobs/README.md, "A list of tools (`tools.hpp`)"

namespace robomill::jobs {

/// decision::try_tools in the holder of assembly.toml, and with a cut of lobes.toml. An unequal pitch, a runout and a
/// helix a tooth are those of the cut's own cutter and must not be there.
/// @param cut  without dynamics
/// @throws InvalidInput  as decision::try_tools, and if the cut cannot be used for any tool; Interrupted
[[nodiscard]] ROBOMILL_API std::vector<decision::ToolResult> try_tools(const coupling::AssemblyFile& assembly,
                                                                       const std::vector<coupling::ListedTool>& tools,
                                                                       const std::optional<LobesFile>& cut,
                                                                       std::uint64_t seed, Progress& progress);

/// A list of tools, the assembly whose holder takes them, and the cut that each is to make.
struct ToolsJob {
  std::filesystem::path assembly, tools;  ///< assembly.toml, tools.csv
  std::filesystem::path lobes = {};       ///< lobes.toml; empty: no cut
  std::uint64_t seed = 1;
};

struct ToolsResult {
  coupling::AssemblyFile assembly;
  std::optional<LobesFile> cut = {};  ///< without the tool's dynamics
  std::vector<decision::ToolResult> tools = {};
};

/// Reads the files and tries every tool of the list.
/// @throws InvalidInput with file, line and key or column, or as decision::try_tools; Interrupted
[[nodiscard]] ROBOMILL_API ToolsResult run_tools(const ToolsJob& job, Progress& progress = Progress::none());

}  // namespace robomill::jobs
