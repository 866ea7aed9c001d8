#pragma once
#include <string>

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// The shared library that this code runs from, kept open from the first call on; -1 where it is linked into the
/// program.
[[nodiscard]] int own_library() noexcept;

/// The variable of a process that has own_library() open as `descriptor`: it runs from that file, also where an upgrade
/// has replaced it in its folder, and so is of the server's version.
[[nodiscard]] std::string preload_variable(int descriptor);

/// In such a process: closes the file, and removes the variable.
void forget_preload(int descriptor) noexcept;

}  // namespace robomill::serve
