#include "robomill/io/records/hdf5_input.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <exception>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/hdf5_id.hpp"
#include "robomill/io/records/hdf5_parts.hpp"
#include "robomill/io/records/mat_layout.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t most_objects = 1000000;
constexpr std::array number_classes = {"double", "single", "int8",   "uint8", "int16",
                                       "uint16", "int32",  "uint32", "int64", "uint64"};

/// What was found while links were visited.
struct Found {
  std::size_t objects = 0;
  std::string object = {}, rule = {};
};

/// What is wrong with an object of the file itself.
std::string object_fault(hid_t group, const char* name) {
  const Hdf5Id object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
  if (!object.good()) return "cannot be opened";
  return H5Iget_type(object.get()) == H5I_DATASET ? storage_fault(object.get()) : std::string();
}

/// Of H5Lvisit: 0 goes on, 1 ends. Nothing may be thrown through the library.
herr_t visit(hid_t group, const char* name, const H5L_info_t* link, void* data) {
  auto& found = *static_cast<Found*>(data);
  try {
    if (++found.objects > most_objects) {
      found.rule = "has too many objects";
    } else if (link->type == H5L_TYPE_EXTERNAL) {
      found.rule = "is a link to another file";
    } else if (link->type == H5L_TYPE_HARD) {
      found.rule = object_fault(group, name);
    } else if (link->type != H5L_TYPE_SOFT) {
      found.rule = "is a link of an unknown kind";
    }
    if (found.rule.empty()) return 0;
    found.object = name;
    return 1;
  } catch (const std::exception&) {
    return -1;
  }
}

/// Of H5Literate.
herr_t add_name(hid_t /*group*/, const char* name, const H5L_info_t* /*link*/, void* data) {
  try {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

/// Whether MATLAB says of a data set that it is no matrix of numbers: text, logical values, places of others, or empty.
bool is_of_another_class(hid_t set) {
  if (H5Aexists(set, "MATLAB_empty") > 0) return true;
  if (H5Aexists(set, "MATLAB_class") <= 0) return false;
  const Hdf5Id attribute(H5Aopen(set, "MATLAB_class", H5P_DEFAULT), H5Aclose);
  const Hdf5Id stored(H5Aget_type(attribute.get()), H5Tclose);
  std::array<char, 16> name = {};
  if (H5Tget_class(stored.get()) != H5T_STRING || H5Tis_variable_str(stored.get()) != 0 ||
      H5Tget_size(stored.get()) >= name.size() || H5Aread(attribute.get(), stored.get(), name.data()) < 0) {
    return true;
  }
  return std::ranges::none_of(number_classes, [&](const char* each) { return std::strcmp(each, name.data()) == 0; });
}

enum class Numbers { none, real, complex };

Numbers numbers_of(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
    case H5T_FLOAT:
      return Numbers::real;
    case H5T_COMPOUND:
      return H5Tget_nmembers(type) == 2 && H5Tget_member_index(type, "real") >= 0 &&
                     H5Tget_member_index(type, "imag") >= 0
                 ? Numbers::complex
                 : Numbers::none;
    default:
      return Numbers::none;
  }
}

/// Of a data set in memory as doubles, or of one member of its pairs.
bool read_values(hid_t set, const char* member, Eigen::MatrixXd& to) {
  if (member == nullptr) return H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, to.data()) >= 0;
  const Hdf5Id part(H5Tcreate(H5T_COMPOUND, sizeof(double)), H5Tclose);
  return H5Tinsert(part.get(), member, 0, H5T_NATIVE_DOUBLE) >= 0 &&
         H5Dread(set, part.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, to.data()) >= 0;
}

/// A matrix of numbers, or nothing.
std::optional<MatVariable> variable_of(hid_t file, const std::string& name, std::size_t file_bytes,
                                       const std::string& file_name) {
  const Hdf5Id set(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!set.good() || H5Iget_type(set.get()) != H5I_DATASET || is_of_another_class(set.get())) return std::nullopt;
  const Hdf5Id type(H5Dget_type(set.get()), H5Tclose), space(H5Dget_space(set.get()), H5Sclose);
  const Numbers numbers = numbers_of(type.get());
  std::array<hsize_t, 2> sizes = {};  // of columns, rows: HDF5 keeps rows together, MATLAB columns
  if (numbers == Numbers::none || H5Sget_simple_extent_ndims(space.get()) != 2 ||
      H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr) != 2 || sizes[0] * sizes[1] == 0) {
    return std::nullopt;
  }
  const auto [columns, rows] = sizes;
  require_held(file_name, name, rows, columns, H5Tget_size(type.get()), file_bytes);
  MatVariable out{.name = name, .re = {}};
  out.re.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  const bool is_complex = numbers == Numbers::complex;
  if (is_complex) out.im.resizeLike(out.re);
  if (!read_values(set.get(), is_complex ? "real" : nullptr, out.re) ||
      (is_complex && !read_values(set.get(), "imag", out.im))) {
    throw InvalidInput(file_name, fmt::format("variable {} cannot be read", name));
  }
  return out;
}

}  // namespace

std::string storage_fault(hid_t set) {
  const Hdf5Id list(H5Dget_create_plist(set), H5Pclose);
  if (!list.good()) return "cannot be examined";
  if (H5Pget_external_count(list.get()) != 0) return "keeps its values in another file";
  if (H5Pget_layout(list.get()) == H5D_VIRTUAL) return "is a virtual data set, which is made of others'";
  const int filters = H5Pget_nfilters(list.get());
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, configuration = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(list.get(), static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &configuration);
    const bool own = filter >= H5Z_FILTER_DEFLATE && filter <= H5Z_FILTER_SCALEOFFSET;
    if (!own) return fmt::format("needs the filter {}, which is a plug-in", filter);
  }
  return {};
}

void require_self_contained(hid_t file, const std::string& name) {
  Found found;
  const herr_t ended = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &found);
  if (!found.rule.empty()) {
    throw InvalidInput(name, fmt::format("{} {}", found.object, found.rule),
                       "Save the file anew, with all of its data in it");
  }
  if (ended < 0) throw InvalidInput(name, damaged_hdf5);
}

Hdf5Id open_hdf5_image(std::string_view content) {
  constexpr std::size_t growth = 1 << 16;
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  std::string image(content);  // the library wants to be able to write, and copies it
  if (H5Pset_fapl_core(access.get(), growth, 0) < 0 ||
      H5Pset_file_image(access.get(), image.data(), image.size()) < 0) {
    return {};
  }
  return {H5Fopen("/dev/null/image", H5F_ACC_RDONLY, access.get()), H5Fclose};
}

void quiet_hdf5() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);
}

std::vector<MatVariable> read_hdf5_matrices(std::string_view content, const std::string& file_name) {
  quiet_hdf5();
  const Hdf5Id file = open_hdf5_image(content);
  if (!file.good()) throw InvalidInput(file_name, damaged_hdf5);
  require_self_contained(file.get(), file_name);
  std::vector<std::string> names;
  if (H5Literate(file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add_name, &names) < 0) {
    throw InvalidInput(file_name, damaged_hdf5);
  }
  std::vector<MatVariable> out;
  for (const std::string& name : names) {
    if (std::optional<MatVariable> found = variable_of(file.get(), name, content.size(), file_name)) {
      out.push_back(*std::move(found));
    }
  }
  return out;
}

}  // namespace robomill::io
