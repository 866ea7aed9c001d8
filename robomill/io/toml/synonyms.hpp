#pragma once
#include <set>
#include <string>
#include <string_view>

namespace robomill::io {

/// Whether people write `name` where this project has a key that ends in `last`: "flutes" for "teeth", "fz" for
/// "feed_per_tooth_mm".
[[nodiscard]] bool is_written_for(std::string_view name, std::string_view last);

/// What to write in place of an unknown key: "Here it is teeth", or with its table where that is another one; empty
/// where no known key has that meaning.
/// @param key    the whole key, "tool.flutes"
/// @param known  every key that the file's reader knows
[[nodiscard]] std::string synonym_hint(std::string_view key, const std::set<std::string, std::less<>>& known);

}  // namespace robomill::io
