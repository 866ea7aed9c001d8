#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/printable.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {

/// Sentences, which may hold names out of files, a line each behind a label. A note that is a warning says so itself.
inline void add_notes(std::string& out, const std::vector<std::string>& notes, std::string_view label) {
  for (const std::string& note : notes)
    out.append(note.starts_with(warning_label) ? "" : label).append(printable(note)).append("\n");
}

}  // namespace robomill::io
