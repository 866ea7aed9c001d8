#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace robomill::program {

/// A language of machines or robots that no reader here knows.
struct UnreadDialect {
  std::size_t line = 0;    ///< from 1, where it shows
  std::string shown = {};  ///< what shows it there: "BEGIN PGM"
  std::string_view rule = {}, hint = {};
};

/// Recognises Klartext, Sinumerik, KRL, TP, RAPID, Inform, URScript and cutter locations under another name by what
/// their lines say; where the ending says the same, weaker signs do. None for what may be G-code.
/// @param ending  of the file's name, in lower case: ".mpf"
/// @param head    the begin of the text; the first 400 lines are looked at
[[nodiscard]] std::optional<UnreadDialect> unread_dialect(std::string_view ending, std::string_view head);

}  // namespace robomill::program
