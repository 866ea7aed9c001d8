#pragma once
#include <filesystem>
#include <string>

#include "robomill/cutting/milling.hpp"
#include "robomill/formats/toml_file.hpp"
#include "robomill/modal/modes.hpp"

/// What lobes.toml and forces.toml say alike.
namespace robomill::formats {

/// [tool]: teeth, diameter, helix, pitch, runout; checked.
void read_mill(TomlFile& file, cutting::FlatEndMill& tool);

/// cut.direction; false where it is absent.
bool read_direction(TomlFile& file, cutting::MillingDirection& direction);

/// cut.radial_depth_mm, or stepover_mm; false where both are absent.
bool read_radial_depth(TomlFile& file, double& radial_depth_m);

/// A table that holds a structure: a file of modes, a file of FRFs, or modes of its own in x, y and z.
void read_structure(TomlFile& file, const std::string& table, std::filesystem::path& modes, std::filesystem::path& frf,
                    modal::ModalModel& out);

}  // namespace robomill::formats
