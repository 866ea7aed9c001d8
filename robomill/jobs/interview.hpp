#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "robomill/jobs/init.hpp"

namespace robomill::jobs {

/// Questions in shop terms whose answers are put into the documents that robomill init is to write: a value each in its
/// place, comments as they were. Answers have units or none: "0.25 in", "100 mV/g", "12 Nm", "7.5 kW".
class Interview {
 public:
  /// @param files  outlives the interview; a question whose keys none of its documents has is not asked
  Interview(Template kind, InitFiles& files);
  ~Interview();
  Interview(const Interview&) = delete;
  Interview& operator=(const Interview&) = delete;

  /// What is asked next, with its default in brackets; nothing after the last.
  [[nodiscard]] std::optional<std::string> question() const;
  /// An empty answer takes the default.
  /// @throws InvalidInput saying what is wrong with it: the question stays the same
  void answer(std::string_view text);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robomill::jobs
