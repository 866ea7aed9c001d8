#include "robomill/io/records/mat.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/mat_layout.hpp"
#include "robomill/io/system/child.hpp"
#include "robomill/io/system/descriptor.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace mat_test {

using test::Folder;
using test::rejection;

/// What others write: single precision and integers, a complex vector, text and a struct among them.
void write_foreign(const std::filesystem::path& path, mat_ft version, matio_compression compression) {
  mat_t* mat = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(mat, nullptr);
  std::array<std::size_t, 2> dims = {4, 1};
  std::array<double, 4> re = {1.0, 2.0, 3.0, 4.0}, im = {-1.0, -2.0, -3.0, -4.0};
  std::array<float, 4> single = {0.5F, 1.5F, 2.5F, 3.5F};
  std::array<std::int16_t, 4> whole = {-1, 0, 1, 32767};
  std::string text = "note";
  mat_complex_split_t split{re.data(), im.data()};
  const auto add = [&](const char* name, matio_classes type, matio_types data_type, void* data, int flags) {
    matvar_t* variable = Mat_VarCreate(name, type, data_type, 2, dims.data(), data, flags);
    EXPECT_EQ(Mat_VarWrite(mat, variable, compression), 0);
    Mat_VarFree(variable);
  };
  add("frequency_hz", MAT_C_DOUBLE, MAT_T_DOUBLE, re.data(), 0);
  add("H_xx", MAT_C_DOUBLE, MAT_T_DOUBLE, &split, MAT_F_COMPLEX);
  add("single_one", MAT_C_SINGLE, MAT_T_SINGLE, single.data(), 0);
  if (version != MAT_FT_MAT4) {
    add("whole", MAT_C_INT16, MAT_T_INT16, whole.data(), 0);
    std::swap(dims[0], dims[1]);
    add("text", MAT_C_CHAR, MAT_T_UINT8, text.data(), 0);
  }
  Mat_Close(mat);
}

TEST(Mat, GivesBackWhatItWrote) {
  const Folder folder;
  Random random(1);
  std::vector<MatVariable> written(3);
  for (std::size_t i = 0; i < 3; ++i) {
    written[i].name = fmt::format("v{}", i);
    written[i].re.resize(static_cast<Eigen::Index>(7 + i), static_cast<Eigen::Index>(1 + i));
    for (double& value : written[i].re.reshaped()) value = random.normal();
  }
  written[1].im = -2.0 * written[1].re;
  write_mat(folder.at("a.mat"), written);
  const std::vector<MatVariable> read = read_mat(folder.at("a.mat"));
  ASSERT_EQ(read.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].name, written[i].name);
    EXPECT_EQ(read[i].re, written[i].re);
    EXPECT_EQ(read[i].im, written[i].im);
  }
  const std::string once = read_file(folder.at("a.mat"));
  write_mat(folder.at("b.mat"), written);
  EXPECT_EQ(read_file(folder.at("b.mat")), once);
}

TEST(Mat, ThatCannotBeWrittenLeavesTheOldOne) {
  const Folder folder;
  const MatVariable one{.name = "x", .re = Eigen::MatrixXd::Random(300, 2)};
  write_mat(folder.at("a.mat"), {one});
  const std::size_t size = read_file(folder.at("a.mat")).size();
  for (const std::size_t room : {std::size_t{0}, std::size_t{1}, std::size_t{128}, size / 2, size - 1}) {
    const std::filesystem::path path = folder.file("a.mat", "old");
    const test::FileSizeLimit full(room);
    EXPECT_NE(rejection([&] { write_mat(path, {one}); }).find("a.mat: cannot be written"), std::string::npos) << room;
    EXPECT_EQ(read_file(path), "old");
  }
  EXPECT_EQ(folder.count(), 1u);
}

// Of version 4, 5 and 7.3, wherever it was cut but between two variables.
TEST(Mat, ThatWasCutOffIsRejected) {
  const Folder folder;
  for (const mat_ft version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    write_foreign(folder.at("a.mat"), version, MAT_COMPRESSION_NONE);
    const std::string whole = read_file(folder.at("a.mat"));
    const std::size_t all = read_mat(folder.at("a.mat")).size();
    int between = 0;
    for (std::size_t size = whole.size() - 1; size > 150; size -= std::max<std::size_t>(1, whole.size() / 300)) {
      const auto cut = folder.file("cut.mat", std::string_view(whole).substr(0, size));
      try {
        EXPECT_LE(read_mat(cut).size(), all);
        ++between;
      } catch (const InvalidInput&) {
      }
    }
    EXPECT_LE(between, 4) << version;
    const auto half = folder.file("half.mat", std::string_view(whole).substr(0, whole.size() - 5));
    EXPECT_NE(rejection([&] { static_cast<void>(read_mat(half)); })
                  .find(version == MAT_FT_MAT73 ? "is a damaged HDF5 file, or one that was cut off"
                                                : "ends within its variable"),
              std::string::npos);
  }
}

TEST(Mat, ReadsEveryVersion) {
  const Folder folder;
  for (const mat_ft version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    write_foreign(folder.at("a.mat"), version, MAT_COMPRESSION_NONE);
    std::vector<MatVariable> read = read_mat(folder.at("a.mat"));
    std::sort(read.begin(), read.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    ASSERT_EQ(read.size(), version == MAT_FT_MAT4 ? 3u : 4u) << version;
    EXPECT_EQ(read[0].name, "H_xx");
    EXPECT_EQ(read[0].re, Eigen::Vector4d(1, 2, 3, 4));
    EXPECT_EQ(read[0].im, Eigen::Vector4d(-1, -2, -3, -4));
    EXPECT_EQ(read[2].re, Eigen::Vector4d(0.5, 1.5, 2.5, 3.5));
    if (version != MAT_FT_MAT4) {
      EXPECT_EQ(read[3].re, Eigen::Vector4d(-1, 0, 1, 32767));
    }
  }
}

TEST(Mat, RejectsWhatItCannotRead) {
  const Folder folder;
  const auto says = [&](const std::string& content) {
    return rejection([&] { (void)read_mat(folder.file("a.mat", content)); });
  };
  EXPECT_NE(says("frequency_hz,xx\n1,2\n").find("is no MAT file"), std::string::npos);
  EXPECT_NE(says("").find("is empty"), std::string::npos);
  EXPECT_NE(rejection([&] { write_mat(folder.at("no/a.mat"), {}); }).find("no folder"), std::string::npos);
  // A variable that says it holds 2^31 - 1 values is rejected before memory is asked for.
  write_foreign(folder.at("b.mat"), MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  std::string content = read_file(folder.at("b.mat"));
  const std::size_t rows = content.find(std::string("\4\0\0\0\1\0\0\0", 8));
  ASSERT_NE(rows, std::string::npos);
  content.replace(rows, 4, "\xFF\xFF\xFF\x7F");
  EXPECT_NE(says(content).find("more than the file can"), std::string::npos);
}

TEST(Mat, SurvivesMutations) {
  const Folder folder;
  for (const auto& [version, count] : {std::pair{MAT_FT_MAT5, 4000}, {MAT_FT_MAT73, 500}, {MAT_FT_MAT4, 200}}) {
    write_foreign(folder.at("a.mat"), version, MAT_COMPRESSION_NONE);
    const std::string original = read_file(folder.at("a.mat"));
    const std::size_t from = version == MAT_FT_MAT4 ? 0 : 116;
    for (int seed = 0; seed < test::seeds(count); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      std::string content = original;
      for (std::uint64_t i = random.index(6); i > 0; --i) {
        content[from + random.index(content.size() - from)] =
            static_cast<char>(random.index(4) == 0 ? 255 : random.index(256));
      }
      if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
      try {
        for (const MatVariable& variable : read_mat(folder.file("b.mat", content))) {
          EXPECT_TRUE(variable.im.size() == 0 || variable.im.size() == variable.re.size());
        }
      } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("b.mat"), std::string::npos);
      }
    }
  }
}

TEST(Mat, SeemsToHaveWhatItHas) {
  const test::Folder place;
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(20, 1.0, 20.0);
  const std::string long_name(63, 'n');
  write_mat(place.at("a.mat"), {{.name = "H", .re = values, .im = values},
                                {.name = "frequency_hz", .re = values},
                                {.name = long_name, .re = values}});
  constexpr std::size_t enough = std::size_t{1} << 20;
  for (const char* name : {"H", "frequency_hz"})
    EXPECT_TRUE(mat_seems_to_have(place.at("a.mat"), name, enough)) << name;
  EXPECT_TRUE(mat_seems_to_have(place.at("a.mat"), long_name, enough));
  for (const char* name : {"", "h", "frequency", "hz"}) {
    EXPECT_FALSE(mat_seems_to_have(place.at("a.mat"), name, enough)) << name;
  }
  EXPECT_FALSE(mat_seems_to_have(place.at("a.mat"), "H", 100));
  EXPECT_FALSE(mat_seems_to_have(place.at("none.mat"), "H", enough));
  // Of every level, packed or not, and cut off or changed anywhere: an answer.
  for (const mat_ft level : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    mat_t* mat = Mat_CreateVer(place.at("b.mat").c_str(), nullptr, level);
    ASSERT_NE(mat, nullptr);
    std::array<std::size_t, 2> dims = {20, 1};
    std::vector<double> numbers(values.begin(), values.end());
    matvar_t* variable = Mat_VarCreate("frequency_hz", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims.data(), numbers.data(), 0);
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
    Mat_Close(mat);
    EXPECT_TRUE(mat_seems_to_have(place.at("b.mat"), "frequency_hz", enough)) << level;
    EXPECT_FALSE(mat_seems_to_have(place.at("b.mat"), "force", enough)) << level;
  }
  for (const char* file : {"a.mat", "b.mat"}) {
    const std::string whole = read_file(place.at(file));
    for (std::size_t at = 0; at < std::min<std::size_t>(whole.size(), 600); ++at) {
      static_cast<void>(mat_names(whole.substr(0, at)));
      for (const char changed : {'\0', '\xff'}) {
        std::string content = whole;
        content[at] = changed;
        static_cast<void>(mat_names(content));
      }
    }
  }
}

TEST(Child, IsKilledWhereItsAnswerNeverEnds) {
  const std::chrono::milliseconds moment(100);
  const auto forever = [] {
    for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  EXPECT_EQ(run_in_child({.more_memory_bytes = 1 << 26, .time = moment},
                         [&]() -> std::string {
                           forever();
                           return "done";
                         }),
            std::nullopt);
  // Its end of the way back is closed, and it lives on.
  EXPECT_EQ(run_in_child({.more_memory_bytes = 1 << 26, .time = moment},
                         [&]() -> std::string {
                           ::close_range(3, ~0U, 0);
                           forever();
                           return "done";
                         }),
            std::nullopt);
  EXPECT_EQ(run_in_child({.more_memory_bytes = 1 << 20}, [] { return std::string((1 << 20) + 1, 'a'); }), std::nullopt);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);  // none is left
}

TEST(Child, HasNoneOfItsParentsFiles) {
  const test::Folder place;
  const Descriptor held(::open(place.file("held.txt", "x").c_str(), O_RDONLY | O_CLOEXEC));
  const Descriptor lent(::open(place.file("lent.txt", "x").c_str(), O_RDONLY | O_CLOEXEC));
  const auto look = [&]() -> std::string {
    return std::string(::fcntl(held.get(), F_GETFD) < 0 ? "none" : "held") +
           (::fcntl(lent.get(), F_GETFD) < 0 ? " none" : " lent");
  };
  EXPECT_EQ(run_in_child({.more_memory_bytes = 1 << 26}, look), "none none");
  EXPECT_EQ(run_in_child({.more_memory_bytes = 1 << 26, .lent = lent.get()}, look), "none lent");
}

TEST(Child, HandsBackWhatWasSaidAndSurvivesItsDeath) {
  constexpr ChildLimits memory = {.more_memory_bytes = std::size_t{1} << 26};
  EXPECT_EQ(run_in_child(memory, [] { return std::string(1 << 20, 'a'); }), std::string(1 << 20, 'a'));
  EXPECT_EQ(run_in_child(memory, [] { return std::string(); }), "");
  EXPECT_EQ(run_in_child(memory, []() -> std::string { throw std::runtime_error("no"); }), std::nullopt);
  EXPECT_EQ(run_in_child(memory,
                         []() -> std::string {
                           std::raise(SIGKILL);
                           return "alive";
                         }),
            std::nullopt);
}

}  // namespace mat_test
}  // namespace robomill::io
