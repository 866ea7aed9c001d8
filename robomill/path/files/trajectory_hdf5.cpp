#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/records/hdf5_table.hpp"
#include "robomill/path/files/trajectory_parts.hpp"

namespace robomill::path {
namespace {

class Hdf5 final : public SampleFile {
 public:
  Hdf5(const std::filesystem::path& path, const TrajectoryInfo& info) : info_(info), table_(path) { begin(); }

  void restart() override {
    table_.restart();
    begin();
  }

  void add(std::span<const Sample> samples) override {
    for (const Sample& sample : samples) {
      table_.put(sample.time_s);
      for (int joint = 0; joint < info_.joints; ++joint) table_.put(sample.joints[joint]);
      for (int axis = 0; axis < 3; ++axis) table_.put(sample.tip_m[axis] / units::mm);
      for (int axis = 0; axis < 3; ++axis) table_.put(sample.axis[axis]);
      table_.put(static_cast<double>(sample.block + 1));
      table_.end_row();
    }
  }

  void state_collisions(const std::string& found) override { collisions_ = found; }

  io::PendingFile& finish() override {
    table_.attribute("collisions", collisions_);
    return table_.finish();
  }

 private:
  void begin() {
    table_.attribute("program", info_.program);
    table_.attribute("cell", info_.cell);
    table_.attribute("sample_period_s", info_.sample_period_s);
    table_.column("time_s", "s");
    for (int joint = 0; joint < info_.joints; ++joint) add_joint(joint);
    for (const char* name : {"x_mm", "y_mm", "z_mm"}) table_.column(name, "mm");
    for (const char* name : {"i", "j", "k"}) table_.column(name, "1");
    table_.column("block", "1", io::Hdf5Table::Kind::whole);
  }

  void add_joint(int joint) {
    const std::size_t place =
        table_.column(fmt::format("q{}", joint + 1), info_.prismatic[static_cast<std::size_t>(joint)] ? "m" : "rad");
    const robot::JointLimits& limits = info_.limits;
    table_.column_attribute(place, "min_position", limits.min_position[joint]);
    table_.column_attribute(place, "max_position", limits.max_position[joint]);
    table_.column_attribute(place, "max_velocity", limits.max_velocity[joint]);
    table_.column_attribute(place, "max_acceleration", limits.max_acceleration[joint]);
    table_.column_attribute(place, "max_jerk", limits.max_jerk[joint]);
  }

  std::string collisions_ = unchecked_collisions;
  TrajectoryInfo info_;
  io::Hdf5Table table_;
};

}  // namespace

std::unique_ptr<SampleFile> open_trajectory_hdf5(const std::filesystem::path& path, const TrajectoryInfo& info) {
  return std::make_unique<Hdf5>(path, info);
}

}  // namespace robomill::path
