#pragma once

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// The descriptor at which a process that works for a server finds it.
inline constexpr int worker_socket = 3;

}  // namespace robomill::serve
