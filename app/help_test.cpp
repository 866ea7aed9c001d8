// What the program says of itself, and of arguments that it cannot take.
#include <gtest/gtest.h>

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

// Its files are missing, so that it ends with 1; with 2 it would where a word of it is not known.
TEST_F(Help, EveryVerbShowsAnExampleThatParsesAndItsDocumentation) {
  std::vector<std::string> verbs;
  collect({}, verbs);
  EXPECT_GE(verbs.size(), 15U);
  for (const std::string& verb : verbs) {
    const std::string help = robomill(verb + " --help").out;
    const std::string example = behind("Example: robomill ", help);
    EXPECT_TRUE(example.starts_with(verb + " ")) << verb << ": app/help.hpp has no example\n" << help;
    EXPECT_EQ(robomill(example + " </dev/null").exit, 1) << example;
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
      {"modes tip.uff --modes -3", "--modes: must be a whole number ≥ 1, not \"-3\""},
      {"modes tip.uff --modes 2.5", "--modes: must be a whole number ≥ 1, not \"2.5\""},
      {"modes tip.uff --modes 99999999999", "--modes: must be a whole number ≥ 1"},
      {"modes tip.uff --band 5,many", "--band: must be a number, not \"many\""},
      {"lobes lobes.toml --threads 0", "--threads: must be a whole number ≥ 1, not \"0\""},
      {"lobes lobes.toml --seed -1", "--seed: must be a whole number ≥ 0, not \"-1\""},
      {"explain --peaks 300,x --rpm 6500 --teeth 3 --modes m.json", "--peaks: must be a number, not \"x\""},
      {"explain --peaks 300 --rpm fast --teeth 3 --modes m.json", "--rpm: must be a number, not \"fast\""},
      {"explain --peaks 300 --rpm 6500 --teeth 0 --modes m.json", "--teeth: must be a whole number ≥ 1, not \"0\""},
      {"simulate lobes.toml --at 6500,1 --seconds inf", "--seconds: must be a number, not \"inf\""},
      {"coefficients slots.csv --teeth 101", "--teeth: must be a whole number from 1 to 100, not \"101\""},
      {"monitor m.toml --metrics-port 65536", "--metrics-port: must be a whole number from 0 to 65535"},
      {"monitor m.toml --seconds 0", "--seconds: must be a number > 0, not \"0\""}};
  for (const auto& [arguments, expected] : cases) {
    const Ended ended = robomill(arguments);
    EXPECT_EQ(ended.exit, 2) << arguments;
    EXPECT_NE(ended.err.find(expected), std::string::npos) << ended.err;
    std::istringstream rows(ended.err);
    for (std::string row; std::getline(rows, row);) EXPECT_LE(row.size(), 120U) << row;
  }
}

}  // namespace help_test
}  // namespace robomill::app
