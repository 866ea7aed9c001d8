#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/printable.hpp"

namespace robomill::jobs {

/// Sentences, which may hold names out of files, a line each behind a label.
inline void add_notes(std::string& out, const std::vector<std::string>& notes, std::string_view label) {
  for (const std::string& note : notes) out.append(label).append(printable(note)).append("\n");
}

}  // namespace robomill::jobs
