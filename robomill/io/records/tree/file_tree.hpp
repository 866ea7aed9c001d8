#pragma once
// What files of named values share: NPZ, HDF5, MAT.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// A group, numbers or texts of such a file. An attribute of a data set is a value within it.
struct FileNode {
  enum class Kind : std::uint8_t { group, numbers, texts };
  std::size_t parent = 0;  ///< place of what it is within
  Kind kind = Kind::group;
  std::string name = {};                      ///< as messages and columns have it: "data.force"
  std::string key = {};                       ///< its last part: "force"
  std::vector<Eigen::VectorXd> columns = {};  ///< of numbers, each over time
  bool by_rows = false;                       ///< a column is a row of the file
  std::vector<std::string> texts = {};
  std::string fault = {};  ///< why numbers can be no columns: "complex numbers"; empty: they can
};

/// The first node is the file itself.
struct FileTree {
  /// How a name and the number of a column stand beside each other.
  enum class Naming : std::uint8_t {
    matlab,  ///< x(:,1)
    python   ///< x[:,0]
  };
  explicit FileTree(Naming names) : naming(names), nodes(1) {}
  /// Its place.
  std::size_t add(FileNode node);

  Naming naming = Naming::matlab;
  std::vector<FileNode> nodes;
  std::vector<std::string> notes = {};
};

/// How a matrix of a record lies: the longer side is time, the rows where it is square.
struct MatrixLie {
  bool by_rows = false;  ///< a column of the record is a row of the matrix
  std::uint64_t samples = 0, columns = 0;
};
[[nodiscard]] MatrixLie matrix_lie(std::uint64_t rows, std::uint64_t columns);

/// All that is read of a file is held, eight bytes a value.
inline constexpr std::uint64_t most_record_values = std::uint64_t{1} << 28;

/// The columns of such a file, in its order.
///
/// - Rate: of a channel the nearest that is said of it, from its own attributes up to the file's: evenly running times
///   of as many samples (time, t; in s, or in the unit that they state), else one number called fs, sample_rate, dt and
///   the like. Times are columns too, in s. Channels of another rate or start than most are left out, with a note.
/// - Unit: its attribute unit or units, else the text beside it that is called after it (force_unit), else unit beside
///   it where it is the only channel of its group.
/// - Name: its path; of a matrix with a number, or the names beside it, where there are as many.
///
/// @param time  the user's column of time; with one no rate is sought
/// @throws InvalidInput if there is no column
[[nodiscard]] Record record_of_tree(FileTree tree, const std::filesystem::path& path, const std::string& time);

}  // namespace robomill::io
