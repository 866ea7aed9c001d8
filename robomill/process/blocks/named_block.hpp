#pragma once
#include <cstddef>
#include <string>

#include "robomill/process/forces.hpp"

namespace robomill::process {

/// "block 12 (line 40)", for messages.
[[nodiscard]] std::string named_block(const ForcesResult& forces, std::size_t block);

}  // namespace robomill::process
