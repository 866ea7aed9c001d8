#include "robomill/io/records/tree/hdf5_tree.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/records/hdf5_id.hpp"
#include "robomill/io/records/hdf5_parts.hpp"
#include "robomill/io/records/tree/tree_builder.hpp"

namespace robomill::io {
namespace {

constexpr int deepest_group = 32;
constexpr const char* other_type = "values of a type that is not read";
constexpr hsize_t most_set_texts = 4096, most_references = 4096;
constexpr std::size_t longest_set_text = 4096;

/// Of H5Literate and H5Aiterate. Nothing may be thrown through the library.
herr_t add_link_name(hid_t /*group*/, const char* name, const H5L_info_t* /*link*/, void* data) {
  try {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

herr_t add_attribute_name(hid_t /*object*/, const char* name, const H5A_info_t* /*info*/, void* data) {
  return add_link_name(0, name, nullptr, data);
}

bool is_plain_number(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

/// Sides of a space; false where it has none or too many.
bool sides_of(hid_t space, std::vector<std::uint64_t>& sides) {
  std::array<hsize_t, H5S_MAX_RANK> found = {};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || H5Sget_simple_extent_type(space) == H5S_NULL) return false;
  if (H5Sget_simple_extent_dims(space, found.data(), nullptr) < 0) return false;
  sides.assign(found.begin(), found.begin() + rank);
  return true;
}

class Hdf5TreeReader {
 public:
  Hdf5TreeReader(FileTree& tree, const std::string& file, std::uint64_t file_bytes, bool of_matlab)
      : builder_(tree, file, most_values_of(file_bytes)), file_(file), of_matlab_(of_matlab) {}

  void read(hid_t file) {
    const Hdf5Id root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose);
    if (!root.good()) throw InvalidInput(file_, damaged_hdf5);
    add_attributes(root.get(), 0, "");
    read_group(root.get(), 0, "", 0);
  }

 private:
  [[nodiscard]] std::string path_of(const std::string& group, const std::string& key) const {
    return group.empty() ? key : group + (of_matlab_ ? "." : "/") + key;
  }

  void read_group(hid_t group, std::size_t place, const std::string& name, int depth) {
    if (depth > deepest_group) throw InvalidInput(file_, fmt::format("group {} is nested too deep", name));
    H5O_info_t info = {};
    if (H5Oget_info2(group, &info, H5O_INFO_BASIC) < 0) throw InvalidInput(file_, damaged_hdf5);
    if (!visited_.insert(info.addr).second) return;  // a link back
    std::vector<std::string> keys;
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add_link_name, &keys) < 0) {
      throw InvalidInput(file_, damaged_hdf5);
    }
    for (const std::string& key : keys) {
      if (of_matlab_ && depth == 0 && key.starts_with('#')) continue;  // what others refer to
      const Hdf5Id object(H5Oopen(group, key.c_str(), H5P_DEFAULT), H5Oclose);
      if (object.good()) read_object(object.get(), place, path_of(name, key), key, depth);
    }
  }

  void read_object(hid_t object, std::size_t parent, const std::string& name, const std::string& key, int depth) {
    if (const char* const fault = of_matlab_ ? matlab_fault(object) : nullptr; fault != nullptr) {
      builder_.add_fault(parent, name, key, fault);
    } else if (H5Iget_type(object) == H5I_DATASET) {
      read_set(object, parent, name, key, depth);
    } else if (H5Iget_type(object) == H5I_GROUP) {
      const std::size_t place = builder_.add_group(parent, name, key);
      add_attributes(object, place, name);
      read_group(object, place, name, depth + 1);
    }
  }

  void read_set(hid_t set, std::size_t parent, const std::string& name, const std::string& key, int depth) {
    if (const std::string fault = storage_fault(set); !fault.empty()) {
      throw InvalidInput(file_, fmt::format("{} {}", name, fault), "Save the file anew, with all of its data in it");
    }
    const std::string matlab_class = of_matlab_ ? class_of(set) : "";
    if (of_matlab_ && (H5Aexists(set, "MATLAB_empty") > 0 || matlab_class == "logical")) return;
    const Hdf5Id type(H5Dget_type(set), H5Tclose), space(H5Dget_space(set), H5Sclose);
    std::vector<std::uint64_t> sides;
    if (!type.good() || !sides_of(space.get(), sides)) return;
    switch (H5Tget_class(type.get())) {
      case H5T_INTEGER:
      case H5T_FLOAT:
        if (matlab_class == "char") {
          builder_.add_texts(parent, name, key, {letters_of(set, sides)});
        } else {
          read_numbers(set, nullptr, parent, name, key, sides);
        }
        break;
      case H5T_STRING:
        read_texts(set, type.get(), space.get(), parent, name, key);
        break;
      case H5T_COMPOUND:
        read_fields(set, type.get(), parent, name, key, sides);
        break;
      case H5T_REFERENCE:
        if (of_matlab_) read_references(set, parent, name, key, sides, matlab_class == "cell", depth);
        break;
      default:
        builder_.add_fault(parent, name, key, other_type);
    }
  }

  /// Why a group or data set of MATLAB is neither a struct nor numbers; null: it may be.
  [[nodiscard]] static const char* matlab_fault(hid_t object) {
    const H5I_type_t type = H5Iget_type(object);
    if (type != H5I_GROUP && type != H5I_DATASET) return nullptr;
    if (H5Aexists(object, "MATLAB_sparse") > 0) return sparse_matrix;
    if (class_of(object) == "function_handle") return function_handle;
    return H5Aexists(object, "MATLAB_object_decode") > 0 ? matlab_object : nullptr;
  }

  [[nodiscard]] static std::string class_of(hid_t object) {
    if (H5Aexists(object, "MATLAB_class") <= 0) return {};
    const Hdf5Id attribute(H5Aopen(object, "MATLAB_class", H5P_DEFAULT), H5Aclose);
    const Hdf5Id stored(H5Aget_type(attribute.get()), H5Tclose);
    std::array<char, 32> name = {};
    if (H5Tget_class(stored.get()) != H5T_STRING || H5Tis_variable_str(stored.get()) != 0 ||
        H5Tget_size(stored.get()) >= name.size() || H5Aread(attribute.get(), stored.get(), name.data()) < 0) {
      return {};
    }
    return name.data();
  }

  /// @param member  of a compound type; null: the values themselves
  void read_numbers(hid_t set, const char* member, std::size_t parent, const std::string& name, const std::string& key,
                    const std::vector<std::uint64_t>& sides) {
    FileNode node{.parent = parent, .kind = FileNode::Kind::numbers, .name = name, .key = key};
    std::uint64_t rows = 0, columns = 0;
    if (!squeezed(sides, rows, columns)) node.fault = fmt::format("of {} dimensions", sides.size());
    if (of_matlab_ && node.fault.empty()) std::swap(rows, columns);  // HDF5 keeps rows together, MATLAB columns
    if (node.fault.empty()) node.fault = TreeBuilder::lie_fault(rows, columns);
    if (node.fault.empty() && (rows == 0 || columns == 0)) return;
    if (node.fault.empty()) {
      builder_.require_room(name, rows, columns);
      const MatrixLie lie = matrix_lie(rows, columns);
      node.by_rows = lie.by_rows;
      const bool together = lie.by_rows != of_matlab_ || lie.columns == 1;
      if (!read_columns(set, member, lie, together, node.columns)) {
        throw InvalidInput(file_, fmt::format("{} cannot be read", name), "Is the file damaged?");
      }
    }
    const std::size_t place = builder_.add(std::move(node));
    if (member == nullptr) add_attributes(set, place, name);
  }

  /// @param together  the samples of a column stand behind each other
  static bool read_columns(hid_t set, const char* member, const MatrixLie& lie, bool together,
                           std::vector<Eigen::VectorXd>& columns) {
    const auto samples = static_cast<Eigen::Index>(lie.samples), count = static_cast<Eigen::Index>(lie.columns);
    Eigen::MatrixXd values(together ? samples : count, together ? count : samples);
    if (!read_doubles(set, member, values.data())) return false;
    for (Eigen::Index i = 0; i < count; ++i) {
      columns.emplace_back(together ? Eigen::VectorXd(values.col(i)) : Eigen::VectorXd(values.row(i).transpose()));
    }
    return true;
  }

  static bool read_doubles(hid_t set, const char* member, double* to) {
    if (member == nullptr) return H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) >= 0;
    const Hdf5Id part(H5Tcreate(H5T_COMPOUND, sizeof(double)), H5Tclose);
    return H5Tinsert(part.get(), member, 0, H5T_NATIVE_DOUBLE) >= 0 &&
           H5Dread(set, part.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, to) >= 0;
  }

  /// A table: each field a column.
  void read_fields(hid_t set, hid_t type, std::size_t parent, const std::string& name, const std::string& key,
                   const std::vector<std::uint64_t>& sides) {
    const bool is_complex = H5Tget_nmembers(type) == 2 &&
                            ((H5Tget_member_index(type, "real") >= 0 && H5Tget_member_index(type, "imag") >= 0) ||
                             (H5Tget_member_index(type, "r") >= 0 && H5Tget_member_index(type, "i") >= 0));
    if (is_complex) {
      builder_.add_fault(parent, name, key, "complex numbers");
      return;
    }
    const std::size_t place = builder_.add_group(parent, name, key);
    add_attributes(set, place, name);
    for (int i = 0; i < H5Tget_nmembers(type); ++i) {
      char* const member = H5Tget_member_name(type, static_cast<unsigned>(i));
      if (member == nullptr) continue;
      const std::string field = member;
      H5free_memory(member);
      const Hdf5Id stored(H5Tget_member_type(type, static_cast<unsigned>(i)), H5Tclose);
      if (is_plain_number(stored.get())) {
        read_numbers(set, field.c_str(), place, path_of(name, field), field, sides);
      } else {
        builder_.add_fault(place, path_of(name, field), field, other_type);
      }
    }
  }

  /// Letters of MATLAB, two bytes each; empty: not one line of them.
  static std::string letters_of(hid_t set, const std::vector<std::uint64_t>& sides) {
    std::uint64_t rows = 0, columns = 0;
    if (!squeezed(sides, rows, columns) || std::min(rows, columns) != 1 || rows * columns > longest_set_text) return {};
    std::vector<std::uint16_t> letters(static_cast<std::size_t>(rows * columns));
    if (H5Dread(set, H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, letters.data()) < 0) return {};
    return utf8_of(letters.data(), letters.size());
  }

  /// Of an element of a cell: whether it is text.
  bool add_letters(hid_t object, std::vector<std::string>& texts) {
    if (H5Iget_type(object) != H5I_DATASET || class_of(object) != "char" || !storage_fault(object).empty())
      return false;
    const Hdf5Id space(H5Dget_space(object), H5Sclose);
    std::vector<std::uint64_t> sides;
    if (!sides_of(space.get(), sides)) return false;
    texts.push_back(letters_of(object, sides));
    return true;
  }

  /// Of a data set or an attribute; too many or too long ones are none.
  template <class Read>
  static bool texts_of(hid_t type, hid_t space, const Read& read, std::vector<std::string>& texts) {
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const std::size_t size = H5Tget_size(type);
    if (count < 1 || static_cast<hsize_t>(count) > most_set_texts || size > longest_set_text) return false;
    if (H5Tis_variable_str(type) > 0) {
      std::vector<char*> pointers(static_cast<std::size_t>(count), nullptr);
      if (read(type, pointers.data()) < 0) return false;
      for (const char* text : pointers) {
        texts.emplace_back(text == nullptr ? "" : std::string(text, ::strnlen(text, longest_set_text)));
      }
      H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
      return true;
    }
    std::string all(static_cast<std::size_t>(count) * size, '\0');
    if (read(type, all.data()) < 0) return false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const std::string_view text = std::string_view(all).substr(i * size, size);
      texts.emplace_back(text.substr(0, text.find('\0')));
    }
    return true;
  }

  void read_texts(hid_t set, hid_t type, hid_t space, std::size_t parent, const std::string& name,
                  const std::string& key) {
    std::vector<std::string> texts;
    const auto read = [set](hid_t memory, void* to) { return H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, to); };
    if (texts_of(type, space, read, texts)) builder_.add_texts(parent, name, key, std::move(texts));
  }

  /// Cells, and fields of an array of structs: s(2).x is the second of the references in s.x.
  void read_references(hid_t set, std::size_t parent, const std::string& name, const std::string& key,
                       const std::vector<std::uint64_t>& sides, bool is_cell, int depth) {
    std::uint64_t rows = 0, columns = 0;
    if (!squeezed(sides, rows, columns) || rows > most_references || columns > most_references ||
        rows * columns > most_references) {
      throw InvalidInput(file_, fmt::format("{} has more than {} elements", name, most_references),
                         "Save the channels alone");
    }
    std::vector<hobj_ref_t> references(static_cast<std::size_t>(rows * columns));
    if (H5Dread(set, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data()) < 0) return;
    const std::size_t cell = is_cell ? builder_.add_group(parent, name, key) : 0;
    std::vector<std::string> texts;  // of a cell of them: a list of names or units
    for (std::size_t i = 0; i < references.size(); ++i) {
      const Hdf5Id object(H5Rdereference2(set, H5P_DEFAULT, H5R_OBJECT, &references[i]), H5Oclose);
      if (!object.good() || depth > deepest_group) continue;
      if (is_cell && add_letters(object.get(), texts)) continue;
      if (is_cell) {
        read_object(object.get(), cell, fmt::format("{}{{{}}}", name, i + 1), key, depth + 1);
      } else {
        const std::string group = name.substr(0, name.size() - std::min(name.size(), key.size() + 1));
        const std::string element = fmt::format("{}({})", group, i + 1);
        const auto [found, is_new] = elements_.try_emplace({parent, i}, 0);
        if (is_new) found->second = builder_.add_group(parent, element, "");
        read_object(object.get(), found->second, path_of(element, key), key, depth + 1);
      }
    }
    if (!texts.empty()) builder_.add_texts(parent, name, key, std::move(texts));
  }

  /// Single numbers and texts.
  void add_attributes(hid_t object, std::size_t place, const std::string& name) {
    std::vector<std::string> keys;
    hsize_t from = 0;
    if (H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &from, add_attribute_name, &keys) < 0) return;
    for (const std::string& key : keys) {
      if (key.starts_with("MATLAB_") || key.starts_with("H5PATH")) continue;
      const Hdf5Id attribute(H5Aopen(object, key.c_str(), H5P_DEFAULT), H5Aclose);
      const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose), space(H5Aget_space(attribute.get()), H5Sclose);
      if (!attribute.good() || !type.good() || !space.good()) continue;
      const std::string own = name + "@" + key;
      const hid_t id = attribute.get();
      if (is_plain_number(type.get()) && H5Sget_simple_extent_npoints(space.get()) == 1) {
        double value = 0.0;
        if (H5Aread(id, H5T_NATIVE_DOUBLE, &value) < 0) continue;
        builder_.add({.parent = place,
                      .kind = FileNode::Kind::numbers,
                      .name = own,
                      .key = key,
                      .columns = {Eigen::VectorXd::Constant(1, value)}});
      } else if (H5Tget_class(type.get()) == H5T_STRING) {
        std::vector<std::string> texts;
        const auto read = [id](hid_t memory, void* to) { return H5Aread(id, memory, to); };
        if (texts_of(type.get(), space.get(), read, texts)) builder_.add_texts(place, own, key, std::move(texts));
      }
    }
  }

  TreeBuilder builder_;
  std::string file_;
  bool of_matlab_ = false;
  std::set<haddr_t> visited_;  ///< groups
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> elements_;
};

}  // namespace

FileTree read_hdf5_tree(std::string_view content, const std::string& file, bool of_matlab) {
  quiet_hdf5();
  const Hdf5Id opened = open_hdf5_image(content);
  if (!opened.good()) throw InvalidInput(file, damaged_hdf5);
  require_self_contained(opened.get(), file);
  FileTree out(of_matlab ? FileTree::Naming::matlab : FileTree::Naming::python);
  Hdf5TreeReader(out, file, content.size(), of_matlab).read(opened.get());
  return out;
}

}  // namespace robomill::io
