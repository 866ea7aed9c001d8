#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/hdf5_id.hpp"
#include "robomill/io/records/records.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace hdf5_tree_test {

using test::Folder;
using test::rejection;

constexpr hid_t by_default = 0;  // H5P_DEFAULT

/// An HDF5 file as h5py writes it.
class Written {
 public:
  explicit Written(const std::filesystem::path& path)
      : file_(H5Fcreate(path.c_str(), 2U, by_default, by_default), H5Fclose) {}  // 2: H5F_ACC_TRUNC

  [[nodiscard]] hid_t file() const { return file_.get(); }
  [[nodiscard]] Hdf5Id group(const std::string& name) const {
    return {H5Gcreate2(file_.get(), name.c_str(), by_default, by_default, by_default), H5Gclose};
  }
  [[nodiscard]] Hdf5Id set(const std::string& name, const std::vector<hsize_t>& sides,
                           const std::vector<double>& values, hid_t type = H5T_IEEE_F64LE_g) const {
    const Hdf5Id space(H5Screate_simple(static_cast<int>(sides.size()), sides.data(), nullptr), H5Sclose);
    Hdf5Id out(H5Dcreate2(file_.get(), name.c_str(), type, space.get(), by_default, by_default, by_default), H5Dclose);
    EXPECT_GE(H5Dwrite(out.get(), H5T_NATIVE_DOUBLE_g, 0, 0, by_default, values.data()), 0);
    return out;
  }
  static void number(hid_t object, const std::string& name, double value) {
    const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Id attribute(H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE_g, space.get(), by_default, by_default),
                           H5Aclose);
    EXPECT_GE(H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE_g, &value), 0);
  }
  /// @param is_variable  as h5py writes a text; else of a fixed length, as others do
  static void texts(hid_t object, const std::string& name, const std::vector<std::string>& texts,
                    bool is_variable = true) {
    const hsize_t count = texts.size();
    const Hdf5Id space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Hdf5Id type(H5Tcopy(H5T_C_S1_g), H5Tclose);
    H5Tset_size(type.get(), is_variable ? static_cast<std::size_t>(-1) : 12);
    const Hdf5Id attribute(H5Acreate2(object, name.c_str(), type.get(), space.get(), by_default, by_default), H5Aclose);
    std::vector<const char*> pointers;
    std::string fixed;
    for (const std::string& text : texts) {
      pointers.push_back(text.c_str());
      fixed += text + std::string(12 - text.size(), '\0');
    }
    const void* from = is_variable ? static_cast<const void*>(pointers.data()) : fixed.data();
    EXPECT_GE(H5Awrite(attribute.get(), type.get(), from), 0);
  }

 private:
  Hdf5Id file_;
};

TEST(Hdf5, ReadsDataSetsWithTheirAttributes) {
  const Folder folder;
  for (const char* name : {"a.h5", "b.HDF5", "c.hdf"}) {
    {
      const Written file(folder.at(name));
      Written::number(file.file(), "sample_rate", 51200.0);
      const Hdf5Id group = file.group("hit 1");
      const Hdf5Id force = file.set("hit 1/force", {4}, {0, 5, 1, 0}, H5T_STD_I16BE_g);
      Written::texts(force.get(), "units", {"kN"});
      const Hdf5Id response = file.set("hit 1/ch2", {1, 4, 1}, {0.5, -0.25, 2, 1}, H5T_IEEE_F32LE_g);
      Written::texts(response.get(), "unit", {"g"}, false);
      Written::texts(response.get(), "long_name", {"Acc x"});
      Written::number(response.get(), "sensitivity", 10.2);
    }
    const Record record = read_record(folder.at(name));
    EXPECT_EQ(record.sample_rate_hz, 51200.0);
    EXPECT_EQ(record.names, (std::vector<std::string>{"Acc x", "hit 1/force"}));
    EXPECT_EQ(record.column("hit 1/force"), Eigen::Vector4d(0, 5, 1, 0));
    EXPECT_EQ(record.column("Acc x"), Eigen::Vector4d(0.5, -0.25, 2, 1));
    EXPECT_EQ(record.unit(0), "g");
    EXPECT_EQ(record.unit(1), "kN");
    ASSERT_EQ(record.notes.size(), 1U);
    EXPECT_NE(record.notes[0].find("hit 1/ch2@sensitivity = 10.2 is not applied to hit 1/ch2"), std::string::npos);
  }
}

// Channel c, sample s is 10 c + s.
TEST(Hdf5, TheLongerSideOfAMatrixIsTime) {
  const Folder folder;
  {
    const Written file(folder.at("a.h5"));
    Written::number(file.file(), "dt_ms", 0.5);
    const Hdf5Id set = file.set("x", {3, 2}, {0, 10, 1, 11, 2, 12});
    Written::texts(set.get(), "channels", {"Force [N]", "Acc"});
    Written::texts(set.get(), "units", {"N", "m/s^2"});
    static_cast<void>(file.set("y", {2, 3}, {0, 1, 2, 10, 11, 12}));
  }
  const Record record = read_record(folder.at("a.h5"));
  EXPECT_EQ(record.sample_rate_hz, 2000.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"Force [N]", "Acc", "y[0,:]", "y[1,:]"}));
  for (const std::size_t i : {1U, 3U}) EXPECT_EQ(record.columns[i], Eigen::Vector3d(10, 11, 12));
  for (const std::size_t i : {0U, 2U}) EXPECT_EQ(record.columns[i], Eigen::Vector3d(0, 1, 2));
  EXPECT_EQ(record.unit(1), "m/s^2");
}

TEST(Hdf5, TimesOfAGroupAreThoseOfItsChannels) {
  const Folder folder;
  {
    const Written file(folder.at("a.h5"));
    const Hdf5Id fast = file.group("fast"), slow = file.group("slow");
    const Hdf5Id time = file.set("fast/time", {4}, {10, 10.25, 10.5, 10.75});
    Written::texts(time.get(), "units", {"ms"});
    static_cast<void>(file.set("fast/acc", {4}, {1, 2, 3, 4}));
    static_cast<void>(file.set("slow/time", {3}, {0, 1, 2}));
    static_cast<void>(file.set("slow/temperature", {3}, {20, 21, 22}));
  }
  const Record record = read_record(folder.at("a.h5"));
  EXPECT_NEAR(record.sample_rate_hz, 4000.0, 1e-9);
  EXPECT_EQ(record.names, (std::vector<std::string>{"fast/acc", "fast/time"}));
  EXPECT_NEAR(record.column("fast/time")(3), 0.01075, 1e-15);
  EXPECT_EQ(record.left_out, (std::vector<std::string>{"slow/temperature (1 Hz, 3 samples, starts 0.01 s earlier)",
                                                       "slow/time (1 Hz, 3 samples, starts 0.01 s earlier)"}));
  // The user's own column of time, in s by its unit.
  EXPECT_NEAR(read_record(folder.at("a.h5"), {.time = "fast/time"}).sample_rate_hz, 4000.0, 1e-9);
}

TEST(Hdf5, ReadsTheFieldsOfATable) {
  const Folder folder;
  struct Row {
    double time;
    std::int32_t force;
    float acc;
  };
  const std::vector<Row> rows = {{0.0, 1, 0.5F}, {0.5, -2, 1.5F}, {1.0, 3, 2.5F}};
  {
    const Written file(folder.at("a.h5"));
    const Hdf5Id type(H5Tcreate(H5T_COMPOUND, sizeof(Row)), H5Tclose);
    H5Tinsert(type.get(), "time", offsetof(Row, time), H5T_NATIVE_DOUBLE_g);
    H5Tinsert(type.get(), "force", offsetof(Row, force), H5T_NATIVE_INT32_g);
    H5Tinsert(type.get(), "acc", offsetof(Row, acc), H5T_NATIVE_FLOAT_g);
    const hsize_t count = rows.size();
    const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Hdf5Id set(H5Dcreate2(file.file(), "table", type.get(), space.get(), by_default, by_default, by_default),
                     H5Dclose);
    EXPECT_GE(H5Dwrite(set.get(), type.get(), 0, 0, by_default, rows.data()), 0);
    Written::texts(set.get(), "force_unit", {"N"});
  }
  const Record record = read_record(folder.at("a.h5"));
  EXPECT_EQ(record.sample_rate_hz, 2.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"table/time", "table/force", "table/acc"}));
  EXPECT_EQ(record.column("table/force"), Eigen::Vector3d(1, -2, 3));
  EXPECT_EQ(record.column("table/acc"), Eigen::Vector3d(0.5, 1.5, 2.5));
  EXPECT_EQ(record.unit(1), "N");
}

TEST(Hdf5, LeadsToNoOtherFile) {
  const Folder folder;
  folder.file("secret.bin", std::string(32, 'S'));
  { static_cast<void>(Written(folder.at("other.h5")).set("x", {3}, {1, 2, 3})); }
  const auto says = [&](const std::string& file) {
    return rejection([&] { static_cast<void>(read_record(folder.at(file))); });
  };
  const hsize_t count = 4;
  {
    const Written file(folder.at("a.h5"));
    const Hdf5Id list(H5Pcreate(H5P_CLS_DATASET_CREATE_ID_g), H5Pclose);
    ASSERT_GE(H5Pset_external(list.get(), folder.at("secret.bin").c_str(), 0, 32), 0);
    const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Hdf5Id group = file.group("g");
    const Hdf5Id set(H5Dcreate2(group.get(), "x", H5T_IEEE_F64LE_g, space.get(), by_default, list.get(), by_default),
                     H5Dclose);
    ASSERT_TRUE(set.good());
  }
  EXPECT_NE(says("a.h5").find("g/x keeps its values in another file. Save the file anew"), std::string::npos);
  {
    const Written file(folder.at("b.h5"));
    static_cast<void>(file.set("own", {3}, {1, 2, 3}));
    ASSERT_GE(H5Lcreate_external(folder.at("other.h5").c_str(), "/x", file.file(), "x", by_default, by_default), 0);
  }
  EXPECT_NE(says("b.h5").find("x is a link to another file"), std::string::npos);
  {
    const Written file(folder.at("c.h5"));
    const Hdf5Id list(H5Pcreate(H5P_CLS_DATASET_CREATE_ID_g), H5Pclose);
    const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    ASSERT_GE(H5Pset_virtual(list.get(), space.get(), folder.at("other.h5").c_str(), "x", space.get()), 0);
    const Hdf5Id set(H5Dcreate2(file.file(), "v", H5T_IEEE_F64LE_g, space.get(), by_default, list.get(), by_default),
                     H5Dclose);
    ASSERT_TRUE(set.good());
  }
  EXPECT_NE(says("c.h5").find("v is a virtual data set"), std::string::npos);
}

TEST(Hdf5, SaysWhatIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& content) {
    return rejection([&] { static_cast<void>(read_record(folder.file("x.h5", content))); });
  };
  EXPECT_NE(says("hello, this is none").find("is no HDF5 file"), std::string::npos);
  EXPECT_NE(says("\x0e\x03\x13\x01 and more").find("is an HDF4 file, which is not read. Convert it to HDF5"),
            std::string::npos);
  {
    const Written file(folder.at("a.h5"));
    static_cast<void>(file.set("x", {2, 2, 2}, std::vector<double>(8, 1.0)));
    static_cast<void>(file.set("y", {3}, {1, NAN, 3}));
    // A loop of groups.
    const Hdf5Id group = file.group("g");
    ASSERT_GE(H5Lcreate_hard(file.file(), "/", group.get(), "back", by_default, by_default), 0);
  }
  const std::string content = read_file(folder.at("a.h5"));
  const std::string said = says(content);
  EXPECT_NE(said.find("holds no channel that can be read as a record: x (of 3 dimensions); y (a value is no finite "),
            std::string::npos)
      << said;
  EXPECT_NE(says(content.substr(0, content.size() / 2)).find("damaged HDF5 file"), std::string::npos);
  // A small file must not ask for much: chunks that were never written are none in the file.
  {
    const Written file(folder.at("b.h5"));
    const hsize_t sides = hsize_t{1} << 33, chunk = 1024;
    const Hdf5Id list(H5Pcreate(H5P_CLS_DATASET_CREATE_ID_g), H5Pclose);
    H5Pset_chunk(list.get(), 1, &chunk);
    const Hdf5Id space(H5Screate_simple(1, &sides, nullptr), H5Sclose);
    const Hdf5Id set(H5Dcreate2(file.file(), "x", H5T_IEEE_F64LE_g, space.get(), by_default, list.get(), by_default),
                     H5Dclose);
    ASSERT_TRUE(set.good());
  }
  EXPECT_NE(says(read_file(folder.at("b.h5"))).find("x says that it holds 8589934592 x 1 values, more than a file"),
            std::string::npos);
}

// Mutated copies of a valid file are read or rejected, never more.
TEST(Hdf5, SurvivesMutations) {
  const Folder folder;
  {
    const Written file(folder.at("a.h5"));
    Written::number(file.file(), "fs", 1000.0);
    const Hdf5Id group = file.group("g");
    const Hdf5Id set = file.set("g/x", {6, 2}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    Written::texts(set.get(), "units", {"N", "g"});
  }
  const std::string original = read_file(folder.at("a.h5"));
  for (int seed = 0; seed < test::seeds(1500); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = original;
    for (std::uint64_t i = 1 + random.index(4); i > 0; --i) {
      content[8 + random.index(content.size() - 8)] = static_cast<char>(random.index(3) == 0 ? 255 : random.index(256));
    }
    if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read_record(folder.file("b.h5", content));
      for (const Eigen::VectorXd& column : record.columns) ASSERT_TRUE(column.allFinite());
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace hdf5_tree_test
}  // namespace robomill::io
