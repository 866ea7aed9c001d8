#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace robomill::io {

/// A numeric matrix of a MAT file.
struct MatVariable {
  std::string name;
  Eigen::MatrixXd re;
  Eigen::MatrixXd im = {};  ///< empty where the variable is real
};

/// The numeric full matrices of at most two dimensions in a MAT file of version 4, 5 or 7.3; anything else in it is
/// left out.
/// @throws InvalidInput if the file is missing, empty or no MAT file, or a variable cannot be read
[[nodiscard]] std::vector<MatVariable> read_mat(const std::filesystem::path& path);

/// Writes version 5, compressed, whole or not at all. @throws InvalidInput if the place cannot be written
void write_mat(const std::filesystem::path& path, const std::vector<MatVariable>& variables);

}  // namespace robomill::io
