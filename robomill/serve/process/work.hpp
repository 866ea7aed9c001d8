#pragma once
#include <filesystem>

#include "robomill/io/system/sandbox.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// The descriptor at which a process that works for a server finds it.
inline constexpr int worker_socket = 3;
/// … and of the library that it runs from, where there is one.
inline constexpr int worker_library = worker_socket + 1;

/// What such a process may open, for ever.
/// @param root      the folder that is served
/// @param connects  to brokers
[[nodiscard]] io::FileRights file_rights_of_worker(const std::filesystem::path& root, bool connects);

}  // namespace robomill::serve
