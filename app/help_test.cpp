// What the program says of itself, and of arguments that it cannot take.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "test_program.hpp"

namespace robomill::app {
namespace help_test {

class Help : public ProgramTest {
 protected:
  /// The names listed below "Subcommands:".
  static std::vector<std::string> listed(const std::string& help) {
    std::vector<std::string> names;
    std::istringstream rows(help);
    bool below = false;
    for (std::string row; std::getline(rows, row);) {
      if (below && row.starts_with("  ") && row.size() > 2 && row[2] != ' ') {
        names.push_back(row.substr(2, row.find(' ', 2) - 2));
      }
      below = below ? row.starts_with("  ") : row == "Subcommands:";
    }
    return names;
  }
  /// What stands behind a label at the begin of a line.
  static std::string behind(const std::string& label, const std::string& text) {
    const std::size_t at = text.find("\n" + label);
    if (at == std::string::npos) return {};
    const std::size_t begin = at + 1 + label.size();
    return text.substr(begin, text.find('\n', begin) - begin);
  }
  /// Every verb; "cell check" of one below another.
  void collect(const std::string& parents, std::vector<std::string>& verbs) {
    for (const std::string& name : listed(robomill(parents + "--help").out)) {
      const std::size_t before = verbs.size();
      collect(parents + name + " ", verbs);
      if (verbs.size() == before) verbs.push_back(parents + name);
    }
  }
};

// Where its files are missing it ends with 1; with 2 it would where a word of it is not known.
TEST_F(Help, EveryVerbShowsAnExampleThatParsesAndItsDocumentation) {
  std::vector<std::string> verbs;
  collect({}, verbs);
  EXPECT_GE(verbs.size(), 15U);
  for (const std::string& verb : verbs) {
    const std::string help = robomill(verb + " --help").out;
    const std::string example = behind("Example: robomill ", help);
    EXPECT_TRUE(example.starts_with(verb + " ")) << verb << ": its record has no example\n" << help;
    EXPECT_LE(robomill(example + " </dev/null").exit, 1) << example;
    std::istringstream pages(behind("Documentation: ", help));
    int count = 0;
    for (std::string page; std::getline(pages >> std::ws, page, ',');) {
      EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(ROBOMILL_SOURCE_DIR) / page)) << verb << ": " << page;
      ++count;
    }
    EXPECT_GE(count, 1) << help;
  }
}

TEST_F(Help, NumbersAreRejectedInPlainWords) {
  const std::pair<const char*, const char*> cases[] = {
      {"modes tip.uff --modes -3", "--modes: must be a whole number from 1 to 1000, not \"-3\""},
      {"modes tip.uff --modes 2.5", "--modes: must be a whole number from 1 to 1000, not \"2.5\""},
      {"modes tip.uff --modes 99999999999", "--modes: must be a whole number from 1 to 1000"},
      {"modes tip.uff --band 5,many", "--band: must be a number, not \"many\""},
      {"lobes lobes.toml --threads 0", "--threads: must be a whole number from 1 to 10000, not \"0\""},
      {"lobes lobes.toml --seed -1", "--seed: must be a whole number ≥ 0, not \"-1\""},
      {"explain --peaks 300,x --rpm 6500 --teeth 3 --modes m.json", "--peaks: must be a number, not \"x\""},
      {"explain --peaks 300 --rpm fast --teeth 3 --modes m.json", "--rpm: must be a number, not \"fast\""},
      {"explain --peaks 300 --rpm 6500 --teeth 0 --modes m.json",
       "--teeth: must be a whole number from 1 to 100, not \"0\""},
      {"simulate lobes.toml --at 6500,1 --seconds inf", "--seconds: must be a number, not \"inf\""},
      {"coefficients slots.csv --teeth 101", "--teeth: must be a whole number from 1 to 100, not \"101\""},
      {"monitor m.toml --metrics-port 65536", "--metrics-port: must be a whole number from 0 to 65535"}};
  for (const auto& [arguments, expected] : cases) {
    const Ended ended = robomill(arguments);
    EXPECT_EQ(ended.exit, 2) << arguments;
    EXPECT_NE(ended.err.find(expected), std::string::npos) << ended.err;
    std::istringstream rows(ended.err);
    for (std::string row; std::getline(rows, row);) EXPECT_LE(row.size(), 120U) << row;
  }
}

// What a request of the page must not hold either: verbs_test of serve.
TEST_F(Help, RangesAreThoseOfThePage) {
  const std::pair<const char*, const char*> cases[] = {
      {"simulate lobes.toml --at 6500,1 --seconds 0", "--seconds = 0 s; must be > 0"},
      {"simulate lobes.toml --at 6500,1 --sample-rate-hz -1", "--sample-rate-hz = -1 Hz; must be > 0"},
      {"monitor m.toml --seconds 0", "--seconds = 0 s; must be > 0"},
      {"explain --peaks 300 --rpm 6500 --teeth 3 --modes m.json --speed-tolerance-percent 6",
       "--speed-tolerance-percent = 6 %; must be >= 0 and <= 5"}};
  for (const auto& [arguments, expected] : cases) {
    const Ended ended = robomill(arguments);
    EXPECT_EQ(ended.exit, 1) << arguments;
    EXPECT_NE(ended.err.find(expected), std::string::npos) << ended.err;
  }
}

TEST_F(Help, ReadmeHasTheTableOfTheVerbs) {
  const std::string readme = slurp(ROBOMILL_SOURCE_DIR "/README.md");
  const std::string table = robomill("man markdown").out;
  EXPECT_GT(std::count(table.begin(), table.end(), '\n'), 17);
  EXPECT_NE(readme.find("<!-- verbs: build/robomill man markdown -->\n\n" + table + "\n<!-- /verbs -->"),
            std::string::npos)
      << "README.md should have between its marks:\n"
      << table;
}

TEST_F(Help, BashCompletesVerbsOptionsAndWords) {
  ASSERT_EQ(robomill("completion bash -o completion.bash").exit, 0);
  const auto completed = [this](const std::string& words, int at) {
    return shell("bash -c 'source ./completion.bash; COMP_WORDS=(robomill " + words +
                 "); COMP_CWORD=" + std::to_string(at) + "; _robomill; echo \"${COMPREPLY[*]}\"'")
        .out;
  };
  EXPECT_EQ(completed("sm", 1), "smooth\n");
  EXPECT_EQ(completed("modes --met", 2), "--method\n");
  EXPECT_EQ(completed("modes --method \"\"", 3), "hybrid pso lscf\n");
  EXPECT_EQ(completed("init lo", 2), "lobes\n");
  EXPECT_EQ(completed("cell ch", 2), "check\n");
  EXPECT_EQ(completed("cell check --jo", 3), "--joints\n");
  EXPECT_EQ(completed("couple a.toml --fr", 3), "--frfs\n");
  EXPECT_EQ(completed("frf hit", 2), "\n") << "the names of files are the shell's";
}

TEST_F(Help, TheManualHasEveryVerbAndOption) {
  const std::string page = robomill("man").out;
  EXPECT_TRUE(page.starts_with(".TH ROBOMILL 1"));
  for (const char* part :
       {".SS frf\n", ".SS couple \\-\\-tools\n", ".SS serve\n", "\\-\\-allow\\-large", "EXIT STATUS"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
}

}  // namespace help_test
}  // namespace robomill::app
