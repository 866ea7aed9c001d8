#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
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

inline constexpr const char* damaged_mat = "is no MAT file, or a damaged one";
/// Number of variables of any kind in a file of version 4 or 5; 0: not known. @throws InvalidInput if it was cut off
[[nodiscard]] std::size_t whole_variables(const std::filesystem::path& path, std::string_view content);

/// Whether a MAT file seems to have a variable of that name: by the first bytes of each, or of version 7.3 where the
/// name stands in the file, without the libraries, which a damaged file can bring down or keep busy. False where it
/// cannot be read, or is longer than that.
[[nodiscard]] bool mat_seems_to_have(const std::filesystem::path& path, const std::string& name,
                                     std::size_t longest_bytes);

/// Writes version 5, compressed, whole or not at all. @throws InvalidInput if the place cannot be written
void write_mat(const std::filesystem::path& path, const std::vector<MatVariable>& variables);

}  // namespace robomill::io
