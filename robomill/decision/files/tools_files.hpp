#pragma once
#include <optional>
#include <vector>

#include "robomill/decision/tools.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::decision {

/// Rows of a list of tools and the holder that was measured for them.
struct ToolsView {
  const std::vector<ToolResult>* tools = nullptr;
  const std::optional<coupling::HolderResult>* holder = nullptr;
};
/// The table of a list of tools as JSON.
[[nodiscard]] const io::Schema<ToolsView>& tools_table();

}  // namespace robomill::decision
