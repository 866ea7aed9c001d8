#pragma once
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace robomill::serve {

/// A request's target as path and query, percent signs decoded: "/api/file?path=a%2Fb".
/// @return false for one that does not begin with "/", is badly encoded, names a key twice, or holds a control
/// character
[[nodiscard]] bool split_target(std::string_view target, std::string& path,
                                std::map<std::string, std::string, std::less<>>& query);

/// N of PREFIX + N, as of "/api/jobs/12" with "/api/jobs/". 0 where anything else follows the prefix, a zero in front
/// or another part of a path among it, or the number does not fit.
[[nodiscard]] int number_of(std::string_view path, std::string_view prefix);

}  // namespace robomill::serve
