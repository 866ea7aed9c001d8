#include "robomill/jobs/verbs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>

#include "testing/support.hpp"

namespace robomill::jobs {
namespace verbs_test {

using io::Json;
using test::rejection;

const Verb& verb_of(std::string_view name) {
  return *std::ranges::find(verbs(), name, &Verb::name);
}

/// What is said of options, by whoever asks.
std::string rejected(std::string_view verb, AskedBy asked_by, const Json& options) {
  return rejection([&] { static_cast<void>(checked_options(verb_of(verb), asked_by, "a.csv", options)); });
}

TEST(Verbs, HaveCompleteRecords) {
  std::set<std::string_view> names;
  for (const Verb& verb : verbs()) {
    EXPECT_TRUE(names.insert(verb.name).second) << verb.name;
    EXPECT_TRUE(verb.example.starts_with(verb.name.substr(0, verb.name.find(" --")))) << verb.name;
    EXPECT_NE(verb.run, nullptr) << verb.name;
    EXPECT_FALSE(verb.purpose.empty() || verb.readme.empty() || verb.input.meaning.empty()) << verb.name;
    std::set<std::string_view> options = {verb.input.name};
    for (const VerbOption& option : verb.options) {
      EXPECT_TRUE(options.insert(option.name).second) << verb.name << ": " << option.name;
      EXPECT_FALSE(option.meaning.empty()) << verb.name << ": " << option.name;
      EXPECT_EQ(option.takes == Takes::word, !option.words.empty()) << verb.name << ": " << option.name;
    }
    for (const VerbOption& option : verb.options) {
      EXPECT_TRUE(option.needs.empty() || options.contains(option.needs)) << verb.name << ": " << option.name;
    }
  }
}

// One rule for the command line and the page, in the words of each.
TEST(Verbs, OptionsHaveOneRuleWhoeverAsks) {
  const Json seconds = {{"at", {6500, 1}}, {"seconds", 0}};
  EXPECT_EQ(rejected("simulate", AskedBy::command_line, seconds), "--seconds = 0 s; must be > 0");
  EXPECT_EQ(rejected("simulate", AskedBy::request, seconds), "options.seconds = 0 s; must be > 0");
  const Json band = {{"band_hz", {5}}};
  EXPECT_EQ(rejected("modes", AskedBy::command_line, band), "--band = [5]; must be a list of 2 numbers");
  EXPECT_EQ(rejected("modes", AskedBy::request, band), "options.band_hz = [5]; must be a list of 2 numbers");
  const Json peaks = {{"peaks_hz", {300, -4}}, {"rpm", 6500}, {"teeth", 3}};
  EXPECT_EQ(rejected("explain", AskedBy::command_line, peaks), "--peaks = -4 Hz; must be > 0 and <= 1000000");
  EXPECT_EQ(rejected("forces", AskedBy::request, {{"posture_deg", {0, 1}}}),
            "options.posture_deg: goes with options.program");
  EXPECT_NE(rejected("lobes", AskedBy::command_line, {{"at", {{0.01, 1}}}}).find("--at = 0.01 rpm; must be at least 1"),
            std::string::npos);
  EXPECT_NE(rejected("modes", AskedBy::request, {{"modes", 1001}}).find("must be >= 1 and <= 1000"), std::string::npos);
}

TEST(Verbs, ErrorsAboutMembersAreAboutOptions) {
  const VerbJob job{.verb = verb_of("modes --cell"), .asked_by = AskedBy::command_line};
  const InvalidInput angle =
      job.about_option(InvalidInput("joints[3]", 2.0, "rad", "must be less"), "joints", "joints_deg", 0.5);
  EXPECT_EQ(std::string(angle.what()), "--joints[3] = 4 deg; must be less");
  const InvalidInput other = job.about_option(InvalidInput("joints_x", "is wrong"), "joints", "joints_deg", 0.5);
  EXPECT_EQ(std::string(other.what()), "joints_x: is wrong");
}

}  // namespace verbs_test
}  // namespace robomill::jobs
