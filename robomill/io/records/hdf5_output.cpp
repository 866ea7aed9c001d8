#include "robomill/io/records/hdf5_output.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

namespace robomill::io {
namespace {

/// What a list of access properties holds for the driver.
struct Target {
  PendingFile* file;
};

/// An open file, as the library passes it back: its base first, as in C.
struct Open {
  H5FD_t base;
  PendingFile* file;
  haddr_t end_of_addresses;
};

Open& of(H5FD_t* file) {
  return *reinterpret_cast<Open*>(file);
}
const Open& of(const H5FD_t* file) {
  return *reinterpret_cast<const Open*>(file);
}

H5FD_t* open_file_of_driver(const char* /*name*/, unsigned flags, hid_t access, haddr_t /*most*/) {
  const auto* target = static_cast<const Target*>(H5Pget_driver_info(access));
  if (target == nullptr || target->file == nullptr) return nullptr;
  auto open = std::unique_ptr<Open>(new (std::nothrow) Open{});
  if (open == nullptr) return nullptr;
  open->file = target->file;
  if ((flags & H5F_ACC_TRUNC) != 0) target->file->resize(0);
  return &open.release()->base;
}

herr_t close_file(H5FD_t* file) {
  const std::unique_ptr<Open> gone(&of(file));
  return 0;
}

int compare(const H5FD_t* one, const H5FD_t* other) {
  const auto* first = of(one).file;
  const auto* second = of(other).file;
  return std::less<>()(first, second) ? -1 : first == second ? 0 : 1;
}

herr_t query(const H5FD_t* /*file*/, unsigned long* flags) {
  if (flags != nullptr) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
  }
  return 0;
}

haddr_t end_of_addresses(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return of(file).end_of_addresses;
}

herr_t set_end_of_addresses(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t end) {
  of(file).end_of_addresses = end;
  return 0;
}

haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return std::max<haddr_t>(of(file).file->size(), of(file).end_of_addresses);
}

herr_t read(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t from, std::size_t size, void* to) {
  const std::span<char> bytes(static_cast<char*>(to), size);
  const std::size_t count = of(file).file->read_at(from, bytes);
  std::ranges::fill(bytes.subspan(count), '\0');
  return 0;
}

herr_t write(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t to, std::size_t size, const void* from) {
  of(file).file->write_at(to, {static_cast<const char*>(from), size});
  return 0;
}

herr_t truncate(H5FD_t* file, hid_t /*transfer*/, hbool_t /*closing*/) {
  of(file).file->resize(of(file).end_of_addresses);
  return 0;
}

H5FD_class_t driver_class() {
  H5FD_class_t out{};
  out.name = "robomill";
  out.maxaddr = (haddr_t{1} << 62) - 1;
  out.fc_degree = H5F_CLOSE_STRONG;
  out.fapl_size = sizeof(Target);
  out.open = open_file_of_driver;
  out.close = close_file;
  out.cmp = compare;
  out.query = query;
  out.get_eoa = end_of_addresses;
  out.set_eoa = set_end_of_addresses;
  out.get_eof = end_of_file;
  out.read = read;
  out.write = write;
  out.truncate = truncate;
  constexpr H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
  std::ranges::copy(map, out.fl_map);
  return out;
}

/// As long as the library is open.
hid_t driver() {
  static const H5FD_class_t description = driver_class();
  static const hid_t id = H5FDregister(&description);
  return id;
}

}  // namespace

hid_t create_hdf5(PendingFile& pending) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (access < 0) return access;
  const Target target{&pending};
  hid_t file = -1;
  if (H5Pset_driver(access, driver(), &target) >= 0) {
    file = H5Fcreate(pending.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  }
  H5Pclose(access);
  return file;
}

bool is_whole_hdf5(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  return file >= 0 && H5Fclose(file) >= 0;
}

}  // namespace robomill::io
