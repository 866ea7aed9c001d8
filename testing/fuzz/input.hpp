#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::fuzz {

/// The bytes as the only file of a folder in memory, gone with the process. No other file can be read from then on.
[[nodiscard]] const std::filesystem::path& file_of(std::string_view bytes, std::string_view ending);

/// The folder of these files.
[[nodiscard]] const std::filesystem::path& folder();

/// How the bytes are to be read stands in their first line: that line without its end, and the bytes below it.
struct Labelled {
  std::string_view label, bytes;
};
[[nodiscard]] Labelled labelled(std::string_view bytes);

/// Stops the process where a promise is broken: a fuzzer keeps the bytes.
void require(bool holds, const char* promise);

/// Reads; InvalidInput is an answer.
template <class Read>
void accept_or_reject(Read&& read) {
  try {
    std::forward<Read>(read)();
  } catch (const InvalidInput& error) {
    require(!std::string_view(error.what()).empty(), "a rejection says what is wrong");
  }
}

}  // namespace robomill::fuzz
