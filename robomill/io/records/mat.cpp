#include "robomill/io/records/mat.hpp"

#include <fmt/format.h>
#include <matio.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/child_reading.hpp"
#include "robomill/io/records/hdf5_input.hpp"
#include "robomill/io/records/mat_layout.hpp"
#include "robomill/io/records/mat_numbers.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {
namespace {

using MatFile = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

/// All that was written into memory; less where that could not be read.
std::string content_of(const Descriptor& memory) {
  struct stat status = {};
  if (::fstat(memory.get(), &status) != 0) return {};
  std::string out(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t count = 0;
  if (read_all_at(memory.get(), out, 0, count) != 0) return {};
  out.resize(count);
  return out;
}

template <class T>
Eigen::MatrixXd matrix(const void* data, Eigen::Index rows, Eigen::Index columns) {
  const auto* values = static_cast<const T*>(data);
  Eigen::MatrixXd out(rows, columns);
  for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = static_cast<double>(values[i]);
  return out;
}

Eigen::MatrixXd matrix(matio_classes type, const void* data, Eigen::Index rows, Eigen::Index columns) {
  switch (type) {
    case MAT_C_DOUBLE:
      return matrix<double>(data, rows, columns);
    case MAT_C_SINGLE:
      return matrix<float>(data, rows, columns);
    case MAT_C_INT64:
      return matrix<std::int64_t>(data, rows, columns);
    case MAT_C_UINT64:
      return matrix<std::uint64_t>(data, rows, columns);
    case MAT_C_INT32:
      return matrix<std::int32_t>(data, rows, columns);
    case MAT_C_UINT32:
      return matrix<std::uint32_t>(data, rows, columns);
    case MAT_C_INT16:
      return matrix<std::int16_t>(data, rows, columns);
    case MAT_C_UINT16:
      return matrix<std::uint16_t>(data, rows, columns);
    case MAT_C_INT8:
      return matrix<std::int8_t>(data, rows, columns);
    default:
      return matrix<std::uint8_t>(data, rows, columns);
  }
}

/// Whether a variable is a matrix of numbers; one that claims more than its file can hold is rejected.
bool is_matrix(const matvar_t& variable, const std::string& file, std::size_t file_bytes) {
  const std::size_t width = mat_number_bytes(variable.class_type);
  if (width == 0 || variable.name == nullptr || variable.rank != 2 || variable.isLogical != 0) return false;
  require_held(file, variable.name, variable.dims[0], variable.dims[1], variable.isComplex != 0 ? 2 * width : width,
               file_bytes);
  return variable.dims[0] > 0 && variable.dims[1] > 0;
}

MatVariable converted(const matvar_t& variable, const std::string& file) {
  const auto rows = static_cast<Eigen::Index>(variable.dims[0]);
  const auto columns = static_cast<Eigen::Index>(variable.dims[1]);
  MatVariable out{.name = variable.name, .re = {}};
  const auto* split = static_cast<const mat_complex_split_t*>(variable.data);
  const bool whole =
      variable.data != nullptr && (variable.isComplex == 0 || (split->Re != nullptr && split->Im != nullptr));
  if (!whole) throw InvalidInput(file, "variable " + out.name + " cannot be read");
  if (variable.isComplex != 0) {
    out.re = matrix(variable.class_type, split->Re, rows, columns);
    out.im = matrix(variable.class_type, split->Im, rows, columns);
  } else {
    out.re = matrix(variable.class_type, variable.data, rows, columns);
  }
  return out;
}

/// Of version 4 or 5.
/// @param count  of variables of any kind in the file; 0: not known
std::vector<MatVariable> read_variables(const std::string& file, std::size_t file_bytes, std::size_t count) {
  const MatFile mat(Mat_Open(file.c_str(), MAT_ACC_RDONLY), &Mat_Close);
  if (!mat) throw InvalidInput(file, "is no MAT file");
  std::vector<MatVariable> out;
  for (std::size_t i = 0;; ++i) {
    const Variable variable(Mat_VarReadNextInfo(mat.get()), &Mat_VarFree);
    if (!variable && i < count) {
      throw InvalidInput(file, fmt::format("variable {} cannot be read, nor what follows it", i + 1),
                         "Is the file damaged, or does it hold objects? Save the numbers alone");
    }
    if (!variable) break;
    if (!is_matrix(*variable, file, file_bytes)) continue;
    if (Mat_VarReadDataAll(mat.get(), variable.get()) != 0) {
      throw InvalidInput(file, fmt::format("variable {} cannot be read", variable->name));
    }
    out.push_back(converted(*variable, file));
  }
  return out;
}

void append_bytes(std::string& out, const void* data, std::size_t bytes) {
  out.append(static_cast<const char*>(data), bytes);
}

/// For the way from one process to another: sizes, name, values.
std::string pack(const std::vector<MatVariable>& variables) {
  std::string out;
  for (const MatVariable& variable : variables) {
    const std::array<Eigen::Index, 4> sizes = {static_cast<Eigen::Index>(variable.name.size()), variable.re.rows(),
                                               variable.re.cols(), variable.im.size()};
    append_bytes(out, sizes.data(), sizeof(sizes));
    out += variable.name;
    for (const Eigen::MatrixXd* part : {&variable.re, &variable.im}) {
      append_bytes(out, part->data(), static_cast<std::size_t>(part->size()) * sizeof(double));
    }
  }
  return out;
}

std::vector<MatVariable> unpack(std::string_view bytes) {
  std::vector<MatVariable> out;
  // A damaged file may have made the child say anything.
  const auto take = [&bytes](void* to, std::size_t count) {
    if (count > bytes.size()) throw std::length_error("less than it says");
    if (count > 0) std::memcpy(to, bytes.data(), count);
    bytes.remove_prefix(count);
  };
  while (!bytes.empty()) {
    std::array<Eigen::Index, 4> sizes{};
    take(sizes.data(), sizeof(sizes));
    const auto held = static_cast<Eigen::Index>(bytes.size());
    const bool makes_sense =
        std::ranges::all_of(sizes, [held](Eigen::Index size) { return size >= 0 && size <= held; });
    if (!makes_sense || (sizes[1] > 0 && sizes[2] > held / sizes[1])) throw std::length_error("more than it has");
    MatVariable variable{.name = std::string(static_cast<std::size_t>(sizes[0]), ' '), .re = {}};
    take(variable.name.data(), variable.name.size());
    variable.re.resize(sizes[1], sizes[2]);
    if (sizes[3] > 0) variable.im.resize(sizes[1], sizes[2]);
    for (Eigen::MatrixXd* part : {&variable.re, &variable.im}) {
      take(part->data(), static_cast<std::size_t>(part->size()) * sizeof(double));
    }
    out.push_back(std::move(variable));
  }
  return out;
}

}  // namespace

std::vector<MatVariable> read_mat(const std::filesystem::path& path) {
  const std::string content = read_file(path);
  const std::size_t variables = whole_variables(path, content);
  const bool of_hdf5 = is_hdf5(content);
  const auto read = [&](const std::string& bytes, const std::string& place) {
    return pack(of_hdf5 ? read_hdf5_matrices(bytes, place) : read_variables(place, bytes.size(), variables));
  };
  const std::string packed = read_in_child(path, content, {.by_name = !of_hdf5, .fault = damaged_mat}, read);
  try {
    return unpack(packed);
  } catch (const std::length_error&) {
    throw InvalidInput(path.string(), "is a damaged MAT file");
  }
}

std::size_t whole_variables(const std::filesystem::path& path, std::string_view content) {
  const auto layout = mat_layout(content);
  if (layout && !layout->whole) {
    throw InvalidInput(path.string(), fmt::format("ends within its variable {}", layout->variables + 1),
                       "Was it cut off while it was written or copied?");
  }
  return layout ? layout->variables : 0;
}

bool mat_seems_to_have(const std::filesystem::path& path, const std::string& name, std::size_t longest_bytes) {
  std::string content;
  try {
    content = read_file(path, longest_bytes);
  } catch (const InvalidInput&) {
    return false;
  }
  if (is_hdf5(content)) return content.find(name) != std::string::npos;
  const std::vector<std::string> names = mat_names(content);
  return std::ranges::find(names, name) != names.end();
}

void write_mat(const std::filesystem::path& path, const std::vector<MatVariable>& variables) {
  const std::lock_guard lock(mat_library());
  PendingFile pending(path);
  // The library does not report a write that fails: it writes into memory, where none does.
  const Descriptor memory(::memfd_create("robomill", MFD_CLOEXEC));
  const std::string place = fmt::format("/proc/self/fd/{}", memory.get());
  // A header of our own, since the library's carries the date.
  MatFile mat(Mat_CreateVer(place.c_str(), "MATLAB 5.0 MAT-file, robomill", MAT_FT_MAT5), &Mat_Close);
  if (!mat) throw InvalidInput(path.string(), "cannot be written");
  for (const MatVariable& variable : variables) {
    std::array<std::size_t, 2> dims = {static_cast<std::size_t>(variable.re.rows()),
                                       static_cast<std::size_t>(variable.re.cols())};
    Eigen::MatrixXd re = variable.re, im = variable.im;
    mat_complex_split_t split{re.data(), im.data()};
    const bool is_complex = im.size() > 0;
    void* data = is_complex ? static_cast<void*>(&split) : static_cast<void*>(re.data());
    const int flags = MAT_F_DONT_COPY_DATA | (is_complex ? static_cast<int>(MAT_F_COMPLEX) : 0);
    const Variable written(
        Mat_VarCreate(variable.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims.data(), data, flags), &Mat_VarFree);
    if (!written || Mat_VarWrite(mat.get(), written.get(), MAT_COMPRESSION_ZLIB) != 0) {
      throw InvalidInput(path.string(), "cannot be written", "variable " + variable.name);
    }
  }
  if (Mat_Close(mat.release()) != 0) throw InvalidInput(path.string(), "cannot be written");
  const std::string content = content_of(memory);
  const auto layout = mat_layout(content);
  if (!layout || !layout->whole || layout->variables != variables.size()) {
    throw InvalidInput(path.string(), "cannot be written", "Is there enough memory?");
  }
  pending.write(content);
  pending.commit();
}

}  // namespace robomill::io
