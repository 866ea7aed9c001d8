// Every fault at every call of every verb and ending: a table, and the command of each failure.
//   fault_table [--tenths N] [--verb VERB]     (N = 10: all of them)
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "testing/faults/judge.hpp"

namespace robomill::faults {
namespace {

struct Row {
  int runs = 0, complete = 0, kept = 0;
  std::array<int, finding_count> found = {};
};

void count(Row& row, const Judgement& judgement) {
  ++row.runs;
  if (judgement.findings.empty()) ++(judgement.complete ? row.complete : row.kept);
  for (std::size_t i = 0; i < finding_count; ++i) {
    if (std::ranges::find(judgement.findings, static_cast<Finding>(i)) != judgement.findings.end()) ++row.found.at(i);
  }
}

void print_head() {
  std::printf("| verb | ending | fault | runs | new | old |");
  for (const char* name : finding_names) std::printf(" %s |", name);
  std::printf("\n|---|---|---|---|---|---|");
  for (std::size_t i = 0; i < finding_count; ++i) std::printf("---|");
  std::printf("\n");
}

void print(const Row& row, const char* verb, const char* ending, const char* fault) {
  std::printf("| %s | %s | %s | %d | %d | %d |", verb, ending, fault, row.runs, row.complete, row.kept);
  for (const int number : row.found) std::printf(number > 0 ? " **%d** |" : " %d |", number);
  std::printf("\n");
  std::fflush(stdout);
}

/// A failure of each kind of its own, with a call that shows it.
class Failures {
 public:
  void add(const Case& which, const Judgement& judgement) {
    const auto kind = static_cast<std::size_t>(judgement.fault.kind);
    const auto call = static_cast<std::size_t>(judgement.outcome.call);
    const std::string key = std::string(which.arguments) + ", " + kind_names.at(kind) + " at " + call_names.at(call) +
                            ": " + judgement.text.substr(0, judgement.text.find(':'));
    auto& [number, text] = seen_[key];
    if (number++ > 0) return;
    text = "call " + std::to_string(judgement.fault.n) + ", " + judgement.outcome.file + ", exit " +
           std::to_string(judgement.outcome.exit) + ": " + judgement.text;
  }
  void add_unsynced(const Case& which) { seen_[std::string(which.arguments) + ", loss of power"].first = 1; }
  void print() const {
    std::printf("\n");
    for (const auto& [key, value] : seen_) {
      std::printf("- robomill %s (%d)\n  %s\n", key.c_str(), value.first, value.second.c_str());
    }
  }
  [[nodiscard]] bool empty() const { return seen_.empty(); }

 private:
  std::map<std::string, std::pair<int, std::string>> seen_;
};

void run_case(Place& place, const Case& which, int tenths, Failures& failures) {
  Judge judge(place, which);
  std::array<Row, kind_count> rows;
  for (const Fault& fault : some_of(judge.faults(), tenths, 1)) {
    const Judgement judgement = judge.run(fault);
    count(rows.at(static_cast<std::size_t>(fault.kind)), judgement);
    if (!judgement.findings.empty()) failures.add(which, judgement);
  }
  for (std::size_t i = 0; i < kind_count; ++i) {
    if (rows.at(i).runs > 0) print(rows.at(i), which.verb, which.ending, kind_names.at(i));
  }
  Row full;
  if (which.is(to_stdout)) {
    const Judgement judgement = judge.run_onto_full_device();
    count(full, judgement);
    if (!judgement.findings.empty()) failures.add(which, judgement);
    print(full, which.verb, which.ending, "/dev/full");
  }
  const Outcome& whole = judge.undisturbed();
  if (whole.unsynced_files + whole.unsynced_folders > 0) failures.add_unsynced(which);
  std::printf("| %s | %s | loss of power | unsynced: %d files, %d folders |\n", which.verb, which.ending,
              static_cast<int>(whole.unsynced_files), static_cast<int>(whole.unsynced_folders));
}

int run(int count, char** words) {
  int tenths = 10;
  std::string verb;
  for (int i = 1; i + 1 < count; i += 2) {
    if (std::strcmp(words[i], "--tenths") == 0) tenths = std::atoi(words[i + 1]);
    if (std::strcmp(words[i], "--verb") == 0) verb = words[i + 1];
  }
  const char* program = std::getenv("ROBOMILL_FAULT_PROGRAM");
  const std::filesystem::path base =
      std::filesystem::temp_directory_path() / ("fault_table_" + std::to_string(::getpid()));
  Place place({.robomill = program != nullptr ? program : ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, base);
  Failures failures;
  print_head();
  for (const Case& which : all_cases()) {
    if (!verb.empty() && verb != which.verb) continue;
    try {
      run_case(place, which, tenths, failures);
    } catch (const std::exception& error) {
      std::printf("| %s | %s | %s |\n", which.verb, which.ending, error.what());
    }
  }
  failures.print();
  std::filesystem::remove_all(base);
  return failures.empty() ? 0 : 1;
}

}  // namespace
}  // namespace robomill::faults

int main(int count, char** words) {
  return robomill::faults::run(count, words);
}
