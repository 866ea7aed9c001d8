#include <hdf5.h>

#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/records/hdf5_id.hpp"
#include "robomill/io/records/hdf5_output.hpp"
#include "robomill/path/files/trajectory_parts.hpp"

namespace robomill::path {
namespace {

constexpr hsize_t chunk = 16384;
constexpr unsigned compression = 1;  // of 9: three times as fast as the usual 6, and hardly larger

struct Column {
  std::string name, unit;
  io::Hdf5Id set = {};
  std::vector<double> waiting = {};
};

class Hdf5 final : public SampleFile {
 public:
  Hdf5(const std::filesystem::path& path, const TrajectoryInfo& info) : path_(path), info_(info), pending_(path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its errors are reported as ours
    begin();
  }

  void restart() override { begin(); }

  void add(std::span<const Sample> samples) override {
    for (const Sample& sample : samples) {
      std::size_t c = 0;
      columns_[c++].waiting.push_back(sample.time_s);
      for (int joint = 0; joint < info_.joints; ++joint) columns_[c++].waiting.push_back(sample.joints[joint]);
      for (int axis = 0; axis < 3; ++axis) columns_[c++].waiting.push_back(sample.tip_m[axis] / units::mm);
      for (int axis = 0; axis < 3; ++axis) columns_[c++].waiting.push_back(sample.axis[axis]);
      columns_[c].waiting.push_back(static_cast<double>(sample.block + 1));
      if (columns_[c].waiting.size() == chunk) flush();
    }
  }

  void state_collisions(const std::string& found) override { collisions_ = found; }

  io::PendingFile& finish() override {
    text(file_.get(), "collisions", collisions_);
    flush();
    close();
    require(file_.reset());
    pending_.prepare();
    require(io::is_whole_hdf5(pending_.temporary()));
    return pending_;
  }

 private:
  std::string collisions_ = unchecked_collisions;

  /// What the library says, and what the system said meanwhile.
  void require(bool good) {
    if (pending_.failed()) pending_.prepare();  // says why
    if (!good) throw InvalidInput(path_.string(), "cannot be written", "Is there room on the disk?");
  }

  void close() {
    for (Column& column : columns_) require(column.set.reset());
    columns_.clear();
  }

  void begin() {
    close();
    require(file_.reset());
    rows_ = 0;
    file_ = io::Hdf5Id(io::create_hdf5(pending_), H5Fclose);
    require(file_.good());
    text(file_.get(), "program", info_.program);
    text(file_.get(), "cell", info_.cell);
    number(file_.get(), "sample_period_s", info_.sample_period_s);
    open("time_s", "s");
    for (int joint = 0; joint < info_.joints; ++joint) open_joint(joint);
    for (const char* name : {"x_mm", "y_mm", "z_mm"}) open(name, "mm");
    for (const char* name : {"i", "j", "k"}) open(name, "1");
    open("block", "1", H5T_STD_I64LE);
  }

  void open(const std::string& name, const char* unit, hid_t type = H5T_IEEE_F64LE) {
    const hsize_t none = 0;
    const hsize_t unlimited = H5S_UNLIMITED;
    const io::Hdf5Id space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
    const io::Hdf5Id layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    require(H5Pset_chunk(layout.get(), 1, &chunk) >= 0 && H5Pset_shuffle(layout.get()) >= 0 &&
            H5Pset_deflate(layout.get(), compression) >= 0 &&
            H5Pset_obj_track_times(layout.get(), false) >= 0);  // the same samples, the same bytes
    Column column{.name = name, .unit = unit};
    column.set = io::Hdf5Id(
        H5Dcreate2(file_.get(), name.c_str(), type, space.get(), H5P_DEFAULT, layout.get(), H5P_DEFAULT), H5Dclose);
    require(column.set.good());
    column.waiting.reserve(chunk);
    text(column.set.get(), "unit", unit);
    columns_.push_back(std::move(column));
  }

  void open_joint(int joint) {
    open(fmt::format("q{}", joint + 1), info_.prismatic[static_cast<std::size_t>(joint)] ? "m" : "rad");
    const hid_t set = columns_.back().set.get();
    const robot::JointLimits& limits = info_.limits;
    number(set, "min_position", limits.min_position[joint]);
    number(set, "max_position", limits.max_position[joint]);
    number(set, "max_velocity", limits.max_velocity[joint]);
    number(set, "max_acceleration", limits.max_acceleration[joint]);
    number(set, "max_jerk", limits.max_jerk[joint]);
  }

  void number(hid_t owner, const char* name, double value) {
    const io::Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const io::Hdf5Id attribute(H5Acreate2(owner, name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    require(H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &value) >= 0);
  }

  void text(hid_t owner, const char* name, const std::string& value) {
    const io::Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const io::Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    require(H5Tset_size(type.get(), value.size() + 1) >= 0 && H5Tset_cset(type.get(), H5T_CSET_UTF8) >= 0);
    const io::Hdf5Id attribute(H5Acreate2(owner, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    require(H5Awrite(attribute.get(), type.get(), value.c_str()) >= 0);
  }

  void flush() {
    const hsize_t count = columns_.front().waiting.size();
    if (count == 0) return;
    const hsize_t all = rows_ + count;
    const io::Hdf5Id memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    for (Column& column : columns_) {
      require(H5Dset_extent(column.set.get(), &all) >= 0);
      const io::Hdf5Id space(H5Dget_space(column.set.get()), H5Sclose);
      require(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &rows_, nullptr, &count, nullptr) >= 0);
      require(H5Dwrite(column.set.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT,
                       column.waiting.data()) >= 0);
      column.waiting.clear();
    }
    rows_ = all;
  }

  std::filesystem::path path_;
  TrajectoryInfo info_;
  io::PendingFile pending_;
  io::Hdf5Id file_;
  std::vector<Column> columns_;
  hsize_t rows_ = 0;
};

}  // namespace

std::unique_ptr<SampleFile> open_trajectory_hdf5(const std::filesystem::path& path, const TrajectoryInfo& info) {
  return std::make_unique<Hdf5>(path, info);
}

}  // namespace robomill::path
