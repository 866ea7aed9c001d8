#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "robomill/io/toml_source.hpp"

namespace robomill::io {

/// A text as TOML writes it, in quotes.
[[nodiscard]] std::string toml_quoted(std::string_view text);
/// A text of one line as TOML writes it, without its quotes and escapes; any other value as it is.
[[nodiscard]] std::string toml_unquoted(std::string_view literal);

/// What a document has at a key, as it stands there: "3", "\"up\"", "[1, 2]"; nothing where it has no such key, or a
/// table below a header.
/// @throws InvalidInput naming the key if the document is no TOML
[[nodiscard]] std::optional<std::string> setting_of(std::string_view document, std::string_view key);

/// A document with one of its keys set, comments and layout as they were: the value that is there is replaced; a key
/// that stands commented out ("# teeth = 3") takes effect; one that the document lacks goes to the end of its
/// table, which is made where it is missing.
/// @param document  TOML
/// @throws InvalidInput naming the key if the document or the value is no TOML, or the key cannot be set
[[nodiscard]] std::string with_setting(std::string_view document, const TomlSetting& setting);

}  // namespace robomill::io
