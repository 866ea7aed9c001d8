#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/modal/directions.hpp"
#include "robomill/modal/modes.hpp"

/// What lobes.toml and forces.toml say alike.
namespace robomill::process {

/// [tool] of a milling cutter (cutting::cutter_table); checked.
void read_cutter(io::TomlFile& file, cutting::Cutter& cutter);

/// cut.direction; false where it is absent.
bool read_direction(io::TomlFile& file, cutting::MillingDirection& direction);

/// cut.radial_depth_mm, or stepover_mm; false where both are absent.
bool read_radial_depth(io::TomlFile& file, double& radial_depth_m);

/// @throws InvalidInput at the radial depth, if the cut is a slot and the depth another than its full width. A ball
/// end's
///     slot may be narrower than its diameter.
void require_full_width(const io::TomlFile& file, cutting::MillingDirection direction, double radial_depth_m,
                        const cutting::FlatEndMill& tool, cutting::CutterKind kind = cutting::CutterKind::flat_end);

/// Warnings of what is unusual about the cut as a whole.
void add_unusual(const cutting::CutAtHand& cut, std::vector<std::string>& notes);

/// equal_directions and rigid_directions of a table that holds the structure of a milling tool.
/// @param own  modes of the table's own, which then know only the directions that it names; an empty list, y = [], says
///     that this one is rigid
[[nodiscard]] modal::MissingDirections read_missing_directions(io::TomlFile& file, const std::string& table,
                                                               modal::ModalModel& own);

/// Takes the directions that modes, or else FRFs, do not know for what the file says.
/// @return that, where it does
/// @throws InvalidInput with where and the table's key, if it does not say so or says what is wrong
[[nodiscard]] std::optional<Assumption> complete_directions(modal::ModalModel& modes, modal::FrfSet& measured,
                                                            const modal::MissingDirections& said,
                                                            const std::filesystem::path& where,
                                                            const std::string& table);

/// A table that holds a structure: a file of modes, a file of FRFs, or modes of its own in x, y and z.
void read_structure(io::TomlFile& file, const std::string& table, std::filesystem::path& modes,
                    std::filesystem::path& frf, modal::ModalModel& out);

}  // namespace robomill::process
