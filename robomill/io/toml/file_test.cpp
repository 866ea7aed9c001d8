#include "robomill/io/toml/file.hpp"

#include <gtest/gtest.h>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace toml_file_test {

using test::Folder;
using test::rejection;

constexpr const char* example = R"(# a cut
[tool]
teeth = 3
diameter_mm = 12
pitch_deg = [100, 120, 140.0]
[coefficients]
tangential_n_per_mm2 = 0
[lobes]
spindle_speed_rpm = [4000, 16000]
method = "collocation"
compare = true
grid = [200, 100]
[[hits]]
file = "a.csv"
window_s = 0.5
responses = { y = "ay", x = "ax" }
[[hits]]
file = "sub/b.csv"
window_s = -0.25
)";

struct Toml : ::testing::Test {
  Folder folder;
  std::filesystem::path path = folder.file("lobes.toml", example);
  TomlFile file{path};
  std::string name = path.string();
};

enum class Method { collocation, other };

TEST_F(Toml, ReadsEveryKindOfValue) {
  double diameter_m = 0.0;
  int teeth = 0;
  bool compare = false;
  std::string text;
  std::vector<double> pitch_rad, speed_rad_per_s;
  std::vector<int> grid;
  std::filesystem::path hit;
  Method method = Method::other;
  EXPECT_TRUE(file.number("tool.diameter_mm", "diameter_m", units::mm, diameter_m));
  EXPECT_DOUBLE_EQ(diameter_m, 0.012);
  EXPECT_TRUE(file.integer("tool.teeth", "teeth", teeth));
  EXPECT_EQ(teeth, 3);
  EXPECT_TRUE(file.numbers("tool.pitch_deg", "pitch_rad", units::deg, pitch_rad));
  ASSERT_EQ(pitch_rad.size(), 3u);
  EXPECT_DOUBLE_EQ(pitch_rad[2], 140.0 * units::deg);
  EXPECT_TRUE(file.numbers("tool.diameter_mm", "diameter_m", units::mm, speed_rad_per_s));
  EXPECT_EQ(speed_rad_per_s.size(), 1u);
  EXPECT_TRUE(file.boolean("lobes.compare", compare));
  EXPECT_TRUE(compare);
  EXPECT_TRUE(file.integers("lobes.grid", "grid", grid));
  EXPECT_EQ(grid, (std::vector<int>{200, 100}));
  EXPECT_TRUE(file.text("hits[1].file", text));
  EXPECT_EQ(text, "sub/b.csv");
  EXPECT_TRUE(file.path("hits[1].file", hit));
  EXPECT_EQ(hit, folder.path() / "sub" / "b.csv");
  EXPECT_EQ(file.tables("hits"), 2u);
  EXPECT_EQ(file.tables("cuts"), 0u);
  EXPECT_EQ(file.keys("hits[0].responses"), (std::vector<std::string>{"y", "x"}));
  EXPECT_TRUE(
      file.choice<Method>("lobes.method", {{"collocation", Method::collocation}, {"other", Method::other}}, method));
  EXPECT_EQ(method, Method::collocation);
}

TEST_F(Toml, LeavesTheDefaultWhereTheKeyIsAbsent) {
  double helix_rad = 0.3;
  std::vector<std::string> texts = {"kept"};
  EXPECT_FALSE(file.number("tool.helix_deg", "helix_rad", units::deg, helix_rad));
  EXPECT_EQ(helix_rad, 0.3);
  EXPECT_FALSE(file.texts("tool.names", texts));
  EXPECT_EQ(texts.size(), 1u);
  EXPECT_FALSE(file.has("hits[2]"));
  EXPECT_FALSE(file.has("hits[2].file"));
  EXPECT_FALSE(file.has("tool.teeth.more"));
  EXPECT_FALSE(file.has("tool."));
}

TEST_F(Toml, NamesFileLineKeyAndValueOfAWrongType) {
  double number = 0.0;
  int whole = 0;
  std::string text;
  EXPECT_EQ(rejection([&] { file.number("lobes.method", "m", 1.0, number); }),
            name + ":10: lobes.method = \"collocation\"; must be a finite number");
  EXPECT_EQ(rejection([&] { file.integer("tool.pitch_deg", "m", whole); }),
            name + ":5: tool.pitch_deg: must be a whole number");
  EXPECT_EQ(rejection([&] { file.text("hits[1].window_s", text); }),
            name + ":19: hits[2].window_s = -0.25 s; must be text in quotes");
  EXPECT_EQ(rejection([&] { (void)file.tables("tool"); }),
            name + ":2: tool: must be a list of tables. Write [[tool]] above each");
  Method method = Method::other;
  EXPECT_EQ(rejection([&] {
              file.choice<Method>("lobes.method", {{"zeroth", Method::other}}, method);
            }),
            name + ":10: lobes.method = \"collocation\"; must be one of \"zeroth\"");
  EXPECT_EQ(rejection([&] { file.require("tool.helix_deg", "The angle of the flutes"); }),
            name + ":2: tool.helix_deg: is missing. The angle of the flutes");
}

// Each value once more by TOML itself: what is written is read as the same.
TEST(TomlFiles, GivesValuesAsTomlWritesThem) {
  const Folder folder;
  TomlFile file(folder.file("v.toml", R"(
one = 7
plain = [1, 2.50, 1e-7, 9007199254740993, "a \"b\"", true]
lists = [
  [6000, 12000],   # from, to
  [[1, 2],
   [3.5, "x#y"]],  # rows
  [],
  0x10,
]
none = []
)"));
  std::vector<std::string> out = {"as it was"};
  EXPECT_FALSE(file.literals("absent", out));
  EXPECT_EQ(out, std::vector<std::string>{"as it was"});
  EXPECT_TRUE(file.literals("one", out));
  EXPECT_EQ(out, std::vector<std::string>{"7"});
  EXPECT_TRUE(file.literals("plain", out));
  EXPECT_EQ(out, (std::vector<std::string>{"1", "2.5", "1e-07", "9007199254740993", R"("a \"b\"")", "true"}));
  EXPECT_TRUE(file.literals("lists", out));
  EXPECT_EQ(out, (std::vector<std::string>{"[6000, 12000]", R"([[1, 2], [3.5, "x#y"]])", "[]", "16"}));
  TomlFile again(TomlSource("again.toml", "[t]", {{"t.lists", "[" + out[0] + ", " + out[1] + ", [], 16]"}}));
  std::vector<std::string> same;
  EXPECT_TRUE(again.literals("t.lists", same));
  EXPECT_EQ(same, out);
  EXPECT_TRUE(file.literals("none", out));
  EXPECT_TRUE(out.empty());
}

TEST(TomlFiles, NamesTheLineOfWhatIsNoValue) {
  const auto says = [](const std::string& text) {
    TomlFile file(TomlSource("v.toml", "[[vary]]\nvalues = " + text));
    std::vector<std::string> out;
    return rejection([&] { file.literals("vary[0].values", out); });
  };
  const std::string rule = "; must be a finite number, a text, true or false, or a list of them";
  const std::string only = rule.substr(2);
  EXPECT_EQ(says("{ a = 1 }"), "v.toml:2: vary[1].values: " + only);
  EXPECT_EQ(says("1979-05-27"), "v.toml:2: vary[1].values: " + only);
  EXPECT_EQ(says("[[1, 2],\n[3,\n{ a = 1 }]]"), "v.toml:4: vary[1].values[2][2]: " + only);
  EXPECT_EQ(says("[\n1,\n[\n[2,\n1979-05-27]]]"), "v.toml:6: vary[1].values[2][1][2]: " + only);
  EXPECT_EQ(says("[1,\n[2,\ninf]]"), "v.toml:4: vary[1].values[2][2] = inf" + rule);
  EXPECT_EQ(says("[nan]"), "v.toml:2: vary[1].values[1] = nan" + rule);
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_NE(rejection([&] { TomlFile file(TomlSource("v.toml", "values = " + deep)); }).find("is no TOML"),
            std::string::npos);
}

// The message that a user of the library is promised: file, line, key, value and unit of the file, the rule and the
// hint.
TEST_F(Toml, ReportsTheErrorOfAMemberInItsOwnWords) {
  double tangential_n_per_m2 = 0.0;
  file.number("coefficients.tangential_n_per_mm2", "tangential_n_per_m2", units::n_per_mm2, tangential_n_per_m2);
  const char* hint = "Aluminium is near 700; did you pass N/m^2?";
  EXPECT_EQ(rejection([&] {
              file.locate([&] {
                require_positive("cut.coefficients.tangential_n_per_m2", tangential_n_per_m2, "N/m^2", hint);
              });
            }),
            name + ":7: coefficients.tangential_n_per_mm2 = 0 N/mm^2; must be > 0. " + hint);
}

TEST_F(Toml, ConvertsTheValueOfAnErrorToTheUnitOfTheKey) {
  std::vector<double> speed_rad_per_s, pitch_rad;
  file.numbers("lobes.spindle_speed_rpm", "spindle_speed_rad_per_s", units::rpm, speed_rad_per_s);
  file.numbers("tool.pitch_deg", "pitch_rad", units::deg, pitch_rad);
  const InvalidInput speed =
      file.located(InvalidInput("spindle_speed_rad_per_s[0]", speed_rad_per_s[0], "rad/s", "is too low"));
  EXPECT_EQ(*speed.parts().number, 4000.0);
  EXPECT_EQ(std::string(speed.what()), name + ":9: lobes.spindle_speed_rpm[0] = 4000 rpm; is too low");
  const InvalidInput pitch = file.located(InvalidInput("tool.pitch_rad", "must sum to a revolution"));
  EXPECT_EQ(std::string(pitch.what()), name + ":5: tool.pitch_deg: must sum to a revolution");
}

TEST_F(Toml, SaysWhichOfSeveralTablesAnErrorComesFrom) {
  double window_s = 0.0;
  file.number("hits[0].window_s", "window_s", 1.0, window_s);
  file.number("hits[1].window_s", "window_s", 1.0, window_s);
  EXPECT_EQ(rejection([&] { file.locate([&] { require_positive("window_s", window_s, "s"); }); }),
            name + ":19: hits[2].window_s = -0.25 s; must be > 0");
}

TEST_F(Toml, SaysThatAnInvalidDefaultIsAMissingKey) {
  double depth_m = 0.0, radius_m = 0.5;
  file.number("cut.radial_depth_mm", "radial_depth_m", units::mm, depth_m);
  file.number("tool.radius_mm", "radius_m", units::mm, radius_m);
  EXPECT_EQ(std::string(file.located(InvalidInput("radial_depth_m", 0.0, "m", "must be > 0")).what()),
            name + ": cut.radial_depth_mm: is missing; must be > 0");
  EXPECT_EQ(std::string(file.located(InvalidInput("radius_m", 0.5, "m", "is too big")).what()),
            name + ":2: tool.radius_mm = 500 mm; is the default, not in the file; is too big");
}

TEST_F(Toml, LeavesErrorsAloneThatAreNotItsOwn) {
  double teeth = 0.0;
  file.number("tool.teeth", "teeth", 1.0, teeth);
  EXPECT_EQ(std::string(file.located(InvalidInput("false_teeth", 0.0, "", "no")).what()), "false_teeth = 0; no");
  const InvalidInput elsewhere(InvalidInput::Parts{.where = "other.csv:3", .field = "teeth", .rule = "no"});
  EXPECT_EQ(std::string(file.located(elsewhere).what()), "other.csv:3: teeth: no");
  EXPECT_EQ(std::string(file.located(InvalidInput("", "no")).what()), "no");
}

TEST_F(Toml, RejectsKeysThatNobodyRead) {
  double number = 0.0;
  std::vector<double> list;
  std::string text;
  file.number("coefficients.tangential_n_per_mm", "", 1.0, number);
  EXPECT_EQ(rejection([&] { static_cast<void>(file.done()); }),
            name +
                ":7: coefficients.tangential_n_per_mm2: is not known here. Did you mean "
                "coefficients.tangential_n_per_mm?");
  file.skip("coefficients.tangential_n_per_mm2");
  file.skip("lobes");
  file.numbers("tool.pitch_deg", "", 1.0, list);
  file.number("tool.diameter_mm", "", 1.0, number);
  EXPECT_EQ(file.tables("hits"), 2u);
  for (const std::string hit : {"hits[0]", "hits[1]"}) {
    file.text(hit + ".file", text);
    file.number(hit + ".window_s", "", 1.0, number);
  }
  EXPECT_EQ(rejection([&] { static_cast<void>(file.done()); }), name + ":16: hits[1].responses.x: is not known here");
  (void)file.keys("hits[0].responses");
  EXPECT_NO_THROW(static_cast<void>(file.done()));
}

TEST(TomlFiles, RejectsWhatIsNoTomlWithItsLine) {
  const Folder folder;
  const std::filesystem::path twice = folder.file("twice.toml", "a = 1\n\na = 2\n");
  EXPECT_EQ(rejection([&] { TomlFile file(twice); }).find(twice.string() + ":3: is no TOML: "), 0u);
  const std::filesystem::path star = folder.file("star.toml", "a = 1\n[*]\n");
  EXPECT_EQ(rejection([&] { TomlFile file(star); }).find(star.string() + ":2: is no TOML: "), 0u);
  EXPECT_NE(rejection([&] { TomlFile file(folder.at("none.toml")); }).find("there is no such file"), std::string::npos);
  EXPECT_NE(rejection([&] { TomlFile file(folder.file("empty.toml", "")); }).find("is empty"), std::string::npos);
  EXPECT_NE(rejection([&] { TomlFile file(folder.path()); }).find("is a folder"), std::string::npos);
  TomlFile odd(folder.file("odd.toml", "a = nan\nb = inf\nc = 3e9\nd = [1, \"2\"]\n[e]\n"));
  double number = 0.0;
  int whole = 0;
  std::vector<double> list;
  EXPECT_NE(rejection([&] { odd.number("a", "a", 1.0, number); }).find(":1: a = nan; must be a finite"),
            std::string::npos);
  EXPECT_NE(rejection([&] { odd.number("b", "b", 1.0, number); }).find(":2: b = inf"), std::string::npos);
  EXPECT_NE(rejection([&] { odd.integer("c", "c", whole); }).find(":3: c = 3e+09"), std::string::npos);
  EXPECT_NE(rejection([&] { odd.numbers("d", "d", 1.0, list); }).find(":4: d: must be a list"), std::string::npos);
  for (const char* key : {"a", "b", "c", "d"}) odd.skip(key);
  EXPECT_NE(rejection([&] { static_cast<void>(odd.done()); }).find(":5: e: is not known here"), std::string::npos);
}

TEST(TomlFiles, RejectsWhatNestsTooDeeply) {
  const Folder folder;
  const auto repeated = [](const std::string& text, int count) {
    std::string out;
    for (int i = 0; i < count; ++i) out += text;
    return out;
  };
  const auto said = [&](const std::string& text) {
    return rejection([&] { TomlFile file(folder.file("deep.toml", text)); });
  };
  const int deep = 1000000;
  // Dotted keys, also where quotes, blanks, comments and texts stand between; an error behind them must not matter.
  for (const std::string& text :
       {"a" + repeated(".a", deep) + " = 1\n", "[a" + repeated(".a", deep) + "]\n",
        "[[a" + repeated(".a", deep) + "]]\n", "a" + repeated(" . \"=\\\"#\"", deep) + " = 1\n",
        "b = { a" + repeated(".'#'", deep) + " = 1 }\n",
        "b = [\"\"\"\"\n# \"\"\"\"\", { a" + repeated(".a", deep) + " = 1 }]\n",
        "a" + repeated(".a", deep) + " = 1\n]\n"}) {
    EXPECT_NE(said(text).find(": has a key of more than 32 parts"), std::string::npos) << text.substr(0, 40);
  }
  EXPECT_NE(said("a = " + repeated("[", deep) + repeated("]", deep) + "\n").find("is no TOML"), std::string::npos);
  EXPECT_NE(said("a = " + repeated("{a=", deep) + "1" + repeated("}", deep) + "\n").find("is no TOML"),
            std::string::npos);
  // Neither long texts nor lists of numbers are keys.
  TomlFile file(folder.file("flat.toml", "a = [" + repeated("1.5, ", 1000) + "]\nb = \"" + repeated("a. ", 1000) +
                                             "\" # " + repeated("a.b ", 1000) + "\nc = '''" + repeated("x.y\n", 1000) +
                                             "'''\n"));
  for (const char* key : {"a", "b", "c"}) file.skip(key);
  static_cast<void>(file.done());
}

TEST(TomlFiles, SurvivesMutations) {
  const Folder folder;
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = example;
    for (std::uint64_t i = random.index(6) + 1; i > 0; --i) {
      content[random.index(content.size())] = static_cast<char>(random.index(256));
    }
    if (random.index(2) == 0) content.resize(random.index(content.size()) + 1);
    const std::filesystem::path path = folder.file("mutated.toml", content);
    try {
      TomlFile file(path);
      double number = 0.0;
      std::vector<double> list;
      file.number("tool.diameter_mm", "diameter_m", units::mm, number);
      file.numbers("tool.pitch_deg", "pitch_rad", units::deg, list);
      for (std::size_t i = 0; i < file.tables("hits"); ++i)
        (void)file.keys("hits[" + std::to_string(i) + "].responses");
      static_cast<void>(file.done());
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("mutated.toml"), std::string::npos) << error.what();
    }
  }
}

// toml++ lets the compiler assume that a letter beyond ASCII comes nowhere where a blank may stand.
TEST(TomlFiles, LettersBeyondAsciiAreNoBlanks) {
  const auto utf8 = [](unsigned letter) {
    return std::string({static_cast<char>(0xC0 | letter >> 6U), static_cast<char>(0x80 | (letter & 0x3FU))});
  };
  for (unsigned letter = 0xA1; letter < 0x49A; ++letter) {
    const std::string is_key = rejection([&] { const TomlFile file({"a.toml", utf8(letter) + " = 1\n"}); });
    EXPECT_NE(is_key.find("a.toml:1: "), std::string::npos) << letter << ": " << is_key;
    const TomlFile comment({"a.toml", "a = 1 #" + utf8(letter) + "\n#" + utf8(letter) + "\n"});
    EXPECT_TRUE(comment.has("a")) << letter;
  }
}

}  // namespace toml_file_test
}  // namespace robomill::io
