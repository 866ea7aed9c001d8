// Values of an example that nobody has given, and keys that still stand behind a #.
#include "robomill/io/toml/samples.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/io/toml/file.hpp"
#include "testing/samples.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::io {
namespace samples_test {

using test_support::all_samples;

const std::string document =
    "[tool]\n"
    "teeth = 3                 # sample 3: of the cutter\n"
    "kind = \"flat-end\"         # sample flat-end: what it is\n"
    "helix_deg = 30            # of the flutes\n"
    "[dynamics]\n"
    "x = [{ frequency_hz = 620, damping_ratio = 0.03 }]    # sample 620 0.03: Hz\n"
    "[[hits]]\n"
    "file = \"a.csv\"            # sample example.csv:\n"
    "[[hits]]\n"
    "file = \"b.csv\"            # sample b.csv:\n";

std::vector<std::string> keys(const TomlSource& source) {
  std::vector<std::string> out;
  for (const Assumption& one : all_samples(source)) out.push_back(one.key + " " + one.taken);
  return out;
}

TEST(Samples, AreTheValuesThatAreStillWhatTheirMarksSay) {
  EXPECT_EQ(keys(TomlSource("d.toml", document)),
            (std::vector<std::string>{"tool.teeth 3", "tool.kind \"flat-end\"",
                                      "dynamics.x [{ frequency_hz = 620, damping_ratio = 0.03 }]",
                                      "hits[2].file \"b.csv\""}));
  const Assumption first = all_samples(TomlSource("folder/d.toml", document)).front();
  EXPECT_EQ(first.file, "d.toml");
  EXPECT_EQ(first.what, "Sample value left as it was");
}

TEST(Samples, AreNoneOnceTheyAreGiven) {
  const auto changed = test_support::replaced(document, "teeth = 3 ", "teeth = 4 ");
  EXPECT_EQ(keys(TomlSource("d.toml", changed)).size(), 3U);
  EXPECT_EQ(keys(TomlSource("d.toml", test_support::replaced(document, "= 620,", "= 621,"))).size(), 3U);
  EXPECT_EQ(keys(TomlSource("d.toml", document, {{"tool.teeth", "3"}, {"dynamics.x[0].frequency_hz", "620"}})).size(),
            2U);
  EXPECT_EQ(keys(TomlSource("d.toml", without_sample_mark(document, "tool.teeth"))).size(), 3U);
  EXPECT_NE(without_sample_mark(document, "tool.teeth").find("teeth = 3                 # of the cutter\n"),
            std::string::npos);
  EXPECT_NE(without_sample_mark(document, "hits[1].file").find("file = \"b.csv\"            \n"), std::string::npos);
  EXPECT_EQ(without_sample_mark(document, "tool.helix_deg"), document);
}

TEST(Samples, MarksListNumbersAndTextsInTheirOrder) {
  EXPECT_EQ(sample_mark("3"), "sample 3");
  EXPECT_EQ(sample_mark("-1.5e-3"), "sample -1.5e-3");
  EXPECT_EQ(sample_mark("[4000, 16000]"), "sample 4000 16000");
  EXPECT_EQ(sample_mark("{ x = \"ax\", -y = 2 }"), "sample ax 2");
  EXPECT_EQ(sample_mark("true"), "sample true");
}

// A header behind a # is no table of the live keys below it.
TEST(Samples, ACommentedHeaderIsThatOfCommentsAlone) {
  const std::string text =
      "[cut]\n# [tool]\n# teeth = 3\nlead_deg = 4   # sample 4: of the cut\n# [[hits]]\n[[hits]]\n"
      "file = \"a\"   # sample a:\n# [more]\n# force = 2\ntime = 1   # sample 1:\n# responses = 3\n";
  EXPECT_EQ(keys(TomlSource("d.toml", text)),
            (std::vector<std::string>{"cut.lead_deg 4", "hits[1].file \"a\"", "hits[1].time 1"}));
  TomlFile file(TomlSource("d.toml", text));
  const auto line_of = [&](const char* key) { return test::rejection([&] { file.require(key); }).substr(0, 9); };
  EXPECT_EQ(line_of("tool.teeth"), "d.toml:3:");
  EXPECT_EQ(line_of("more.force"), "d.toml:9:");
  EXPECT_EQ(line_of("hits[0].responses"), "d.toml:11");
}

// The line of the comment, what it is and what to do.
TEST(Samples, AMissingKeyPointsAtItsComment) {
  TomlFile file(
      TomlSource("lobes.toml", "[tool]\n# helix_deg = 0\n# teeth = 3     # of the cutter\n[cut]\n# teeth = 2\n"));
  EXPECT_EQ(
      test::rejection([&] { file.require("tool.teeth", "A whole number"); }),
      "lobes.toml:3: tool.teeth: is missing. A whole number. This line is a comment: write your own value and take "
      "the # away");
  int teeth = 0;
  file.integer("cut.teeth", "teeth", teeth);
  const std::string located =
      test::rejection([&] { file.locate([] { throw InvalidInput("teeth", 0, "", "must be >= 1"); }); });
  EXPECT_EQ(located,
            "lobes.toml:5: cut.teeth: is missing; must be >= 1. This line is a comment: write your own value and "
            "take the # away");
  EXPECT_EQ(test::rejection([&] { file.require("cut.radial_depth_mm"); }),
            "lobes.toml:4: cut.radial_depth_mm: is missing");
}

}  // namespace samples_test
}  // namespace robomill::io
