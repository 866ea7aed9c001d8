#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace robomill {

/// SHA-256 of bytes, texts and numbers in the order in which they are added. A text counts with its length, a number by
/// its bits: 0 and -0 differ.
/// Source: [FIPS180-4] 5.1.1, 6.2
class Digest {
 public:
  void bytes(std::string_view content);
  void text(std::string_view content);
  void number(double value);
  void count(std::uint64_t value);
  /// 64 hexadecimal digits. Nothing is added afterwards.
  [[nodiscard]] std::string hex();

 private:
  void block(const unsigned char* bytes);

  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> waiting_ = {};  ///< bytes of a block that is not full
  std::uint64_t length_ = 0;                    ///< bytes added
};

/// Of one text. @return as Digest::hex
[[nodiscard]] std::string digest_of(std::string_view content);

}  // namespace robomill
