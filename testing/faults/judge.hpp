#pragma once
// What a run with a fault must have left behind.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "testing/faults/cases.hpp"
#include "testing/faults/run.hpp"

namespace robomill::faults {

/// What is wrong with how a run ended.
enum class Finding : unsigned char {
  exit,           ///< neither 0 nor 1: a signal ended it, it hung, or it took the fault for a result
  silent,         ///< exit 0, and an output is not the new one
  lost,           ///< an output is neither what it was nor the new one
  mixed,          ///< of documents that belong together some are old and some new
  leftover,       ///< a file that is no output
  input_changed,  ///< an input is not what it was
  message,        ///< not one line on standard error that begins with robomill:
  not_survived    ///< EINTR or a short write made it fail; after kill -9 the next run did
};
constexpr std::size_t finding_count = 8;
constexpr std::array<const char*, finding_count> finding_names = {"other exit", "exit 0, wrong output", "old file lost",
                                                                  "mixed",      "left beside",          "input changed",
                                                                  "no message", "not survived"};

struct Judgement {
  Fault fault;
  Outcome outcome;
  bool complete = false;  ///< the new result is there
  std::vector<Finding> findings;
  std::string text;  ///< the findings with what was seen
};

/// A case, run once undisturbed, with what it must leave.
class Judge {
 public:
  /// @throws std::runtime_error if the undisturbed run fails, or two of them differ
  Judge(Place& place, const Case& which);

  [[nodiscard]] const Outcome& undisturbed() const { return undisturbed_; }
  /// A run with a fault at one call.
  [[nodiscard]] Judgement run(const Fault& fault);
  /// A run whose standard output is a device that is full.
  [[nodiscard]] Judgement run_onto_full_device();
  /// A run that is killed after a share, 0 to 1, of the time that an undisturbed one takes.
  [[nodiscard]] Judgement run_killed(double share);
  /// Every fault: every call of every kind, fifty allocations.
  [[nodiscard]] std::vector<Fault> faults() const;

 private:
  void look(Judgement& judgement, bool compares_stdout);
  void look_at_files(Judgement& judgement) const;
  void look_at_next_run(Judgement& judgement);

  Place& place_;
  Case case_;
  Files before_, after_;
  Outcome undisturbed_;
  double undisturbed_s_ = 0.0;
};

/// A tenth of them, or so many tenths, at least one a kind.
[[nodiscard]] std::vector<Fault> some_of(const std::vector<Fault>& faults, int tenths, std::uint64_t seed);

}  // namespace robomill::faults
