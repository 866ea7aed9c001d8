// No number in a document makes its verb take all memory, or hours: it ends with a result or with one message.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/io/text.hpp"
#include "robomill/io/toml/lines.hpp"
#include "test_program.hpp"

namespace robomill::app {
namespace costly_documents_test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;  // their shadow memory fills the address space
#elif defined(__has_feature)
constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool sanitized = false;
#endif

/// A document that `robomill init --example` writes, and the verbs that read it.
struct Kind {
  const char* name;
  std::vector<const char*> runs;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"lobes", {"lobes lobes.toml --at 9000,1 -o made.json", "simulate lobes.toml --at 9000,1 -o made.csv"}},
      {"forces", {"forces forces.toml -o made.csv", "forces forces.toml --program part.ngc -o made.csv"}},
      {"assembly", {"couple assembly.toml -o made.uff", "joint assembly.toml --measured tip.uff -o made.json"}},
      {"hits", {"frf hits.toml -o made.uff"}},
      {"cell", {"cell check cell.toml -o made.json", "smooth part.ngc --cell cell.toml"}},
      {"monitor", {"monitor monitor.toml --input cut.csv -o made.jsonl"}},
      {"job", {"plan job.toml -o made"}},
  };
  return all;
}

/// The numbers of a value, by where they stand in it; none of texts.
std::vector<std::pair<std::size_t, std::size_t>> numbers_in(std::string_view value) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  const auto is = [&](std::size_t i, std::string_view also) {
    return i < value.size() &&
           (std::isalnum(static_cast<unsigned char>(value[i])) != 0 || also.find(value[i]) != std::string_view::npos);
  };
  bool quoted = false;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] == '#' && !quoted) break;
    if (value[i] == '"') quoted = !quoted;
    if (quoted || !is(i, "-+")) continue;
    std::size_t end = i;
    while (is(end, "-+._")) ++end;
    if (io::parse_number(value.substr(i, end - i))) out.emplace_back(i, end - i);
    i = end;
  }
  return out;
}

/// As the document would write it: a whole number stays one.
std::string times(std::string_view number, double factor) {
  const double value = *io::parse_number(number) * factor;
  const bool whole = number.find_first_of(".eE") == std::string_view::npos && value == std::floor(value);
  return whole && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
}

/// A document with one number of it changed.
struct Changed {
  std::string line, text;
};

std::vector<Changed> changed_documents(const std::string& text) {
  std::vector<Changed> out;
  for (const io::TomlLine& line : io::toml_lines(text)) {
    if (line.is_comment) continue;
    const std::size_t value = line.text.find('=') + 1;
    for (const auto& [at, length] : numbers_in(line.text.substr(value))) {
      const std::string_view number = line.text.substr(value + at, length);
      if (*io::parse_number(number) == 0.0) continue;
      for (const double factor : {1e6, 1e-6}) {
        const auto begin = static_cast<std::size_t>(line.text.data() - text.data()) + value + at;
        Changed& one = out.emplace_back(Changed{.line = {}, .text = text});
        one.text.replace(begin, length, times(number, factor));
        const std::size_t from = one.text.rfind('\n', begin) + 1;
        one.line = one.text.substr(from, one.text.find('\n', begin) - from);
      }
    }
  }
  return out;
}

class CostlyDocuments : public ProgramTest {
 protected:
  void SetUp() override {
    // Units that a user would not wait for are no finding here: a trajectory may last some minutes, not a day.
    for (const Kind& kind : kinds()) {
      const std::string file = std::string(kind.name) + ".toml";
      if (test::slurp(folder_.at(file)).empty()) robomill(fmt::format("init {} --example -o {}", kind.name, file));
    }
    std::string cell = test::slurp(folder_.at("cell.toml"));
    cell.insert(cell.find("tip_tolerance_mm"), "max_duration_h = 0.1\n");
    write("cell.toml", cell);
    write("part.ngc",
          "G21 G90 G94\nG0 X0 Y0 Z20\nS9000 M3\nG1 Z-1 F300\nG1 X60 F900\nG1 X60 Y30\nG1 X0 Y30\nG2 X0 Y0 I0 J-15\n"
          "G1 X30 Y10 Z-2\nG0 Z20\nM2\n");
    std::string samples = "time_s,ax_m_per_s2\n";
    for (int i = 0; i < 10240; ++i) {
      samples += fmt::format("{:.8f},{:.5f}\n", i / 10240.0, std::sin(0.276 * i) + 0.3 * std::sin(0.092 * i));
    }
    write("cut.csv", samples);
    robomill("couple assembly.toml -o tip.uff --quiet");
  }

  /// What is wrong with how a run ended; empty: nothing.
  std::string fault_of(const std::string& run) {
    const std::string memory = sanitized ? "" : "ulimit -v 3500000; ";
    const Ended ended = shell("rm -rf made made.*; " + memory + "ulimit -t 150; '" ROBOMILL_PROGRAM "' " + run +
                              " --quiet --threads 2");
    if (ended.exit != 0 && ended.exit != 1 && ended.exit != 3) return fmt::format("ended with {}", ended.exit);
    if (ended.exit != 1) return {};
    const std::size_t at = ended.err.find("robomill: ");
    if (at == std::string::npos) return "says nothing";
    if (ended.err.find("robomill: ", at + 1) != std::string::npos) return "says more than one thing: " + ended.err;
    if (ended.err.find("not enough memory") != std::string::npos) return "took all memory";
    return {};
  }
};

TEST_F(CostlyDocuments, OneNumberAMillionTimesLargerOrSmallerEndsSoon) {
  struct Case {
    const Kind* kind;
    Changed document;
    const char* run;
  };
  std::vector<Case> cases;
  for (const Kind& kind : kinds()) {
    const std::string text = test::slurp(folder_.at(std::string(kind.name) + ".toml"));
    for (const Changed& document : changed_documents(text)) {
      for (const char* const run : kind.runs) cases.push_back({&kind, document, run});
    }
  }
  ASSERT_GE(cases.size(), 200U);
  // Evenly over all kinds.
  const std::size_t all = cases.size(), wanted = static_cast<std::size_t>(test::seeds(static_cast<int>(all)));
  for (std::size_t i = 0; i < wanted; ++i) {
    const Case& one = cases[i * all / wanted];
    const std::string file = std::string(one.kind->name) + ".toml";
    const std::string before = test::slurp(folder_.at(file));
    write(file, one.document.text);
    EXPECT_EQ(fault_of(one.run), "") << one.run << " with " << one.document.line;
    write(file, before);
  }
}

TEST_F(CostlyDocuments, WhatWouldTakeHoursIsTakenWhereItIsAskedFor) {
  std::string text = test::slurp(folder_.at("lobes.toml"));
  const std::string_view range = "spindle_speed_rpm = [4000, 16000]", method = "# method = \"collocation\"";
  ASSERT_NE(text.find(range), std::string::npos);
  ASSERT_NE(text.find(method), std::string::npos);
  text.replace(text.find(method), method.size(), "method = \"multi-frequency\"");
  text.replace(text.find(range), range.size(), "spindle_speed_rpm = [2, 4]");
  write("lobes.toml", text);
  const Ended rejected = robomill("lobes lobes.toml --quiet");
  EXPECT_EQ(rejected.exit, 1);
  EXPECT_NE(rejected.err.find("lobes.spindle_speed_rpm = 2 rpm; would take about "), std::string::npos) << rejected.err;
  EXPECT_NE(rejected.err.find("more than 10 min"), std::string::npos) << rejected.err;
  EXPECT_TRUE(rejected.err.ends_with("Change this number; if it is meant, --allow-large takes it\n")) << rejected.err;
  EXPECT_EQ(robomill("simulate lobes.toml --at 9000,1 --seconds 1e20 --allow-large --quiet").err,
            "robomill: --seconds = 1e+20 s; must be at most 1e7 s. No cut takes a hundred days\n");
  EXPECT_EQ(
      shell("timeout -s INT 1 '" ROBOMILL_PROGRAM "' lobes lobes.toml --quiet --allow-large; echo $? >ended; true")
          .exit,
      0);
  const std::string ended = test::slurp(folder_.at("ended"));
  EXPECT_TRUE(ended == "124\n" || ended == "130\n") << ended;
}

TEST_F(CostlyDocuments, ASpindleSpeedThatNoSpindleHasSaysSo) {
  write("modes.toml",
        "[[modes]]\nfrequency_hz = 620\ndamping_ratio = 0.03\nleft = { x = [1, 0] }\nright = { x = [1, 0] }\n");
  const std::string explain = "explain --peaks 625 --teeth 3 --modes modes.toml --rpm ";
  EXPECT_EQ(robomill(explain + "1e9").err,
            "robomill: --rpm = 1e+09 rpm; must be at most 1,000,000 rpm. No spindle is so fast; are the units mixed "
            "up?\n");
  EXPECT_NE(robomill(explain + "0").err.find("--rpm = 0 rpm; must be > 0"), std::string::npos);
  const std::string slow = robomill("lobes lobes.toml --at 0.01,1").err;
  EXPECT_NE(slow.find("--at = 0.01 rpm; must be at least 1 rpm"), std::string::npos) << slow;
}

}  // namespace costly_documents_test
}  // namespace robomill::app
