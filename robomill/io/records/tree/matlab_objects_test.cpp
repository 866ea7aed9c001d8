#include <gtest/gtest.h>
#include <hdf5.h>
#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/io/records/hdf5_id.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/records.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace matlab_objects_test {

using test::Folder;
using test::rejection;

constexpr hid_t by_default = 0;  // H5P_DEFAULT
/// What MATLAB_object_decode says.
constexpr std::int32_t as_function = 1, as_old_object = 2, as_object = 3;

/// A file of version 7.3 as MATLAB writes it: a header of 512 bytes, then HDF5.
class Written73 {
 public:
  explicit Written73(std::filesystem::path path) : path_(std::move(path)) {
    H5open();  // before it the classes have no numbers
    const Hdf5Id list(H5Pcreate(H5P_CLS_FILE_CREATE_ID_g), H5Pclose);
    H5Pset_userblock(list.get(), 512);
    file_ = Hdf5Id(H5Fcreate(path_.c_str(), 2U, list.get(), by_default), H5Fclose);  // 2: H5F_ACC_TRUNC
  }
  ~Written73() {
    file_.reset();
    std::string content = read_file(path_);
    std::string header = "MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .";
    header.resize(124, ' ');
    header += std::string("\0\2IM", 4);
    content.replace(0, header.size(), header);
    write_file(path_, content);
  }
  Written73(const Written73&) = delete;
  Written73& operator=(const Written73&) = delete;

  [[nodiscard]] Hdf5Id group(const std::string& name, const std::string& matlab_class = {}) const {
    Hdf5Id out(H5Gcreate2(file_.get(), name.c_str(), by_default, by_default, by_default), H5Gclose);
    if (!matlab_class.empty()) text(out.get(), "MATLAB_class", matlab_class);
    return out;
  }
  /// @param type  of the file
  Hdf5Id set(const std::string& name, const std::vector<double>& values, const std::string& matlab_class = "double",
             hid_t type = H5T_IEEE_F64LE_g) const {
    const std::array<hsize_t, 2> sides = {1, values.size()};  // a column of MATLAB
    const Hdf5Id space(H5Screate_simple(2, sides.data(), nullptr), H5Sclose);
    Hdf5Id out(H5Dcreate2(file_.get(), name.c_str(), type, space.get(), by_default, by_default, by_default), H5Dclose);
    EXPECT_GE(H5Dwrite(out.get(), H5T_NATIVE_DOUBLE_g, 0, 0, by_default, values.data()), 0);
    text(out.get(), "MATLAB_class", matlab_class);
    return out;
  }
  void letters(const std::string& name, const std::string& text) const {
    const Hdf5Id made = set(name, {text.begin(), text.end()}, "char", H5T_STD_U16LE_g);
    number(made.get(), "MATLAB_int_decode", 2);
  }
  /// An object of MATLAB: where it stands among those of the subsystem.
  void object_of(const std::string& name, const std::string& matlab_class) const {
    const Hdf5Id made = set(name, {3707764736.0, 2, 1, 1, 1, 1}, matlab_class, H5T_STD_U32LE_g);
    number(made.get(), "MATLAB_object_decode", as_object);
  }
  /// A cell, or what is within a subsystem.
  Hdf5Id references(const std::string& name, const std::vector<std::string>& to,
                    const std::string& matlab_class) const {
    std::vector<hobj_ref_t> places(to.size());
    for (std::size_t i = 0; i < to.size(); ++i) {
      EXPECT_GE(H5Rcreate(&places[i], file_.get(), to[i].c_str(), H5R_OBJECT, -1), 0);
    }
    const std::array<hsize_t, 2> sides = {to.size(), 1};
    const Hdf5Id space(H5Screate_simple(2, sides.data(), nullptr), H5Sclose);
    Hdf5Id out(
        H5Dcreate2(file_.get(), name.c_str(), H5T_STD_REF_OBJ_g, space.get(), by_default, by_default, by_default),
        H5Dclose);
    EXPECT_GE(H5Dwrite(out.get(), H5T_STD_REF_OBJ_g, 0, 0, by_default, places.data()), 0);
    text(out.get(), "MATLAB_class", matlab_class);
    return out;
  }
  /// A function with a variable of so many values in its workspace.
  void function(const std::string& name, const std::vector<double>& captured) const {
    const Hdf5Id made = group(name, "function_handle");
    number(made.get(), "MATLAB_object_decode", as_function);
    letters(name + "/matlabroot", "/usr/local/MATLAB/R2023b");
    letters(name + "/separator", "/");
    letters(name + "/sentinel", "@");
    const Hdf5Id inner = group(name + "/function_handle", "struct");
    letters(name + "/function_handle/function", "sf%0@(t)gain.*t");
    letters(name + "/function_handle/type", "anonymous");
    const Hdf5Id workspace = group(name + "/function_handle/workspace", "struct");
    set(name + "/function_handle/workspace/gain", captured);
  }
  /// @param values  of three that are not zero; none: all are zero, and MATLAB writes no values at all
  void sparse(const std::string& name, bool values) const {
    const Hdf5Id made = group(name, "double");
    number(made.get(), "MATLAB_sparse", 4);
    set(name + "/jc", {0, 1, 2, values ? 3.0 : 2.0}, "uint64", H5T_STD_U64LE_g);
    if (!values) return;
    set(name + "/data", {1.5, 2.5, 3.5});
    set(name + "/ir", {0, 1, 3}, "uint64", H5T_STD_U64LE_g);
  }
  static void number(hid_t of, const char* name, std::int32_t value) {
    const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Id made(H5Acreate2(of, name, H5T_STD_I32LE_g, space.get(), by_default, by_default), H5Aclose);
    EXPECT_GE(H5Awrite(made.get(), H5T_NATIVE_INT32_g, &value), 0);
  }
  static void text(hid_t of, const char* name, const std::string& text) {
    const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Id type(H5Tcopy(H5T_C_S1_g), H5Tclose);
    H5Tset_size(type.get(), text.size());
    const Hdf5Id made(H5Acreate2(of, name, type.get(), space.get(), by_default, by_default), H5Aclose);
    EXPECT_GE(H5Awrite(made.get(), type.get(), text.data()), 0);
  }

 private:
  std::filesystem::path path_;
  Hdf5Id file_;
};

constexpr const char* long_class = "matlab.internal.project.a.class.of.a.long.name";

/// Everything that is no plain matrix, of as many samples as the plain ones have.
void write_others(const Written73& file) {
  const Hdf5Id subsystem = file.group("#subsystem#");
  const Hdf5Id within = file.references("#subsystem#/MCOS", {"#refs#/a", "#refs#/b"}, "FileWrapper__");
  Written73::number(within.get(), "MATLAB_object_decode", as_object);
  file.object_of("run", "timetable");
  file.object_of("project", long_class);
  file.function("gain", {4, 3, 2, 1});
  const Hdf5Id old = file.group("model", "tf");
  Written73::number(old.get(), "MATLAB_object_decode", as_old_object);
  file.set("model/numerator", {9, 8, 7, 6});
  file.sparse("stiffness", true);
  file.sparse("zeros", false);
}

/// What write_others refers to.
void write_references(const Written73& file) {
  const Hdf5Id references = file.group("#refs#");
  file.set("#refs#/a", {11, 12, 13, 14});  // the values of the timetable, say
  file.set("#refs#/b", {21, 22, 23, 24}, "uint8", H5T_STD_U8LE_g);
}

std::vector<std::string> sorted(std::vector<std::string> texts) {
  std::ranges::sort(texts);
  return texts;
}

const std::vector<std::string> others = {
    "gain (a function handle)",  "model (an object of MATLAB)", "project (an object of MATLAB)",
    "run (an object of MATLAB)", "stiffness (a sparse matrix)", "zeros (a sparse matrix)",
};

TEST(MatlabObjects, ReadsThePlainOnesBesideOthers) {
  const Folder folder;
  {
    const Written73 file(folder.at("a.mat"));
    write_references(file);
    write_others(file);
    file.set("force", {0, 5, 1, 0});
    file.set("fs", {25600});
    file.set("acc", {1, -2, 3, -4}, "int16", H5T_STD_I16LE_g);
    file.letters("note", "a hit");
  }
  const Record record = read_record(folder.at("a.mat"));
  EXPECT_EQ(record.sample_rate_hz, 25600.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"acc", "force"}));
  EXPECT_EQ(record.column("force"), Eigen::Vector4d(0, 5, 1, 0));
  EXPECT_EQ(record.column("acc"), Eigen::Vector4d(1, -2, 3, -4));
  EXPECT_EQ(sorted(record.left_out), others);
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("2 of its 8 channels are read at 25600 Hz; left out: gain (a function handle), "),
            std::string::npos)
      << record.notes[0];
  // As the reader of FRFs has it.
  std::vector<std::string> names;
  for (const MatVariable& variable : read_mat(folder.at("a.mat"))) names.push_back(variable.name);
  EXPECT_EQ(sorted(names), (std::vector<std::string>{"acc", "force", "fs"}));
}

TEST(MatlabObjects, ReadsThePlainOnesOfStructsAndCellsBesideOthers) {
  const Folder folder;
  {
    const Written73 file(folder.at("a.mat"));
    const Hdf5Id references = file.group("#refs#");
    file.set("#refs#/a", {1, 2, 3, 4});
    file.object_of("#refs#/b", "string");
    file.function("#refs#/c", {5, 6, 7, 8});
    file.sparse("#refs#/d", true);
    const Hdf5Id within = file.references("c", {"#refs#/a", "#refs#/b", "#refs#/c", "#refs#/d"}, "cell");
    const Hdf5Id rec = file.group("rec", "struct");
    file.set("rec/force", {0, 5, 1, 0});
    file.object_of("rec/begin", "datetime");
    file.function("rec/filter", {5, 6, 7, 8});
    file.sparse("rec/mass", true);
  }
  const Record record = read_record(folder.at("a.mat"));
  EXPECT_EQ(sorted(record.names), (std::vector<std::string>{"c{1}", "rec.force"}));
  EXPECT_EQ(record.column("c{1}"), Eigen::Vector4d(1, 2, 3, 4));
  EXPECT_EQ(sorted(record.left_out),
            (std::vector<std::string>{"c{2} (an object of MATLAB)", "c{3} (a function handle)",
                                      "c{4} (a sparse matrix)", "rec.begin (an object of MATLAB)",
                                      "rec.filter (a function handle)", "rec.mass (a sparse matrix)"}));
}

TEST(MatlabObjects, OfOthersAloneIsRejectedWithWhatTheyAre) {
  const Folder folder;
  {
    const Written73 file(folder.at("a.mat"));
    write_references(file);
    write_others(file);
  }
  const std::string said = rejection([&] { static_cast<void>(read_record(folder.at("a.mat"))); });
  EXPECT_NE(said.find("holds no channel that can be read as a record: "), std::string::npos) << said;
  for (const std::string& other : others) EXPECT_NE(said.find(other), std::string::npos) << other << " in " << said;
  EXPECT_TRUE(read_mat(folder.at("a.mat")).empty());
}

// A text that MATLAB keeps as an object of its class string says no unit.
TEST(MatlabObjects, ObjectsSayNothingOfOthers) {
  const Folder folder;
  {
    const Written73 file(folder.at("a.mat"));
    file.set("force", {0, 5, 1, 0});
    file.object_of("force_unit", "string");
    file.object_of("fs", "duration");
    file.object_of("time", "datetime");
  }
  const Record record = read_record(folder.at("a.mat"));
  EXPECT_EQ(record.names, std::vector<std::string>{"force"});
  EXPECT_EQ(record.unit(0), "");
  EXPECT_EQ(record.sample_rate_hz, 0.0);
  EXPECT_EQ(record.left_out.size(), 3U);
}

/// Of three values each.
void write_plain(const std::filesystem::path& path, mat_ft version, const char* name, bool sparse = false) {
  mat_t* mat = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(mat, nullptr);
  std::array<std::size_t, 2> sides = {3, 1}, square = {3, 3};
  std::array<double, 3> values = {1, 2, 3};
  std::array<mat_uint32_t, 3> rows = {0, 1, 2};
  std::array<mat_uint32_t, 4> columns = {0, 1, 2, 3};
  mat_sparse_t held = {};
  held.nzmax = held.nir = held.ndata = 3;
  held.njc = 4;
  held.ir = rows.data();
  held.jc = columns.data();
  held.data = values.data();
  std::vector<matvar_t*> variables = {
      Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sides.data(), values.data(), 0)};
  if (sparse) {
    variables.push_back(Mat_VarCreate("k", MAT_C_SPARSE, MAT_T_DOUBLE, 2, square.data(), &held, MAT_F_DONT_COPY_DATA));
    variables.push_back(Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sides.data(), values.data(), 0));
  }
  for (matvar_t* variable : variables) {
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

TEST(MatlabObjects, SparseMatricesAreNamedInEveryVersion) {
  const Folder folder;
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    write_plain(folder.at("a.mat"), version, "force", true);
    const Record record = read_record(folder.at("a.mat"));
    EXPECT_EQ(sorted(record.names), (std::vector<std::string>{"force", "z"})) << version;
    EXPECT_EQ(record.left_out, std::vector<std::string>{"k (a sparse matrix)"}) << version;
  }
}

/// A part of a variable of version 5, little-endian.
std::string part_5(std::uint32_t type, const std::string& data) {
  const std::uint32_t head[] = {type, static_cast<std::uint32_t>(data.size())};
  std::string out(reinterpret_cast<const char*>(head), sizeof(head));
  out += data;
  out.resize((out.size() + 7) / 8 * 8);
  return out;
}

std::string numbers_5(std::uint32_t type, const std::vector<std::uint32_t>& numbers) {
  return part_5(type, std::string(reinterpret_cast<const char*>(numbers.data()), 4 * numbers.size()));
}

/// @param rest  behind flags, sides and name
std::string variable_5(std::uint32_t matlab_class, const std::string& name, const std::string& rest) {
  constexpr std::uint32_t opaque = 17;
  const std::string sides = matlab_class == opaque ? std::string() : numbers_5(5, {1, 1});
  return part_5(14, numbers_5(6, {matlab_class, 0}) + sides + part_5(1, name) + rest);
}

/// A number, as a field or what a function refers to.
std::string number_5(double value) {
  return variable_5(6, "", part_5(9, std::string(reinterpret_cast<const char*>(&value), sizeof(value))));
}

/// As MATLAB packs variables.
std::string packed_5(const std::string& variable) {
  uLongf size = compressBound(variable.size());
  std::string packed(size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(variable.data()),
                     variable.size()),
            Z_OK);
  const std::uint32_t head[] = {15, static_cast<std::uint32_t>(size)};
  return std::string(reinterpret_cast<const char*>(head), sizeof(head)) + packed.substr(0, size);
}

TEST(MatlabObjects, OfVersion5AreNamedBesideThePlainOnes) {
  const Folder folder;
  write_plain(folder.at("a.mat"), MAT_FT_MAT5, "force");
  write_plain(folder.at("b.mat"), MAT_FT_MAT5, "acc");
  const std::string fields = part_5(1, "tf") + numbers_5(5, {8}) + part_5(1, std::string("gain\0\0\0\0", 8));
  const std::string function = variable_5(16, "f", number_5(1.0)), old = variable_5(3, "old", fields + number_5(2.0)),
                    opaque = variable_5(
                        17, "run",
                        part_5(1, "MCOS") + part_5(1, "timetable") + variable_5(13, "", numbers_5(6, {0xDD000000U})));
  for (const auto& [other, said] :
       {std::pair(function, "f (a function handle)"), std::pair(old, "old (an object of MATLAB)"),
        std::pair(opaque, "a channel without a name (an object of MATLAB)")}) {
    for (const bool packed : {false, true}) {
      const auto path = folder.file("c.mat", read_file(folder.at("a.mat")) + (packed ? packed_5(other) : other) +
                                                 read_file(folder.at("b.mat")).substr(128));
      const Record record = read_record(path);
      EXPECT_EQ(sorted(record.names), (std::vector<std::string>{"acc", "force"})) << said << packed;
      EXPECT_EQ(record.left_out, std::vector<std::string>{said}) << packed;
      EXPECT_EQ(read_mat(path).size(), 2U) << said << packed;
    }
  }
}

}  // namespace matlab_objects_test
}  // namespace robomill::io
