#pragma once
// Of the readers of HDF5 and MAT.
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/records/tree/file_tree.hpp"

namespace robomill::io {

/// Values that a file of so many bytes may be unpacked to.
[[nodiscard]] std::uint64_t most_values_of(std::uint64_t file_bytes);

/// What of MATLAB is no signal, as messages have it.
inline constexpr const char *sparse_matrix = "a sparse matrix", *function_handle = "a function handle",
                            *matlab_object = "an object of MATLAB";

/// A tree that is built of what a library reads.
class TreeBuilder {
 public:
  /// @param file  that errors name
  TreeBuilder(FileTree& tree, std::string file, std::uint64_t most_values)
      : tree_(tree), file_(std::move(file)), left_(most_values) {}

  std::size_t add_group(std::size_t parent, std::string name, std::string key);
  void add_texts(std::size_t parent, std::string name, std::string key, std::vector<std::string> texts);
  /// What can be no channel, and why.
  void add_fault(std::size_t parent, std::string name, std::string key, std::string fault);
  /// @throws InvalidInput if there are more nodes, or values, than a file of its size may have
  std::size_t add(FileNode node);
  /// Before memory for so many is asked for. @throws InvalidInput
  void require_room(const std::string& name, std::uint64_t rows, std::uint64_t columns);
  /// Why a matrix is no signal of a record; empty: it may be one.
  [[nodiscard]] static std::string lie_fault(std::uint64_t rows, std::uint64_t columns);

 private:
  FileTree& tree_;
  std::string file_;
  std::uint64_t left_ = 0;
};

/// Rows and columns of an array without its sides of one element; false: it has more than two others.
[[nodiscard]] bool squeezed(const std::vector<std::uint64_t>& sides, std::uint64_t& rows, std::uint64_t& columns);

/// A text of two bytes a letter, as UTF-8.
[[nodiscard]] std::string utf8_of(const std::uint16_t* letters, std::size_t count);

}  // namespace robomill::io
