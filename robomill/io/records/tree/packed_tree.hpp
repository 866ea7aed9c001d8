#pragma once
// Of the readers that read in a child process.
#include <string>
#include <string_view>

#include "robomill/io/records/tree/file_tree.hpp"

namespace robomill::io {

/// A tree as bytes, on its way out of a child process. Its columns are freed as they are packed.
[[nodiscard]] std::string pack_tree(FileTree tree);
/// @throws std::length_error if they are none: a damaged file may have made the child say anything
[[nodiscard]] FileTree unpack_tree(std::string_view bytes, FileTree::Naming naming);

}  // namespace robomill::io
