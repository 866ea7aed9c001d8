#pragma once
// Of the readers of NPY and NPZ.
#include <cstddef>
#include <cstdint>
#include <string>

#include "robomill/io/records/numpy/byte_source.hpp"
#include "robomill/io/records/tree/file_tree.hpp"

namespace robomill::io {

/// Reads an array into a tree: its numbers, a node each of the fields of a structured one, or short lists of texts.
/// Sides of one element do not count. Values of other types, and of three dimensions or more, become nodes with the
/// reason.
/// @param name    of it; empty: the file is this array alone
/// @param values  that may still be held; those held are taken off
/// @throws InvalidInput naming `where`, if it is damaged, ends within its data, or holds more values
void read_npy(ByteSource& bytes, const std::string& where, const std::string& name, FileTree& tree,
              std::uint64_t& values);

}  // namespace robomill::io
