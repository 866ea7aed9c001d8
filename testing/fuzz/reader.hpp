#pragma once
// The readers of bytes that come from outside, each as a fuzzer calls it.
#include <span>
#include <string_view>

namespace robomill::fuzz {

/// A reader of bytes. It returns whether it accepts them or rejects them with InvalidInput. Anything else that it
/// throws, and a result that breaks what the reader promises, is a fault.
struct Reader {
  std::string_view name;  ///< of its folder in corpus/ and of its program, fuzz_NAME
  void (*read)(std::string_view bytes);
};

/// Every reader.
[[nodiscard]] std::span<const Reader> readers();

// By kind of bytes, in the files of these names.
[[nodiscard]] std::span<const Reader> record_readers();
[[nodiscard]] std::span<const Reader> document_readers();
[[nodiscard]] std::span<const Reader> program_readers();
[[nodiscard]] std::span<const Reader> service_readers();

}  // namespace robomill::fuzz
