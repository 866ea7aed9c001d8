#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace robomill::io {

// Numbers and texts one behind the other, between programs of one machine or of machines with one order of bytes.

inline void pack_number(std::string& out, std::uint64_t number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

/// Its length, then its bytes.
inline void pack_text(std::string& out, std::string_view text) {
  pack_number(out, text.size());
  out += text;
}

/// Without their count.
inline void pack_values(std::string& out, std::span<const double> values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// Takes them off again, in their order. Any bytes may come. @throws std::length_error where they end too soon
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  std::uint64_t number() {
    std::uint64_t out = 0;
    std::memcpy(&out, take(sizeof(out)).data(), sizeof(out));
    return out;
  }
  std::string text() { return std::string(take(number())); }
  /// @param to  as long as there are values
  void values(std::span<double> to) {
    const std::string_view bytes = take(to.size_bytes());
    if (!to.empty()) std::memcpy(to.data(), bytes.data(), bytes.size());
  }
  /// @throws std::length_error where so many items of a size cannot stand in what is left: before memory is taken
  void require(std::uint64_t count, std::size_t bytes_each) const {
    if (count > rest_.size() / bytes_each) throw std::length_error("more than it has");
  }

 private:
  std::string_view take(std::uint64_t count) {
    if (count > rest_.size()) throw std::length_error("less than it says");
    const std::string_view out = rest_.substr(0, static_cast<std::size_t>(count));
    rest_.remove_prefix(out.size());
    return out;
  }

  std::string_view rest_;
};

}  // namespace robomill::io
