#pragma once
#include <string>

namespace robomill::process {

struct ForcesResult;
struct SmoothResult;

/// A result in lines of text, for a terminal. Texts out of files are printable.
[[nodiscard]] std::string summary(const ForcesResult& result);
[[nodiscard]] std::string summary(const SmoothResult& result);

/// Why a result is not what was asked for; empty: it is.
[[nodiscard]] std::string shortfall(const ForcesResult& result);
[[nodiscard]] std::string shortfall(const SmoothResult& result);

}  // namespace robomill::process
