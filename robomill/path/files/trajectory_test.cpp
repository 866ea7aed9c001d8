#include "robomill/path/files/trajectory.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/table.hpp"
#include "testing/path/trajectories.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace trajectory_test {

using robomill::test::Folder;

void write(const std::filesystem::path& path, const TrajectoryInfo& info, const std::vector<Sample>& samples) {
  const auto file = open_sample_file(path, info);
  file->add(samples);
  file->commit();
}

// Jerk is a third difference: only the same bits give the same jerk.
TEST(TrajectoryCsv, HoldsEveryBitOfTheJoints) {
  const Folder folder;
  const auto samples = test::sines(3000);
  write(folder.at("t.csv"), test::arm_info(), samples);
  std::vector<std::string> warnings;
  const io::Table table = io::parse_table(io::read_file(folder.at("t.csv")), "t.csv", warnings);
  const std::vector<std::string> names = {"time_s", "q1",   "q2",   "q3", "q4", "q5", "q6",
                                          "x_mm",   "y_mm", "z_mm", "i",  "j",  "k",  "block"};
  ASSERT_EQ(table.names, names);
  ASSERT_EQ(table.columns[0].size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(table.columns[0][i], samples[i].time_s);
    for (int joint = 0; joint < 6; ++joint) {
      ASSERT_EQ(table.columns[static_cast<std::size_t>(1 + joint)][i], samples[i].joints[joint]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(table.columns[static_cast<std::size_t>(7 + axis)][i], samples[i].tip_m[axis] / units::mm);
      ASSERT_EQ(table.columns[static_cast<std::size_t>(10 + axis)][i], samples[i].axis[axis]);
    }
    ASSERT_EQ(table.columns[13][i], static_cast<double>(samples[i].block + 1));
  }
}

TEST(TrajectoryCsv, HasAColumnForEachJointOfTheMachine) {
  const Folder folder;
  TrajectoryInfo info = test::arm_info();
  info.joints = 5;
  info.prismatic.fill(true);
  write(folder.at("t.csv"), info, test::sines(3));
  std::vector<std::string> warnings;
  EXPECT_EQ(io::parse_table(io::read_file(folder.at("t.csv")), "t.csv", warnings).names.size(), 13U);
}

class AnyEnding : public ::testing::TestWithParam<const char*> {};

TEST_P(AnyEnding, AppearsWholeOrNotAtAll) {
  const Folder folder;
  const std::filesystem::path path = folder.at(std::string("t") + GetParam());
  {
    const auto file = open_sample_file(path, test::arm_info());
    file->add(test::sines(100));
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  EXPECT_EQ(folder.count(), 0U);
  write(path, test::arm_info(), test::sines(100));
  EXPECT_EQ(folder.count(), 1U);
}

// A full disk at any byte, and a library that writes what it holds when it is closed.
TEST_P(AnyEnding, ThatCannotBeWrittenLeavesTheOldOne) {
  const Folder folder;
  const std::filesystem::path path = folder.at(std::string("t") + GetParam());
  const auto samples = test::sines(20000);
  write(path, test::arm_info(), samples);
  const std::size_t size = io::read_file(path).size();
  for (const std::size_t room : {std::size_t{0}, std::size_t{100}, size / 3, size - 1}) {
    static_cast<void>(folder.file(path.filename().string(), "old"));
    const robomill::test::FileSizeLimit full(room);
    EXPECT_NE(robomill::test::rejection([&] { write(path, test::arm_info(), samples); }).find("cannot be written"),
              std::string::npos)
        << room;
    EXPECT_EQ(io::read_file(path), "old");
  }
  EXPECT_EQ(folder.count(), 1U);
}

TEST_P(AnyEnding, BegunAnewIsAsIfForTheFirstTime) {
  const Folder folder;
  const std::string ending = GetParam();
  // Under one name: programs carry it.
  const auto content = [&](bool twice) {
    const auto file = open_sample_file(folder.at("t" + ending), test::arm_info());
    if (twice) {
      file->add(test::sines(50000, 300));
      file->restart();
    }
    file->add(test::sines(777, 60));
    file->commit();
    return io::read_file(folder.at("t" + ending));
  };
  EXPECT_EQ(content(true), content(false));
}

TEST_P(AnyEnding, ComesOutTheSameInAnyPortions) {
  const Folder folder;
  const std::string ending = GetParam();
  const auto samples = test::sines(2345, 200);
  write(folder.at("t" + ending), test::arm_info(), samples);
  const std::string whole = io::read_file(folder.at("t" + ending));
  const auto file = open_sample_file(folder.at("t" + ending), test::arm_info());
  for (std::size_t i = 0; i < samples.size(); i += 13) {
    file->add(std::span(samples).subspan(i, std::min<std::size_t>(13, samples.size() - i)));
  }
  file->commit();
  EXPECT_EQ(io::read_file(folder.at("t" + ending)), whole);
}

INSTANTIATE_TEST_SUITE_P(Trajectory, AnyEnding, testing::Values(".csv", ".h5", ".src", ".mod", ".script", ".servoj"),
                         [](const auto& one) { return std::string(one.param).substr(1); });

class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& path) : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ~Hdf5Reader() { H5Fclose(file_); }
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  [[nodiscard]] std::vector<double> column(const char* name) const {
    const hid_t set = H5Dopen2(file_, name, H5P_DEFAULT);
    if (set < 0) return {};
    const hid_t space = H5Dget_space(set);
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    H5Dclose(set);
    return values;
  }
  [[nodiscard]] double number(const char* set, const char* name) const {
    const hid_t attribute = H5Aopen_by_name(file_, set, name, H5P_DEFAULT, H5P_DEFAULT);
    double value = std::numeric_limits<double>::quiet_NaN();
    H5Aread(attribute, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(attribute);
    return value;
  }
  [[nodiscard]] std::string text(const char* set, const char* name) const {
    const hid_t attribute = H5Aopen_by_name(file_, set, name, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    std::string value(H5Tget_size(type), '\0');
    H5Aread(attribute, type, value.data());
    H5Tclose(type);
    H5Aclose(attribute);
    return value.c_str();
  }

 private:
  hid_t file_;
};

TEST(TrajectoryHdf5, HoldsEveryBitWithUnitsAndLimits) {
  const Folder folder;
  TrajectoryInfo info = test::arm_info();
  info.prismatic[4] = true;
  const auto samples = test::sines(40000);  // over two chunks, and a part
  write(folder.at("t.h5"), info, samples);
  const Hdf5Reader file(folder.at("t.h5"));
  const auto time = file.column("time_s");
  const auto block = file.column("block");
  ASSERT_EQ(time.size(), samples.size());
  for (int joint = 0; joint < 6; ++joint) {
    const std::string name = "q" + std::to_string(joint + 1);
    const auto values = file.column(name.c_str());
    ASSERT_EQ(values.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) ASSERT_EQ(values[i], samples[i].joints[joint]) << name << i;
    EXPECT_EQ(file.text(name.c_str(), "unit"), joint == 4 ? "m" : "rad");
    EXPECT_EQ(file.number(name.c_str(), "max_jerk"), 50.0 + joint);
    EXPECT_EQ(file.number(name.c_str(), "min_position"), -3.0);
  }
  const auto z = file.column("z_mm");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(time[i], samples[i].time_s);
    ASSERT_EQ(block[i], static_cast<double>(samples[i].block + 1));
    ASSERT_EQ(z[i], samples[i].tip_m.z() / units::mm);
  }
  EXPECT_EQ(file.text("x_mm", "unit"), "mm");
  EXPECT_EQ(file.text("/", "program"), "part.ngc");
  EXPECT_EQ(file.number("/", "sample_period_s"), 0.001);
}

TEST(Trajectory, RejectsWhatItCannotWrite) {
  const Folder folder;
  const TrajectoryInfo info = test::arm_info();
  const auto open = [](const std::filesystem::path& path, const TrajectoryInfo& with) {
    return robomill::test::rejection([&] { static_cast<void>(open_sample_file(path, with)); });
  };
  EXPECT_NE(open(folder.at("t.step"), info).find(".csv"), std::string::npos);
  EXPECT_NE(open(folder.at("none/t.csv"), info).find("There is no folder"), std::string::npos);
  std::filesystem::create_symlink("/dev/null", folder.at("device.csv"));
  EXPECT_NE(open(folder.at("device.csv"), info).find("is a device or a pipe"), std::string::npos);
  TrajectoryInfo none = info;
  none.joints = 0;
  EXPECT_NE(open(folder.at("t.csv"), none).find("joints"), std::string::npos);
  TrajectoryInfo never = info;
  never.sample_period_s = 0.0;
  EXPECT_NE(open(folder.at("t.csv"), never).find("sample_period_s"), std::string::npos);
  TrajectoryInfo points = info;
  points.program_period_s = 0.02;
  EXPECT_NE(open(folder.at("t.h5"), points).find("program_period_s"), std::string::npos);
  EXPECT_EQ(folder.count(), 1U);
}

}  // namespace trajectory_test
}  // namespace robomill::path
