#include "robomill/io/records/hdf5_table.hpp"

#include <algorithm>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/hdf5_output.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t most_chunk_rows = 16384;
constexpr std::size_t most_chunk_bytes = std::size_t{4} << 20;  // of texts: the library holds a chunk in memory
constexpr unsigned compression = 1;  // of 9: three times as fast as the usual 6, and hardly larger

Hdf5Id text_type(std::size_t bytes) {
  Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  if (H5Tset_size(type.get(), bytes) < 0 || H5Tset_cset(type.get(), H5T_CSET_UTF8) < 0) return {};
  return type;
}

}  // namespace

Hdf5Table::Hdf5Table(const std::filesystem::path& path) : path_(path), pending_(path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its errors are reported as ours
  restart();
}

void Hdf5Table::restart() {
  close();
  require(file_.reset());
  next_ = 0;
  file_ = Hdf5Id(create_hdf5(pending_), H5Fclose);
  require(file_.good());
}

std::size_t Hdf5Table::column(const std::string& name, const std::string& unit, Kind kind, std::size_t longest) {
  const hsize_t none = 0;
  const hsize_t unlimited = H5S_UNLIMITED;
  const Hdf5Id space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
  Column column;
  column.chunk_rows = most_chunk_rows;
  if (kind == Kind::text) {
    column.longest = std::max<std::size_t>(longest, 1);
    column.chunk_rows = std::clamp<std::size_t>(most_chunk_bytes / column.longest, 1, most_chunk_rows);
    column.type = text_type(column.longest);
  } else {
    column.type = Hdf5Id(H5Tcopy(kind == Kind::whole ? H5T_STD_I64LE : H5T_IEEE_F64LE), H5Tclose);
    column.waiting.reserve(column.chunk_rows);
  }
  const hsize_t rows = column.chunk_rows;
  const Hdf5Id layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  require(H5Pset_chunk(layout.get(), 1, &rows) >= 0 && H5Pset_shuffle(layout.get()) >= 0 &&
          H5Pset_deflate(layout.get(), compression) >= 0 &&
          H5Pset_obj_track_times(layout.get(), false) >= 0);  // the same rows, the same bytes
  column.set = Hdf5Id(
      H5Dcreate2(file_.get(), name.c_str(), column.type.get(), space.get(), H5P_DEFAULT, layout.get(), H5P_DEFAULT),
      H5Dclose);
  require(column.set.good());
  attribute_of(column.set.get(), "unit", unit);
  columns_.push_back(std::move(column));
  return columns_.size() - 1;
}

void Hdf5Table::put(std::string_view text) {
  Column& column = columns_[next_++];
  const std::size_t rows = column.waiting_text.size() / column.longest + 1;
  column.waiting_text += text.substr(0, column.longest);
  column.waiting_text.resize(rows * column.longest, '\0');
  if (rows == column.chunk_rows) flush(column);
}

PendingFile& Hdf5Table::finish() {
  for (Column& column : columns_) flush(column);
  close();
  require(file_.reset());
  pending_.prepare();
  require(is_whole_hdf5(pending_.temporary()));
  return pending_;
}

/// What the library says, and what the system said meanwhile.
void Hdf5Table::require(bool good) {
  if (pending_.failed()) pending_.prepare();  // says why
  if (!good) throw InvalidInput(path_.string(), "cannot be written", "Is there room on the disk?");
}

void Hdf5Table::close() {
  for (Column& column : columns_) require(column.set.reset());
  columns_.clear();
}

void Hdf5Table::attribute_of(hid_t owner, const char* name, double value) {
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id attribute(H5Acreate2(owner, name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &value) >= 0);
}

void Hdf5Table::attribute_of(hid_t owner, const char* name, const std::string& value) {
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id type = text_type(value.size() + 1);
  const Hdf5Id attribute(H5Acreate2(owner, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(H5Awrite(attribute.get(), type.get(), value.c_str()) >= 0);
}

void Hdf5Table::flush(Column& column) {
  const bool texts = column.longest > 0;
  const hsize_t count = texts ? column.waiting_text.size() / column.longest : column.waiting.size();
  if (count == 0) return;
  const hsize_t all = column.rows + count;
  const Hdf5Id memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
  require(H5Dset_extent(column.set.get(), &all) >= 0);
  const Hdf5Id space(H5Dget_space(column.set.get()), H5Sclose);
  require(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &column.rows, nullptr, &count, nullptr) >= 0);
  const hid_t type = texts ? column.type.get() : H5T_NATIVE_DOUBLE;
  const void* const values = texts ? static_cast<const void*>(column.waiting_text.data()) : column.waiting.data();
  require(H5Dwrite(column.set.get(), type, memory.get(), space.get(), H5P_DEFAULT, values) >= 0);
  column.waiting.clear();
  column.waiting_text.clear();
  column.rows = all;
}

}  // namespace robomill::io
