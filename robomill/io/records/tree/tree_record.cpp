#include "robomill/io/records/tree/tree_record.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/child_reading.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/tree/file_tree.hpp"
#include "robomill/io/records/tree/hdf5_tree.hpp"
#include "robomill/io/records/tree/mat_tree.hpp"
#include "robomill/io/records/tree/packed_tree.hpp"

namespace robomill::io {
namespace {

constexpr const char* damaged_file = "is a damaged file";

/// Of what a child read.
Record record_of_packed(std::string packed, FileTree::Naming naming, const std::filesystem::path& path,
                        const std::string& time) {
  FileTree tree(naming);
  try {
    tree = unpack_tree(packed, naming);
  } catch (const std::length_error&) {
    throw InvalidInput(path.string(), damaged_file);
  }
  packed = std::string();
  return record_of_tree(std::move(tree), path, time);
}

void require_hdf5(const std::filesystem::path& path, std::string_view content) {
  if (is_hdf5(content)) return;
  const bool is_version_4 = content.starts_with("\x0e\x03\x13\x01");
  throw InvalidInput(path.string(), is_version_4 ? "is an HDF4 file, which is not read" : "is no HDF5 file",
                     is_version_4 ? "Convert it to HDF5 (h4toh5), or export CSV" : "Was it saved by another program?");
}

}  // namespace

Record read_hdf5_record(const std::filesystem::path& path, const std::string& time) {
  std::string content = read_file(path);
  require_hdf5(path, content);
  const auto read = [](const std::string& bytes, const std::string& place) {
    return pack_tree(read_hdf5_tree(bytes, place, false));
  };
  std::string packed = read_in_child(path, content, {.fault = "is a damaged HDF5 file"}, read);
  content = std::string();
  return record_of_packed(std::move(packed), FileTree::Naming::python, path, time);
}

Record read_mat_record(const std::filesystem::path& path, const std::string& time) {
  std::string content = read_file(path);
  const std::size_t variables = whole_variables(path, content);
  const bool of_hdf5 = is_hdf5(content);
  const auto read = [&](const std::string& bytes, const std::string& place) {
    return pack_tree(of_hdf5 ? read_hdf5_tree(bytes, place, true) : read_mat_tree(place, bytes.size(), variables));
  };
  std::string packed = read_in_child(path, content, {.by_name = !of_hdf5, .fault = damaged_mat}, read);
  content = std::string();
  return record_of_packed(std::move(packed), FileTree::Naming::matlab, path, time);
}

}  // namespace robomill::io
