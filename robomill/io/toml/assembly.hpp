#pragma once
// For io/ alone: toml++ and its tree.
#include <vector>

#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/tree.hpp"

namespace robomill::io {

/// A document and the files that it includes, as one tree. Each node names its file (toml::node::source).
struct TomlAssembly {
  toml::table root;
  std::vector<TomlText> texts;  ///< the document first
};

/// Reads a document, the files of its key `include`, and those of job.lobes, job.forces and job.cell, which are
/// includes by another name (of these a file that is missing is left to the reader that needs it). Files that they
/// include follow; each is read once.
/// @throws InvalidInput with file and line if one of them is missing or no TOML, if a key has two values (names both
///     lines), or if there are more than 32 files or 64 MB
[[nodiscard]] TomlAssembly assemble(const TomlSource& source);

}  // namespace robomill::io
