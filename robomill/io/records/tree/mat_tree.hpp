#pragma once
// Of the reader of MAT.
#include <cstddef>
#include <string>

#include "robomill/io/records/tree/file_tree.hpp"

namespace robomill::io {

/// All matrices of numbers, texts, structs and cells of a MAT file of version 4 or 5, by matio. Call it in a child
/// process.
/// @param file   the name under which it is opened, and that errors name
/// @param count  of variables of any kind in the file; 0: not known
/// @throws InvalidInput
[[nodiscard]] FileTree read_mat_tree(const std::string& file, std::size_t file_bytes, std::size_t count);

}  // namespace robomill::io
