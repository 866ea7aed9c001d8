#pragma once
#include <cstddef>

#include "robomill/base/error.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/path/options.hpp"
#include "robomill/program/program.hpp"

namespace robomill::path {

/// Whether a program can end within options.max_duration_s, by its length, feeds and dwells, before anything of it is
/// planned. Of a length S from rest to rest a velocity limit v takes S/v, an acceleration limit a 2 √(S/a), a jerk
/// limit j (32 S/j)^(1/3); corners cut by the tolerances are not taken off.
/// @return the number of its blocks
/// @throws InvalidInput naming the limit, or the block and line that takes longest
std::size_t require_duration(program::Source& source, const SmoothingOptions& options, Progress& progress);

/// The same of motion planned within every limit, up to a block, before it is sampled. Of the last two 0 where it is
/// the whole.
/// @throws InvalidInput where it lasts too long, or its samples are more than may be taken (base/cost.hpp)
void require_end(const SmoothingOptions& options, double planned_s, std::size_t block, std::size_t line);

}  // namespace robomill::path
