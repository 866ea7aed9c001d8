#include "robomill/io/records/tree/mat_tree.hpp"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/records/mat_layout.hpp"
#include "robomill/io/records/mat_numbers.hpp"
#include "robomill/io/records/tree/tree_builder.hpp"

namespace robomill::io {
namespace {

constexpr int deepest_struct = 32;
constexpr std::size_t most_elements = 4096, longest_mat_text = 4096;

using OpenMat = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using OwnedVariable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

template <class T>
double value_at(const void* data, std::uint64_t place) {
  return static_cast<double>(static_cast<const T*>(data)[place]);
}

using ValueAt = double (*)(const void*, std::uint64_t);

ValueAt value_of(matio_classes type) {
  switch (type) {
    case MAT_C_DOUBLE:
      return value_at<double>;
    case MAT_C_SINGLE:
      return value_at<float>;
    case MAT_C_INT64:
      return value_at<std::int64_t>;
    case MAT_C_UINT64:
      return value_at<std::uint64_t>;
    case MAT_C_INT32:
      return value_at<std::int32_t>;
    case MAT_C_UINT32:
      return value_at<std::uint32_t>;
    case MAT_C_INT16:
      return value_at<std::int16_t>;
    case MAT_C_UINT16:
      return value_at<std::uint16_t>;
    case MAT_C_INT8:
      return value_at<std::int8_t>;
    default:
      return value_at<std::uint8_t>;
  }
}

/// Why a variable is neither numbers, text, a struct nor a cell; null: it may be.
const char* other_kind(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_SPARSE:
      return sparse_matrix;
    case MAT_C_FUNCTION:
      return function_handle;
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
      return matlab_object;
    default:
      return nullptr;
  }
}

std::vector<std::uint64_t> sides_of(const matvar_t& variable) {
  if (variable.dims == nullptr || variable.rank < 1) return {0};
  return {variable.dims, variable.dims + variable.rank};
}

std::uint64_t elements_of(const matvar_t& variable) {
  std::uint64_t out = 1;
  for (const std::uint64_t side : sides_of(variable)) {
    if (side > most_elements || out > most_elements) return most_elements + 1;
    out *= side;
  }
  return out;
}

class MatTreeReader {
 public:
  MatTreeReader(FileTree& tree, const std::string& file, std::size_t file_bytes)
      : builder_(tree, file, most_values_of(file_bytes)), file_(file), file_bytes_(file_bytes) {}

  void read(mat_t* mat, std::size_t count) {
    for (std::size_t i = 0;; ++i) {
      const OwnedVariable variable(Mat_VarReadNextInfo(mat), &Mat_VarFree);
      if (!variable && i < count) {
        throw InvalidInput(file_, fmt::format("variable {} cannot be read, nor what follows it", i + 1),
                           "Is the file damaged, or does it hold objects? Save the numbers alone");
      }
      if (!variable) break;
      if (variable->name == nullptr) {  // of objects the library reads none
        if (const char* const other = other_kind(*variable); other != nullptr) builder_.add_fault(0, "", "", other);
        continue;
      }
      const std::string name = variable->name;
      if (!is_wanted(*variable, name)) continue;
      if (Mat_VarReadDataAll(mat, variable.get()) != 0) {
        throw InvalidInput(file_, fmt::format("variable {} cannot be read", name));
      }
      add(*variable, 0, name, name, 0);
    }
  }

 private:
  /// By what it says of itself, before its values are read.
  bool is_wanted(const matvar_t& variable, const std::string& name) {
    if (variable.class_type == MAT_C_STRUCT || variable.class_type == MAT_C_CELL) return true;
    if (variable.class_type == MAT_C_CHAR) return elements_of(variable) <= longest_mat_text;
    if (const char* const other = other_kind(variable); other != nullptr) builder_.add_fault(0, name, name, other);
    const std::size_t width = mat_number_bytes(variable.class_type);
    if (width == 0 || variable.isLogical != 0) return false;
    std::uint64_t rows = 0, columns = 0;
    if (!squeezed(sides_of(variable), rows, columns)) {
      builder_.add_fault(0, name, name, fmt::format("of {} dimensions", variable.rank));
      return false;
    }
    if (rows == 0 || columns == 0) return false;
    require_held(file_, name, rows, columns, variable.isComplex != 0 ? 2 * width : width, file_bytes_);
    return true;
  }

  void add(matvar_t& variable, std::size_t parent, const std::string& name, const std::string& key, int depth) {
    if (depth > deepest_struct) throw InvalidInput(file_, fmt::format("{} is nested too deep", name));
    switch (variable.class_type) {
      case MAT_C_STRUCT:
        add_struct(variable, parent, name, key, depth);
        break;
      case MAT_C_CELL:
        add_cell(variable, parent, name, key, depth);
        break;
      case MAT_C_CHAR:
        add_text(variable, parent, name, key);
        break;
      default:
        if (const char* const other = other_kind(variable); other != nullptr) {
          builder_.add_fault(parent, name, key, other);
        } else if (mat_number_bytes(variable.class_type) > 0 && variable.isLogical == 0) {
          add_numbers(variable, parent, name, key);
        }
    }
  }

  void require_few(const matvar_t& variable, const std::string& name) const {
    if (elements_of(variable) <= most_elements) return;
    throw InvalidInput(file_, fmt::format("{} has more than {} elements", name, most_elements),
                       "Save the channels alone");
  }

  void add_struct(matvar_t& variable, std::size_t parent, const std::string& name, const std::string& key, int depth) {
    require_few(variable, name);
    const std::size_t count = static_cast<std::size_t>(elements_of(variable));
    const unsigned fields = Mat_VarGetNumberOfFields(&variable);
    char* const* const names = Mat_VarGetStructFieldnames(&variable);
    if (names == nullptr || variable.data == nullptr) return;
    const std::size_t group = builder_.add_group(parent, name, key);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string element = count == 1 ? name : fmt::format("{}({})", name, i + 1);
      const std::size_t place = count == 1 ? group : builder_.add_group(group, element, "");
      for (unsigned field = 0; field < fields; ++field) {
        matvar_t* const value = Mat_VarGetStructFieldByIndex(&variable, field, i);
        if (value == nullptr || names[field] == nullptr) continue;
        const std::string own = names[field];
        add(*value, place, element + "." + own, own, depth + 1);
      }
    }
  }

  void add_cell(matvar_t& variable, std::size_t parent, const std::string& name, const std::string& key, int depth) {
    require_few(variable, name);
    if (variable.data == nullptr) return;
    const std::size_t group = builder_.add_group(parent, name, key);
    std::vector<std::string> texts;
    const int count = static_cast<int>(elements_of(variable));
    for (int i = 0; i < count; ++i) {
      matvar_t* const value = Mat_VarGetCell(&variable, i);
      if (value == nullptr) continue;
      if (value->class_type == MAT_C_CHAR) {
        texts.push_back(text_of_mat(*value));
      } else {
        add(*value, group, fmt::format("{}{{{}}}", name, i + 1), key, depth + 1);
      }
    }
    // A cell of texts is a list of names or units.
    if (!texts.empty()) builder_.add_texts(parent, name, key, std::move(texts));
  }

  [[nodiscard]] static std::string text_of_mat(const matvar_t& variable) {
    const std::uint64_t count = elements_of(variable);
    if (variable.data == nullptr || count > longest_mat_text || variable.rank != 2) return {};
    if (std::min(variable.dims[0], variable.dims[1]) != 1) return {};
    const auto letters = static_cast<std::size_t>(count);
    if (variable.data_type == MAT_T_UINT16 || variable.data_type == MAT_T_UTF16) {
      if (variable.nbytes < 2 * letters) return {};
      return utf8_of(static_cast<const std::uint16_t*>(variable.data), letters);
    }
    // Of UTF-8 the letters are counted, and the bytes are more.
    const std::string_view bytes(static_cast<const char*>(variable.data), variable.nbytes);
    return std::string(bytes.substr(0, std::min(bytes.find('\0'), bytes.size())));
  }

  void add_text(const matvar_t& variable, std::size_t parent, const std::string& name, const std::string& key) {
    if (std::string text = text_of_mat(variable); !text.empty()) {
      builder_.add_texts(parent, name, key, {std::move(text)});
    }
  }

  void add_numbers(const matvar_t& variable, std::size_t parent, const std::string& name, const std::string& key) {
    std::uint64_t rows = 0, columns = 0;
    std::string fault;
    if (!squeezed(sides_of(variable), rows, columns)) fault = fmt::format("of {} dimensions", variable.rank);
    if (fault.empty() && (rows == 0 || columns == 0)) return;
    if (variable.isComplex != 0) fault = "complex numbers";
    if (fault.empty()) fault = TreeBuilder::lie_fault(rows, columns);
    if (!fault.empty()) return builder_.add_fault(parent, name, key, std::move(fault));
    builder_.require_room(name, rows, columns);
    if (variable.data == nullptr || variable.nbytes / mat_number_bytes(variable.class_type) / columns < rows) {
      throw InvalidInput(file_, fmt::format("variable {} cannot be read", name));
    }
    const MatrixLie lie = matrix_lie(rows, columns);
    FileNode node{.parent = parent, .kind = FileNode::Kind::numbers, .name = name, .key = key};
    node.by_rows = lie.by_rows;
    const ValueAt value = value_of(variable.class_type);
    for (std::uint64_t c = 0; c < lie.columns; ++c) {
      Eigen::VectorXd& column = node.columns.emplace_back(static_cast<Eigen::Index>(lie.samples));
      for (std::uint64_t s = 0; s < lie.samples; ++s) {
        column(static_cast<Eigen::Index>(s)) = value(variable.data, lie.by_rows ? s * rows + c : c * rows + s);
      }
    }
    builder_.add(std::move(node));
  }

  TreeBuilder builder_;
  std::string file_;
  std::size_t file_bytes_ = 0;
};

}  // namespace

FileTree read_mat_tree(const std::string& file, std::size_t file_bytes, std::size_t count) {
  const OpenMat mat(Mat_Open(file.c_str(), MAT_ACC_RDONLY), &Mat_Close);
  if (!mat) throw InvalidInput(file, "is no MAT file");
  FileTree out(FileTree::Naming::matlab);
  MatTreeReader(out, file, file_bytes).read(mat.get(), count);
  return out;
}

}  // namespace robomill::io
