#include "testing/faults/judge.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <iterator>
#include <set>
#include <stdexcept>

#include "robomill/base/random.hpp"

namespace robomill::faults {
namespace {

constexpr std::uint64_t allocations = 50;  // places of all

void add(Judgement& judgement, Finding finding, const std::string& seen) {
  judgement.findings.push_back(finding);
  judgement.text += std::string(finding_names.at(static_cast<std::size_t>(finding))) + ": " + seen + "\n";
}

bool is_harmless(Kind kind) {
  return kind == Kind::interrupted || kind == Kind::short_write;
}

/// "robomill: ..." and its end.
bool is_one_message(const std::string& text) {
  return text.starts_with("robomill: ") && text.find('\n') == text.size() - 1;
}

std::string described(const std::string& content) {
  return content.empty() ? "empty" : std::to_string(content.size()) + " bytes";
}

bool same_text(const std::string& one, const std::string& other) {
  return one == other || without_times(one) == without_times(other);
}

/// What the monitor says before it goes on without an input or a recording, and who goes on without a kept calibration.
bool says_failed(const std::string& text) {
  return std::ranges::any_of(std::array{"input-failed", "recording-failed", "could not be kept", "is made anew:"},
                             [&](const char* said) { return text.find(said) != std::string::npos; });
}

/// Nothing could be said: kill -9, or a library that ends the program where it has no memory.
bool has_died(const Judgement& judgement) {
  const Outcome& outcome = judgement.outcome;
  if (!outcome.reached || outcome.exit < 128) return false;
  return judgement.fault.kind == Kind::killed ? outcome.exit == 128 + SIGKILL : judgement.fault.kind == Kind::no_memory;
}

/// A temporary file that a killed process could not remove.
bool is_hidden(const std::string& path) {
  return path.substr(path.rfind('/') + 1).starts_with(".");
}

}  // namespace

Judge::Judge(Place& place, const Case& which) : place_(place), case_(which) {
  restore(place_.folder(), inputs_of(which));
  if (which.make_inputs[0] != '\0') {
    const Outcome made = place_.run(which.make_inputs, {}, false);
    if (made.exit != 0) throw std::runtime_error(std::string("inputs: ") + made.err);
  }
  before_ = files_of(place_.folder());
  const Files inputs = before_;
  undisturbed_ = place_.run(which.arguments, {}, which.is(to_stdout));
  if (undisturbed_.exit != 0) throw std::runtime_error(std::string(which.arguments) + ": " + undisturbed_.err);
  after_ = files_of(place_.folder());
  if (!which.is(is_new)) {
    for (const auto& [name, content] : after_) {
      if (!inputs.contains(name)) before_[name] = "an older result\n";
    }
  }
  restore(place_.folder(), before_);
  const auto begin = std::chrono::steady_clock::now();
  const Outcome again = place_.run(which.arguments, {}, which.is(to_stdout));
  undisturbed_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Files files = files_of(place_.folder());
  bool same = again.exit == 0 && files.size() == after_.size();
  if (which.is(to_stdout)) same = same && same_text(again.out, undisturbed_.out);
  for (const auto& [name, content] : after_) same = same && files.contains(name) && same_text(files.at(name), content);
  if (!same) throw std::runtime_error(std::string(which.arguments) + ": two undisturbed runs differ");
  undisturbed_ = again;
}

std::vector<Fault> Judge::faults() const {
  std::vector<Fault> faults;
  for (const Kind kind : all_kinds) {
    if (kind == Kind::no_memory && case_.is(hdf5)) continue;
    const std::uint64_t count = undisturbed_.calls.at(static_cast<std::size_t>(kind));
    // Threads do not allocate as often in each run: the last ones may not be reached.
    const std::uint64_t all = kind == Kind::no_memory ? count - count / 10 : count;
    const std::uint64_t places = kind == Kind::no_memory ? std::min(all, allocations) : all;
    for (std::uint64_t i = 0; i < places; ++i) {
      faults.push_back({kind, places == all ? i + 1 : 1 + i * (all - 1) / (places - 1)});
    }
  }
  return faults;
}

Judgement Judge::run(const Fault& fault) {
  restore(place_.folder(), before_);
  Judgement judgement;
  judgement.fault = fault;
  judgement.outcome = place_.run(case_.arguments, fault, case_.is(to_stdout));
  look(judgement, case_.is(to_stdout));
  return judgement;
}

Judgement Judge::run_onto_full_device() {
  restore(place_.folder(), before_);
  Judgement judgement;
  judgement.fault = {Kind::disk_full, 1};
  judgement.outcome = place_.run_onto(case_.arguments, "/dev/full");
  judgement.outcome.reached = true;
  judgement.outcome.call = Call::print;
  judgement.outcome.file = "/dev/full";
  look(judgement, false);
  judgement.complete = false;
  if (judgement.outcome.exit == 0) add(judgement, Finding::silent, "onto /dev/full");
  return judgement;
}

Judgement Judge::run_killed(double share) {
  restore(place_.folder(), before_);
  Judgement judgement;
  judgement.fault = {Kind::killed, 1};
  judgement.outcome = place_.run_killed(case_.arguments, share * undisturbed_s_);
  judgement.outcome.reached = judgement.outcome.exit == 128 + SIGKILL;
  look(judgement, false);
  return judgement;
}

void Judge::look(Judgement& judgement, bool compares_stdout) {
  const Outcome& outcome = judgement.outcome;
  const Kind kind = judgement.fault.kind;
  look_at_files(judgement);
  const bool went_on = case_.is(goes_on) && says_failed(outcome.out + outcome.err);
  if (compares_stdout && !same_text(outcome.out, undisturbed_.out)) {
    judgement.complete = false;
    if (outcome.exit == 0 && !went_on) add(judgement, Finding::silent, "standard output has " + described(outcome.out));
  }
  if (has_died(judgement)) return look_at_next_run(judgement);
  if (outcome.exit != 0 && outcome.exit != 1) {
    add(judgement, Finding::exit, "exit " + std::to_string(outcome.exit) + ", " + outcome.err);
  }
  const bool says = outcome.exit == 0 ? outcome.err == undisturbed_.err : is_one_message(outcome.err);
  if (!says && !went_on && outcome.exit <= 1) add(judgement, Finding::message, "\"" + outcome.err + "\"");
  if (is_harmless(kind) && outcome.exit != 0) add(judgement, Finding::not_survived, outcome.err);
}

void Judge::look_at_files(Judgement& judgement) const {
  const Files now = files_of(place_.folder());
  const bool marked =
      std::ranges::any_of(now, [](const auto& file) { return file.first.ends_with(".robomill-unfinished"); });
  // A disk that takes nothing any more gives no place back either: then the marker stays, and old files by other names.
  const bool is_stuck = judgement.fault.kind == Kind::disk_lost && marked;
  const bool died = has_died(judgement) || is_stuck;
  bool went_on = case_.is(goes_on) && says_failed(judgement.outcome.out + judgement.outcome.err);
  for (const auto& [name, content] : now) went_on = went_on || (case_.is(goes_on) && says_failed(content));
  const auto holds = [](const Files& files, const std::string& name, const std::string& content) {
    const auto at = files.find(name);
    return at != files.end() && same_text(at->second, content);
  };
  bool all_new = true, all_old = true;
  for (const auto& [name, content] : after_) {
    const auto old = before_.find(name);
    const auto there = now.find(name);
    const std::string seen = name + (there == now.end() ? " is gone" : " has " + described(there->second));
    const bool is_new = holds(now, name, content);
    const bool is_old = old == before_.end() ? there == now.end() : holds(now, name, old->second);
    if (old != before_.end() && old->second == content) {
      if (!is_new) add(judgement, Finding::input_changed, seen);
      continue;
    }
    all_new = all_new && is_new;
    all_old = all_old && is_old;
    // Events and reports of less than there was; no file of samples that is cut off.
    const bool may_differ = went_on && (is_old || !name.ends_with(".wav"));
    if (!is_new && judgement.outcome.exit == 0 && !may_differ) {
      add(judgement, Finding::silent, seen);
    } else if (!is_new && !is_old && !may_differ) {
      add(judgement, Finding::lost, seen);
    }
  }
  judgement.complete = all_new;
  if (case_.is(together) && !all_new && !all_old && !(died && marked)) add(judgement, Finding::mixed, "");
  for (const auto& [name, content] : now) {
    if (after_.contains(name) || before_.contains(name) || (died && is_hidden(name))) continue;
    add(judgement, Finding::leftover, name);
  }
}

/// What a killed run left does not stand in the way of the next one.
void Judge::look_at_next_run(Judgement& judgement) {
  const Outcome next = place_.run(case_.arguments, {}, case_.is(to_stdout));
  const Files now = files_of(place_.folder());
  for (const auto& [name, content] : after_) {
    const auto there = now.find(name);
    // A verb that makes new files rejects those that are there already.
    const bool may = next.exit == 0 || case_.is(is_new);
    if (may && there != now.end() && same_text(there->second, content)) continue;
    return add(judgement, Finding::not_survived, "the next run: exit " + std::to_string(next.exit) + ", " + next.err);
  }
}

std::vector<Fault> some_of(const std::vector<Fault>& faults, int tenths, std::uint64_t seed) {
  if (tenths >= 10) return faults;
  std::vector<Fault> some;
  for (const Kind kind : all_kinds) {
    std::vector<Fault> of_kind;
    std::ranges::copy_if(faults, std::back_inserter(of_kind), [&](const Fault& fault) { return fault.kind == kind; });
    Random random(seed, static_cast<std::uint64_t>(kind));
    const std::size_t wanted = (of_kind.size() * static_cast<std::size_t>(std::max(tenths, 1)) + 9) / 10;
    std::set<std::size_t> chosen;
    while (chosen.size() < wanted) chosen.insert(random.index(of_kind.size()));
    for (const std::size_t i : chosen) some.push_back(of_kind[i]);
  }
  return some;
}

}  // namespace robomill::faults
