#include <fmt/format.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace mat_tree_test {

using test::Folder;
using test::rejection;

matvar_t* matrix(std::size_t rows, std::size_t columns, std::vector<double> values, const char* name = nullptr) {
  std::array<std::size_t, 2> sides = {rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sides.data(), values.data(), 0);
}
matvar_t* vector(std::vector<double> values, const char* name = nullptr) {
  const std::size_t rows = values.size();
  return matrix(rows, 1, std::move(values), name);
}
matvar_t* text(std::string letters) {
  std::array<std::size_t, 2> sides = {1, letters.size()};
  return Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, sides.data(), letters.data(), 0);
}

using Fields = std::vector<std::pair<const char*, matvar_t*>>;

/// @param elements  fields of each, of the same names
matvar_t* structs(const std::vector<Fields>& elements, const char* name = nullptr) {
  std::vector<const char*> names;
  for (const auto& [key, value] : elements.front()) names.push_back(key);
  std::array<std::size_t, 2> sides = {1, elements.size()};
  matvar_t* out = Mat_VarCreateStruct(name, 2, sides.data(), names.data(), static_cast<unsigned>(names.size()));
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (const auto& [key, value] : elements[i]) Mat_VarSetStructFieldByName(out, key, i, value);
  }
  return out;
}
matvar_t* cell(std::vector<matvar_t*> elements, const char* name = nullptr) {
  std::array<std::size_t, 2> sides = {1, elements.size()};
  return Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, sides.data(), elements.data(), 0);
}

void write(const std::filesystem::path& path, mat_ft version, matio_compression packing,
           const std::vector<matvar_t*>& variables) {
  mat_t* mat = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(mat, nullptr);
  for (matvar_t* variable : variables) {
    EXPECT_EQ(Mat_VarWrite(mat, variable, packing), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

const std::pair<mat_ft, matio_compression> versions[] = {
    {MAT_FT_MAT5, MAT_COMPRESSION_NONE}, {MAT_FT_MAT5, MAT_COMPRESSION_ZLIB}, {MAT_FT_MAT73, MAT_COMPRESSION_NONE}};

/// The names of a record as a set: version 7.3 keeps fields in another order.
std::vector<std::string> sorted_names(const Record& record) {
  std::vector<std::string> out = record.names;
  std::ranges::sort(out);
  return out;
}

TEST(MatTree, ReadsTheFieldsOfAStruct) {
  const Folder folder;
  for (const auto& [version, packing] : versions) {
    write(folder.at("a.mat"), version, packing,
          {structs({{{"time", vector({0, 0.25, 0.5, 0.75})},
                     {"force", vector({0, 5, 1, 0})},
                     {"force_unit", text("kN")},
                     {"ch1", matrix(1, 4, {1, -2, 3, -4})},
                     {"note", text("a hit")}}},
                   "data")});
    const Record record = read_record(folder.at("a.mat"));
    EXPECT_EQ(record.sample_rate_hz, 4.0);
    EXPECT_EQ(sorted_names(record), (std::vector<std::string>{"data.ch1", "data.force", "data.time"}));
    EXPECT_EQ(record.column("data.force"), Eigen::Vector4d(0, 5, 1, 0));
    EXPECT_EQ(record.column("data.ch1"), Eigen::Vector4d(1, -2, 3, -4));
    EXPECT_EQ(record.unit(record.place("data.force")), "kN");
    EXPECT_EQ(record.unit(record.place("data.ch1")), "");
    EXPECT_TRUE(record.notes.empty());
    EXPECT_EQ(read_record(folder.at("a.mat"), {.time = "data.time"}).sample_rate_hz, 4.0);
  }
}

// A struct of time, values and rate; the times win, and the contradiction is noted.
TEST(MatTree, ReadsValuesWithTheirRate) {
  const Folder folder;
  for (const auto& [version, packing] : versions) {
    write(folder.at("a.mat"), version, packing,
          {structs({{{"values", matrix(3, 2, {1, 2, 3, 10, 20, 30})},
                     {"rate", vector({25600.0})},
                     {"units", cell({text("N"), text("g")})},
                     {"names", cell({text("Hammer"), text("Tip")})}}},
                   "rec")});
    const Record record = read_record(folder.at("a.mat"));
    EXPECT_EQ(record.sample_rate_hz, 25600.0);
    EXPECT_EQ(record.names, (std::vector<std::string>{"Hammer", "Tip"}));
    EXPECT_EQ(record.column("Tip"), Eigen::Vector3d(10, 20, 30));
    EXPECT_EQ(record.unit(1), "g");
    write(
        folder.at("b.mat"), version, packing,
        {structs({{{"values", vector({1, 2, 3})}, {"time", vector({0, 1, 2})}, {"rate", vector({25600.0})}}}, "rec")});
    const Record both = read_record(folder.at("b.mat"));
    EXPECT_EQ(both.sample_rate_hz, 1.0);
    ASSERT_EQ(both.notes.size(), 1U);
    EXPECT_NE(both.notes[0].find("it states 25600 Hz beside rec.time, which runs at 1 Hz and counts"),
              std::string::npos);
  }
}

// Simulink: "structure with time" has the times above its signals.
TEST(MatTree, ReadsAStructureWithTime) {
  const Folder folder;
  for (const auto& [version, packing] : versions) {
    matvar_t* signals =
        structs({{{"values", vector({1, 2, 3})}, {"dimensions", vector({1})}, {"label", text("Force")}},
                 {{"values", matrix(3, 2, {4, 5, 6, 7, 8, 9})}, {"dimensions", vector({2})}, {"label", text("Acc")}}});
    write(folder.at("a.mat"), version, packing,
          {structs({{{"time", vector({0, 0.5, 1.0})}, {"signals", signals}, {"blockName", text("model/Scope")}}},
                   "out")});
    const Record record = read_record(folder.at("a.mat"));
    EXPECT_EQ(record.sample_rate_hz, 2.0);
    EXPECT_EQ(sorted_names(record), (std::vector<std::string>{"Force", "out.signals(2).values(:,1)",
                                                              "out.signals(2).values(:,2)", "out.time"}));
    EXPECT_EQ(record.column("Force"), Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(record.column("out.signals(2).values(:,2)"), Eigen::Vector3d(7, 8, 9));
  }
}

// As Testlab exports to MATLAB: an axis by start and increment, and units as quantities.
TEST(MatTree, ReadsASignalOfTestlab) {
  const Folder folder;
  for (const auto& [version, packing] : versions) {
    matvar_t* x = structs({{{"start_value", vector({0})},
                            {"increment", vector({1.0 / 51200.0})},
                            {"number_of_values", vector({3})},
                            {"quantity", structs({{{"label", text("s")}}})}}});
    matvar_t* y = structs({{{"values", vector({1, -2, 3})}, {"quantity", structs({{{"label", text("g")}}})}}});
    write(folder.at("a.mat"), version, packing, {structs({{{"x_values", x}, {"y_values", y}}}, "Signal")});
    const Record record = read_record(folder.at("a.mat"));
    EXPECT_EQ(record.sample_rate_hz, 51200.0);
    EXPECT_EQ(record.names, std::vector<std::string>{"Signal.y_values.values"});
    EXPECT_EQ(record.unit(0), "g");
  }
}

TEST(MatTree, ReadsCellsAndArraysOfStructs) {
  const Folder folder;
  for (const auto& [version, packing] : versions) {
    write(folder.at("a.mat"), version, packing,
          {cell({vector({1, 2, 3}), cell({vector({4, 5, 6})}), text("x")}, "c"),
           structs({{{"x", vector({7, 8, 9})}, {"fs", vector({100})}}, {{"x", vector({1, 1})}, {"fs", vector({100})}}},
                   "s"),
           matrix(2, 4, {1, 10, 2, 20, 3, 30, 4, 40}, "wide")});
    const Record record = read_record(folder.at("a.mat"));
    EXPECT_EQ(record.sample_rate_hz, 100.0);
    // Without a rate goes what is as long.
    EXPECT_EQ(sorted_names(record), (std::vector<std::string>{"c{1}", "c{2}{1}", "s(1).x", "s(2).x"}));
    EXPECT_EQ(record.column("c{2}{1}"), Eigen::Vector3d(4, 5, 6));
    EXPECT_EQ(record.column("s(2).x"), Eigen::Vector2d(1, 1));
    EXPECT_EQ(record.left_out.size(), 2U);
    write(folder.at("b.mat"), version, packing, {matrix(2, 4, {1, 10, 2, 20, 3, 30, 4, 40}, "wide")});
    const Record wide = read_record(folder.at("b.mat"));
    EXPECT_EQ(wide.names, (std::vector<std::string>{"wide(1,:)", "wide(2,:)"}));
    EXPECT_EQ(wide.column("wide(2,:)"), Eigen::Vector4d(10, 20, 30, 40));
  }
}

TEST(MatTree, NameAndUnitThatContradictEachOtherAreRejected) {
  const Folder folder;
  write(folder.at("a.mat"), MAT_FT_MAT5, MAT_COMPRESSION_NONE,
        {structs({{{"acc_g", vector({1, 2, 3})}, {"acc_g_unit", text("m/s^2")}}}, "d")});
  EXPECT_NE(rejection([&] {
              static_cast<void>(read_record(folder.at("a.mat")));
            }).find("d.acc_g is in g by its name and in m/s^2 by the file"),
            std::string::npos);
}

// Mutated copies of valid files are read or rejected, never more.
TEST(MatTree, SurvivesMutations) {
  const Folder folder;
  std::vector<std::string> files;
  for (const auto& [version, packing] : versions) {
    matvar_t* signals = structs({{{"values", vector({1, 2, 3})}, {"label", text("Force")}},
                                 {{"values", vector({4, 5, 6})}, {"label", text("Acc")}}});
    write(folder.at("a.mat"), version, packing,
          {structs({{{"time", vector({0, 0.5, 1.0})}, {"signals", signals}}}, "out"),
           cell({text("N"), vector({1, 2})}, "c")});
    files.push_back(read_file(folder.at("a.mat")));
  }
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = files[random.index(3)];
    for (std::uint64_t i = 1 + random.index(4); i > 0; --i) {
      content[116 + random.index(content.size() - 116)] =
          static_cast<char>(random.index(3) == 0 ? 255 : random.index(256));
    }
    if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read_record(folder.file("b.mat", content));
      for (const Eigen::VectorXd& column : record.columns) ASSERT_TRUE(column.allFinite());
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace mat_tree_test
}  // namespace robomill::io
