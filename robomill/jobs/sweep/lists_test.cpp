// Keys of a study whose values are lists: each is one value.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/table.hpp"
#include "robomill/jobs/files/study_toml.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/sweep.hpp"
#include "robomill/jobs/sweep/shown_points.hpp"
#include "robomill/jobs/verbs.hpp"
#include "testing/jobs/study_cut.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace study_lists_test {

using test::rejection;
using test_support::study_cut;
using Strings = std::vector<std::string>;

/// Texts of one length, as HDF5's library reads them.
Strings hdf5_texts(const std::filesystem::path& path, const std::string& column) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen(file, column.c_str(), H5P_DEFAULT), type = H5Dget_type(set), space = H5Dget_space(set);
  Strings out;
  EXPECT_EQ(H5Tget_class(type), H5T_STRING) << column;
  const std::size_t length = H5Tget_size(type);
  std::string bytes(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * length, '\0');
  EXPECT_GE(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), 0);
  for (std::size_t at = 0; at < bytes.size(); at += length) {
    const std::string text = bytes.substr(at, length);
    out.push_back(text.substr(0, text.find('\0')));
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
  H5Fclose(file);
  return out;
}

class StudyLists : public ::testing::Test {
 protected:
  StudyLists() { folder_.file("lobes.toml", study_cut()); }
  void study(const std::string& tables, const std::string& collect = "limit@8000",
             const std::string& base = "lobes.toml") {
    folder_.file("study.toml",
                 "[study]\njob = \"lobes\"\nbase = \"" + base + "\"\ncollect = \"" + collect + "\"\n" + tables);
  }
  SweepResult run(const std::string& into, int shard = 1, int shards = 1) {
    return run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at(into), .shard = shard, .shards = shards});
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return io::read_file(folder_.at(name)); }
  /// The cells of a column of out/results.csv.
  [[nodiscard]] Strings cells(std::size_t column) const {
    std::vector<std::string> warnings;
    Strings out;
    for (const io::TextTable::Row& row : io::parse_text_table(bytes("out/results.csv"), "r.csv", warnings).rows)
      out.push_back(row.fields[column]);
    return out;
  }

  test::Folder folder_;
};

/// The cut with teeth that are unequally spaced.
std::string cut_with_pitch(const std::string& pitch) {
  std::string text = study_cut();
  return text.insert(text.find("[tool]\n") + 7, "pitch_deg = " + pitch + "\n");
}

// Each point is what the verb gives for a document that has the list in place of its own.
TEST_F(StudyLists, GiveWhatTheVerbGives) {
  folder_.file("lobes.toml", cut_with_pitch("[170,  # of the first\n  190]"));
  study(R"(chunk_points = 2
[[vary]]
key = "tool.pitch_deg"
values = [[180, 180], [150, 210]]
[[vary]]
key = "cut.radial_depth_mm"
range = [2, 8]
count = 3
)",
        "abs_mu@8000,1");
  const SweepResult result = run("out");
  EXPECT_EQ(result.done, 6U) << (result.reasons.empty() ? "" : result.reasons[0]);
  const Strings pitch = cells(0), radial_mm = cells(1), radius = cells(2);
  ASSERT_EQ(pitch.size(), 6U);
  for (std::size_t i = 0; i < pitch.size(); ++i) {
    EXPECT_EQ(pitch[i], i < 3 ? "[180, 180]" : "[150, 210]");
    const auto alone = folder_.file("alone.toml", cut_with_pitch(pitch[i]));
    const LobesJobResult found =
        run_lobes({.lobes = io::TomlSource(alone, {}, {{"cut.radial_depth_mm", radial_mm[i]}}),
                   .points = {{.spindle_speed_rad_per_s = 8000 * 2 * std::acos(-1.0) / 60, .axial_depth_m = 1e-3}}});
    EXPECT_NEAR(*io::parse_cell(radius[i]), found.lobes.points[0].spectral_radius, 1e-9);
  }
  EXPECT_NE(radius[0], radius[3]) << "the pitch counts";
  for (const int shard : {2, 3, 1}) run("shards", shard, 3);
  run("shards");
  for (const char* name : {"results.csv", "results.h5"}) {
    EXPECT_EQ(bytes(std::string("out/") + name), bytes(std::string("shards/") + name));
  }
}

// A list that the document does not take rejects its points alone.
TEST_F(StudyLists, RejectPointsWhoseListIsNoValueOfTheKey) {
  const auto first_reason = [&](const std::string& key, const std::string& values) {
    study("[[vary]]\nkey = \"" + key + "\"\nvalues = " + values + "\n");
    std::filesystem::remove_all(folder_.at("out"));
    const SweepResult result = run("out");
    EXPECT_EQ(result.done + result.rejected, 2U);
    return result.reasons.empty() ? std::string() : result.reasons[0];
  };
  EXPECT_EQ(first_reason("lobes.spindle_speed_rpm", "[[4000, 12000], [6000, 16000]]"), "");
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(first_reason("tool.teeth", "[[2, 3], 4]"), "lobes.toml: tool.teeth: must be a whole number");
  for (const char* first : {"[4000, \"a\"]", "[[4000, 12000]]"}) {
    has(first_reason("lobes.spindle_speed_rpm", std::string("[") + first + ", [6000, 16000]]"),
        "lobes.toml: lobes.spindle_speed_rpm: must be a list of finite numbers");
  }
  has(first_reason("lobes.spindle_speed_rpm", "[[], [6000, 16000]]"), "lobes.toml: lobes.spindle_speed_rpm");
  has(first_reason("dynamics.x", "[[1, 2], [3, 4]]"), "lobes.toml: dynamics.x");
  has(first_reason("spindle.power_kw", "[[1, 2], [3, 4]]"), "does not read spindle.power_kw in it");
}

TEST_F(StudyLists, RejectListsWhereTheyHaveNoMeaning) {
  const auto says = [&](const std::string& tables, const std::string& part) {
    study(tables);
    const std::string said = rejection([&] { run("out"); });
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  says("[[vary]]\nkey = \"lobes.spindle_speed_rpm\"\nrange = [[4000, 12000], [6000, 16000]]\ncount = 3\n",
       "study.toml:7: vary[1].range: must be a list of finite numbers");
  says("[boundary]\nvalue = \"abs_mu@8000,1\"\n[[vary]]\nkey = \"tool.pitch_deg\"\nvalues = [[180, 180], [150, 210]]\n",
       "study.toml:7: vary[1]: must be a range on a grid");
}

// A column with a list has every value as TOML writes it, so that a text "[1]" is no list; another has texts bare.
TEST_F(StudyLists, AreToldFromTexts) {
  study(R"(
[[vary]]
key = "cut.direction"
values = [["up"], "[\"up\"]", "up", 123456789, true, [[1, 2.5], ["a", "b,c"]], [], ""]
[[vary]]
key = "tool.teeth"
values = ["[3]", "x", "", 1234567]
[[vary]]
key = "tool.helix_deg"
values = [""]
[[vary]]
table = "cells.csv"
)");
  folder_.file("cells.csv", "cut.feed_per_tooth_mm\n\"[0.1, 0.2]\"\n");
  EXPECT_EQ(run("out").points, 32U);
  const Strings first = {R"(["up"])", R"("[\"up\"]")", R"("up")", "123456789", "true", R"([[1, 2.5], ["a", "b,c"]])",
                         "[]",        R"("")"};
  const Strings second = {"[3]", "x", "", "1234567"};
  const Strings a = cells(0), b = cells(1);
  ASSERT_EQ(a.size(), 32U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i], first[i / 4]);
    EXPECT_EQ(b[i], second[i % 4]);
    EXPECT_NO_THROW(static_cast<void>(io::parse_json(a[i], "cell"))) << "what TOML writes, JSON reads";
  }
  EXPECT_EQ(hdf5_texts(folder_.at("out/results.h5"), "cut.direction"), a);
  EXPECT_EQ(hdf5_texts(folder_.at("out/results.h5"), "tool.teeth"), b) << "numbers beside short texts are whole";
  EXPECT_EQ(hdf5_texts(folder_.at("out/results.h5"), "tool.helix_deg"), Strings(32)) << "texts, though all are empty";
  EXPECT_EQ(cells(3), Strings(32, "[0.1, 0.2]")) << "a cell is a plain value: a text";
}

// A column's memory is bounded, however long its texts are: 16,384 of these are 5 GB.
TEST_F(StudyLists, MayBeLong) {
  std::string values;
  for (const char* first : {"0", "1"}) {
    values += values.empty() ? "[[" : ", [";
    values += first;
    for (int i = 1; i < 50'000; ++i) values += ", " + std::to_string(i);
    values += "]";
  }
  study("[[vary]]\nkey = \"tool.pitch_deg\"\nvalues = " + values +
        "]\n[[vary]]\nkey = \"tool.teeth\"\nrange = [1, 8]\ncount = 8\n");
  EXPECT_EQ(run("out").rejected, 16U);
  const Strings written = cells(0);
  ASSERT_EQ(written.size(), 16U);
  EXPECT_EQ("[" + written.front() + ", " + written.back() + "]", values + "]");
  EXPECT_EQ(hdf5_texts(folder_.at("out/results.h5"), "tool.pitch_deg"), written);
}

// Files that a list names count with what is in them. Their paths are relative to the document.
TEST_F(StudyLists, CountTheFilesThatTheyName) {
  std::filesystem::create_directory(folder_.at("cuts"));
  folder_.file("cuts/lobes.toml", study_cut());
  folder_.file("cuts/a.txt", "1");
  folder_.file("cuts/b.txt", "2");
  study("[[vary]]\nkey = \"cut.direction\"\nvalues = [[\"x\", [\"a.txt\", \"no.txt\"]], \"b.txt\"]\n", "limit@8000",
        "cuts/lobes.toml");
  const auto fingerprint = [&] { return fingerprint_of(read_study(folder_.at("study.toml"))); };
  const std::string before = fingerprint();
  for (const char* name : {"cuts/a.txt", "cuts/b.txt"}) {
    const std::string text = bytes(name);
    folder_.file(name, "other");
    EXPECT_NE(fingerprint(), before) << name;
    folder_.file(name, text);
    EXPECT_EQ(fingerprint(), before);
  }
  folder_.file("cuts/no.txt", "3");
  EXPECT_NE(fingerprint(), before);
}

// Combinations with a list have probabilities and indices of their own; the page has its values as texts.
TEST_F(StudyLists, AreCombinedWithSamples) {
  const std::string lists = "[[vary]]\nkey = \"tool.pitch_deg\"\nvalues = [[180, 180], [150, 210]]\n";
  const std::string sampled = "[[vary]]\nkey = \"cut.radial_depth_mm\"\nrange = [2, 8]\nsampling = \"sobol\"\n";
  folder_.file("lobes.toml", cut_with_pitch("[180, 180]"));
  const auto page_of = [&](const std::string& tables) {
    study(tables, "abs_mu@8000,1");
    std::filesystem::remove_all(folder_.at("out"));
    const Verb& sweep = *std::ranges::find(verbs(), std::string("sweep"), &Verb::name);
    const Outcome outcome =
        sweep.run({.verb = sweep, .inputs = {folder_.at("study.toml")}, .output = folder_.at("out")}, Progress::none());
    return nlohmann::json::parse(page::report_json(outcome.page()));
  };
  nlohmann::json page =
      page_of("[probability]\nvalue = \"abs_mu@8000,1\"\nat_most = 1\n" + lists + sampled + "count = 8\n");
  const nlohmann::json& column = page["study_points"]["keys"][0];
  EXPECT_TRUE(column["numbers"].empty());
  ASSERT_EQ(column["texts"].size(), 16U);
  EXPECT_EQ(column["texts"][0], "[180, 180]");
  EXPECT_EQ(column["texts"][15], "[150, 210]");
  const nlohmann::json& rows = page["statistics"]["probability"]["rows"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["at"]["tool.pitch_deg"], "[180, 180]");
  EXPECT_EQ(rows[1]["at"]["tool.pitch_deg"], "[150, 210]");
  page = page_of("[sensitivity]\nsamples = 8\n" + lists + sampled);
  ASSERT_EQ(page["statistics"]["sensitivity"].size(), 2U);
  EXPECT_EQ(page["statistics"]["sensitivity"][1]["at"]["tool.pitch_deg"], "[150, 210]");
  EXPECT_EQ(page["statistics"]["sensitivity"][1]["status"], "found");
}

// A page has up to 5000 points: of a long value it has the beginning, and digits that tell it from others.
TEST_F(StudyLists, AreShortOnThePage) {
  const std::string letters = "[\"" + std::string(195, 'x');
  EXPECT_EQ(shown_text("[1, 2]"), "[1, 2]");
  EXPECT_EQ(shown_text(letters + "\"]").size(), 199U);
  const std::string one = shown_text(letters + "\u00e4\u00f6\u00fc1\"]"),
                    other = shown_text(letters + "\u00e4\u00f6\u00fc2\"]");
  EXPECT_TRUE(one.starts_with(letters + "\u00e4 \u2026 ")) << "ends with a whole letter: " << one;
  EXPECT_EQ(one.size(), 197U + 2U + 5U + 8U);
  EXPECT_NE(one, other);
}

}  // namespace study_lists_test
}  // namespace robomill::jobs
