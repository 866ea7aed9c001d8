#include "robomill/io/records/numpy/numpy_record.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/records/numpy/byte_source.hpp"
#include "robomill/io/records/numpy/npy.hpp"
#include "robomill/io/records/numpy/npy_format.hpp"
#include "robomill/io/records/numpy/zip.hpp"
#include "robomill/io/records/tree/file_tree.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {
namespace {

void read_npy_file(const std::filesystem::path& path, FileTree& tree) {
  (void)open_file(path);  // says what is wrong with a missing one
  int error = 0;
  const Descriptor file = open_descriptor(path.c_str(), O_RDONLY, error);
  if (error != 0) throw InvalidInput(path.string(), "cannot be read", error_text(error));
  struct stat status = {};
  if (::fstat(file.get(), &status) != 0 || status.st_size <= 0) throw InvalidInput(path.string(), "is empty");
  FileBytes bytes(file.get(), 0, static_cast<std::uint64_t>(status.st_size), path.string());
  std::uint64_t values = most_record_values;
  read_npy(bytes, path.string(), "", tree, values);
  // One array of one kind: why it cannot be read is the error.
  if (tree.nodes.size() == 2 && !tree.nodes.back().fault.empty()) {
    throw InvalidInput(path.string(), "cannot be read as a record: " + tree.nodes.back().fault,
                       "Save the samples as numbers: numpy.save(file, x.astype(float))");
  }
}

void read_npz_file(const std::filesystem::path& path, FileTree& tree) {
  constexpr std::string_view ending = ".npy";
  const ZipFile archive(path);
  // As for MAT files: what a file unpacks to is bounded by its size.
  std::uint64_t values = std::min(most_record_values, (std::uint64_t{8} << 20) + 8 * archive.size());
  if (archive.entries().size() > most_channels) {
    throw InvalidInput(path.string(), fmt::format("holds {} arrays, and at most {} are read", archive.entries().size(),
                                                  most_channels));
  }
  for (const ZipEntry& entry : archive.entries()) {
    if (!entry.name.ends_with(ending)) continue;
    const std::string name = entry.name.substr(0, entry.name.size() - ending.size());
    const auto bytes = archive.open(entry);
    read_npy(*bytes, path.string() + ": " + entry.name, name, tree, values);
  }
  if (tree.nodes.size() == 1) {
    throw InvalidInput(path.string(), "is an archive that holds no array of NumPy",
                       "Save one by numpy.savez(file, force=…, acc=…, fs=…)");
  }
}

}  // namespace

std::size_t FileBytes::read(std::span<char> to) {
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), left_));
  std::size_t got = 0;
  if (const int error = read_all_at(file_, to.first(wanted), at_, got); error != 0) {
    throw InvalidInput(name_, "cannot be read to its end", error_text(error));
  }
  at_ += got;
  left_ = got < wanted ? 0 : left_ - got;
  return got;
}

Record read_numpy(const std::filesystem::path& path, const std::string& time) {
  std::array<char, 4> begin = {};
  open_file(path).read(begin.data(), begin.size());
  FileTree tree(FileTree::Naming::python);
  const std::string_view first(begin.data(), begin.size());
  if (first.starts_with("PK")) {
    read_npz_file(path, tree);
  } else {
    read_npy_file(path, tree);
  }
  return record_of_tree(std::move(tree), path, time);
}

}  // namespace robomill::io
