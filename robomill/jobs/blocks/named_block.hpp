#pragma once
#include <cstddef>
#include <string>

#include "robomill/jobs/forces.hpp"

namespace robomill::jobs {

/// "block 12 (line 40)", for messages.
[[nodiscard]] std::string named_block(const ForcesResult& forces, std::size_t block);

}  // namespace robomill::jobs
