#include "robomill/process/files/turned_json.hpp"

#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/process/files/blocks_json.hpp"

namespace robomill::process {

using io::Json;
using io::number;

Json turned_object(const TurnedProgram& turned) {
  const program::Program& program = turned.forces.program->program;
  Json lost = Json::array();
  for (const LostBlock& block : turned.lost) {
    lost.push_back({{"block", block.block + 1}, {"line", program.blocks[block.block].line}, {"text", block.reason}});
  }
  Json gamma = {
      {"block", Json::array()}, {"path_mm", Json::array()}, {"gamma_deg", Json::array()}, {"margin", Json::array()}};
  for (std::size_t k = 0; k < turned.shown.size(); ++k) {
    gamma["block"].push_back(turned.shown[k] + 1);
    gamma["path_mm"].push_back(number(turned.path_m[k] / units::mm));
    gamma["gamma_deg"].push_back(number(turned.gamma_rad[k] / units::deg));
    gamma["margin"].push_back(number(turned.blocks.rows[turned.shown[k]].stability_margin));
  }
  const ProgramBlocks& blocks = turned.blocks;
  return {{"blocks", blocks_table().write({&turned.forces, &blocks})},
          {"lost", std::move(lost)},
          {"gamma", std::move(gamma)},
          {"unstable", blocks.unstable},
          {"least_margin", number(turned.least_stability_margin)},
          {"worst_block", blocks.cutting > 0 ? Json(blocks.worst + 1) : Json()},
          {"notes", turned.notes}};
}

}  // namespace robomill::process
