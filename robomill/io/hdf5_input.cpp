#include "robomill/io/hdf5_input.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <cstddef>
#include <exception>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t most_objects = 1000000;

/// What was found while links were visited.
struct Found {
  std::size_t objects = 0;
  std::string object = {}, rule = {};
};

/// What is wrong with how a data set stores its values; empty: nothing.
std::string storage_fault(hid_t set) {
  const hid_t list = H5Dget_create_plist(set);
  if (list < 0) return "cannot be examined";
  std::string out;
  if (H5Pget_external_count(list) != 0) out = "keeps its values in another file";
  if (H5Pget_layout(list) == H5D_VIRTUAL) out = "is a virtual data set, which is made of others'";
  const int filters = H5Pget_nfilters(list);
  for (int i = 0; out.empty() && i < filters; ++i) {
    unsigned flags = 0, configuration = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(list, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &configuration);
    const bool own = filter >= H5Z_FILTER_DEFLATE && filter <= H5Z_FILTER_SCALEOFFSET;
    if (!own) out = fmt::format("needs the filter {}, which is a plug-in", filter);
  }
  H5Pclose(list);
  return out;
}

/// What is wrong with an object of the file itself.
std::string object_fault(hid_t group, const char* name) {
  const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
  if (object < 0) return "cannot be opened";
  std::string out;
  if (H5Iget_type(object) == H5I_DATASET) out = storage_fault(object);
  H5Oclose(object);
  return out;
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

}  // namespace

void require_self_contained_hdf5(const std::filesystem::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its errors are reported as ours
  H5PLset_loading_state(0);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) throw InvalidInput(path.string(), "is a damaged HDF5 file, or one that was cut off");
  Found found;
  const herr_t ended = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &found);
  H5Fclose(file);
  if (!found.rule.empty()) {
    throw InvalidInput(path.string(), fmt::format("{} {}", found.object, found.rule),
                       "Save the file anew, with all of its data in it");
  }
  if (ended < 0) throw InvalidInput(path.string(), "is a damaged HDF5 file, or one that was cut off");
}

}  // namespace robomill::io
