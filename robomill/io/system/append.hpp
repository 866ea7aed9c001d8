#pragma once
#include <fmt/format.h>

#include <string>

namespace robomill::io {

void append_formatted(std::string& text, fmt::string_view format, fmt::format_args args);
void append_formatted(fmt::memory_buffer& text, fmt::string_view format, fmt::format_args args);

/// Formats to the end of a string or a buffer. fmt::format_to with an iterator compiles fmt's formatter into every
/// source.
template <class Text, class... Args>
void append(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  append_formatted(text, format, fmt::make_format_args(args...));
}

}  // namespace robomill::io
