#pragma once
#include <string>

namespace robomill::app {

/// robomill(1) in roff's man macros.
[[nodiscard]] std::string manual();
/// The verbs in a table of Markdown, as README.md has it.
[[nodiscard]] std::string verbs_table();
/// The script by which bash completes verbs, options and their words; what is left is a file's name.
[[nodiscard]] std::string bash_completion();

}  // namespace robomill::app
