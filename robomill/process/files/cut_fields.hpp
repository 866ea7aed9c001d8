#pragma once
#include <string>
#include <vector>

#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/cutting/files/cut_schema.hpp"
#include "robomill/io/toml/file.hpp"

/// Rules over several keys of a cut, for charts and for forces.
namespace robomill::process {

/// [tool] of a milling cutter (cutting::cutter_table); checked.
void read_cutter(io::TomlFile& file, cutting::Cutter& cutter);

/// @throws InvalidInput where a milled cut has no direction, or no radial depth and is no slot; at the radial depth of
/// a
///     slot, if it is another than the full width. A ball end's slot may be narrower than its diameter.
void require_engagement(const io::TomlFile& file, const cutting::CutTable& cut, const cutting::FlatEndMill& tool,
                        cutting::CutterKind kind, const char* direction_hint);

/// Warnings of what is unusual about the cut as a whole.
void add_unusual(const cutting::CutAtHand& cut, std::vector<std::string>& notes);

}  // namespace robomill::process
