#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/modal/directions.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::process {

/// [workpiece_dynamics], and what [dynamics] shares with it: what vibrates.
struct StructureTable {
  std::filesystem::path modes = {}, frf = {};
  modal::ModalModel own = {};  ///< modes that the table gives itself, in x, y and z
};
[[nodiscard]] const io::Schema<StructureTable>& workpiece_dynamics_table();

/// What the axes of modes are fixed to: feed and tool are those of the cut, base and flange those of a cell's posture.
enum class StructureAxes { feed, tool, base, flange };

/// [dynamics]
struct DynamicsTable {
  StructureTable structure = {};
  std::filesystem::path cell = {};  ///< the structure is that of a posture of it
  std::vector<double> joints = {};  ///< [rad or m]
  std::optional<StructureAxes> axes = {};
  modal::MissingDirections directions = {};
  std::vector<int> keep_modes = {};  ///< from 1; empty: all
};
[[nodiscard]] const io::Schema<DynamicsTable>& dynamics_table();

/// equal_directions and rigid_directions, of [dynamics] and of [job].
[[nodiscard]] const io::Schema<modal::MissingDirections>& missing_directions_table();

/// @throws InvalidInput where the table gives more than one source
[[nodiscard]] StructureTable read_workpiece_dynamics(io::TomlFile& file);
/// The same; a cell goes with joints and stands alone.
[[nodiscard]] DynamicsTable read_dynamics(io::TomlFile& file);

/// Of its own modes [dynamics] gives x, y and z; those of which it says nothing, not even [], are unknown and not
/// rigid.
void keep_named_directions(const io::TomlFile& file, modal::ModalModel& own);

/// Takes the directions that modes, or else FRFs, do not know for what the file says.
/// @return that, where it does
/// @throws InvalidInput with where and the table's key, if it does not say so or says what is wrong
[[nodiscard]] std::optional<Assumption> complete_directions(modal::ModalModel& modes, modal::FrfSet& measured,
                                                            const modal::MissingDirections& said,
                                                            const std::filesystem::path& where,
                                                            const std::string& table);

}  // namespace robomill::process
