#pragma once
#include <string>
#include <string_view>

namespace robomill::page {

/// & < > " ' as entities: safe as text and inside a quoted attribute.
[[nodiscard]] std::string escape(std::string_view text);
/// JSON text that may stand inside a script element.
[[nodiscard]] std::string escape_json_for_script(std::string_view json);

}  // namespace robomill::page
