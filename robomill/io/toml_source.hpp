#pragma once
#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Method: robomill/io/README.md, "Errors keep their place"

namespace robomill::io {

/// A key of a TOML document and what it is set to.
struct TomlSetting {
  std::string key;    ///< full path: "tool.teeth", "hits[0].file"; entries of lists count from 0
  std::string value;  ///< as TOML writes it: "3", "\"up\"", "[1, 2]"
};

/// What is read as a TOML document: a file, or a text in its place, with some of its keys set to other values.
struct TomlSource {
  std::filesystem::path path;              ///< names the document in errors; the paths in it are relative to its folder
  std::optional<std::string> text = {};    ///< in place of the file's content: the file is not opened
  std::vector<TomlSetting> settings = {};  ///< one after the other; missing tables are made

  template <class Path>
  requires std::convertible_to<const Path&, std::filesystem::path>
  // NOLINTNEXTLINE(google-explicit-constructor): a path alone is a source
  TomlSource(const Path& file, std::optional<std::string> content = {}, std::vector<TomlSetting> set = {})
      : path(file), text(std::move(content)), settings(std::move(set)) {}
};

}  // namespace robomill::io
