#pragma once
#include <functional>
#include <string>
#include <vector>

#include "robomill/io/columns.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {

/// What was cut with what, in words.
struct Fact {
  std::string label, value;
};
[[nodiscard]] const io::Schema<Fact>& fact_table();

/// One block of a program in the documents of its forces.
struct ForcesLine {
  const ForcesResult* forces = nullptr;
  const BlockResult* result = nullptr;
  double path_m = 0.0, time_s = 0.0;  ///< of the program at its end
  [[nodiscard]] const program::Block& block() const { return forces->program->program.blocks[result->force.block]; }
};
/// One a block, in their order.
void each_line(const ForcesResult& forces, const std::function<void(const ForcesLine&)>& use);
/// One of them in forces.json.
[[nodiscard]] const io::Schema<ForcesLine>& line_table();
/// The key of their list.
inline constexpr const char* blocks_key = "blocks";
/// forces.csv along a program.
[[nodiscard]] const io::Columns<ForcesLine>& forces_columns();
/// [forces]
[[nodiscard]] const io::Schema<Cut>& forces_options_table();
/// [robot] of a single cut, beside the keys of an arm.
[[nodiscard]] const io::Schema<Cut>& robot_of_cut_table();
/// forces.json
[[nodiscard]] const io::Schema<ForcesResult>& forces_table();

}  // namespace robomill::process
