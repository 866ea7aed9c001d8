#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/program/program.hpp"

namespace robomill::program {

/// What the reader of a program left out.
[[nodiscard]] inline const io::Schema<Skipped>& skipped_table() {
  static const io::Schema<Skipped> table(
      "skipped", "what the reader of a program left out",
      {io::key("line", &Skipped::line, "of the program's file"), io::key("what", &Skipped::what, "a word")},
      io::Use::written);
  return table;
}

}  // namespace robomill::program
