#pragma once
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/io/json.hpp"

// Method: robomill/serve/README.md, "Jobs"

namespace robomill::serve {

/// What stands in the request for an option of a verb.
enum class Takes {
  flag,        ///< true, false
  whole,       ///< a whole number
  number,      ///< a number
  numbers,     ///< a list of them
  texts,       ///< a list of texts
  word,        ///< one of some words
  file,        ///< a path
  files,       ///< a list of paths
  new_file,    ///< a path that is written
  new_folder,  ///< …
  point,       ///< [spindle speed in rpm, depth in mm]
  points       ///< a list of them
};
inline constexpr Name<Takes> takes_names[] = {{"flag", Takes::flag},         {"whole", Takes::whole},
                                              {"number", Takes::number},     {"numbers", Takes::numbers},
                                              {"texts", Takes::texts},       {"word", Takes::word},
                                              {"file", Takes::file},         {"files", Takes::files},
                                              {"new_file", Takes::new_file}, {"new_folder", Takes::new_folder},
                                              {"point", Takes::point},       {"points", Takes::points}};

/// An option as a verb declares it.
struct VerbOption {
  std::string_view name = {};  ///< as the command line has it, with its unit: "band_hz"
  std::string_view does = {};  ///< a label, with its unit
  Takes takes = Takes::flag;
  bool required = false;
  std::vector<std::string_view> words = {};                    ///< of a word
  std::vector<std::string_view> kinds = {};                    ///< of a file: what the page proposes
  std::size_t count = 0;                                       ///< of numbers; 0: as many as there are
  double above = -std::numeric_limits<double>::infinity();     ///< a number is greater …
  double at_least = -std::numeric_limits<double>::infinity();  ///< … and no less; of whole numbers too
  double at_most = std::numeric_limits<double>::infinity();
};

template <class Value, std::size_t n>
[[nodiscard]] std::vector<std::string_view> words_of(const Name<Value> (&names)[n]) {
  std::vector<std::string_view> words;
  for (const auto& [word, value] : names) words.push_back(word);
  return words;
}

/// The options of a request, all of them checked; null ones are left out.
/// @param verb  for messages
/// @param require_inside  throws InvalidInput if a path leads out of the folder
/// @throws InvalidInput naming "options.NAME" if one is unknown, missing or not what it takes
[[nodiscard]] io::Json checked_options(std::string_view verb, const std::vector<VerbOption>& options,
                                       const io::Json& given,
                                       const std::function<void(const std::string&)>& require_inside);

/// An option for the page.
[[nodiscard]] io::Json option_json(const VerbOption& option);

}  // namespace robomill::serve
