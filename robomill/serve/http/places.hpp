#pragma once
#include <algorithm>
#include <cstddef>
#include <map>
#include <string>

// Method: robomill/serve/README.md, "HTTP"

namespace robomill::serve {

/// Who may have one more connection: an address has three quarters of the places at most, and the last eighth is for
/// clients that prove by their first header that they may ask; also of an address that has all of its share, since all
/// clients of a proxy, and of this machine, have one.
class Places {
 public:
  enum class Place { none, usual, reserved };

  explicit Places(std::size_t all)
      : usual_(all - all / 8),
        reserved_(all / 8),
        of_an_address_(std::max<std::size_t>(1, 3 * all / 4)),
        reserved_of_an_address_(std::max<std::size_t>(1, reserved_ / 4)) {}

  /// @param address  of the client
  [[nodiscard]] Place take(const std::string& address) {
    const auto [held, is_new] = held_.try_emplace(address);
    const Place place = free_place(held->second);
    if (place == Place::none) {
      if (is_new) held_.erase(held);
      return place;
    }
    ++taken_by(held->second, place);
    ++taken_by(all_, place);
    return place;
  }
  /// What take() gave.
  void leave(const std::string& address, Place place) {
    const auto held = held_.find(address);
    if (held == held_.end() || place == Place::none) return;
    --taken_by(held->second, place);
    --taken_by(all_, place);
    if (held->second.usual + held->second.reserved == 0) held_.erase(held);
  }

 private:
  struct Taken {
    std::size_t usual = 0, reserved = 0;
  };
  static std::size_t& taken_by(Taken& taken, Place place) {
    return place == Place::usual ? taken.usual : taken.reserved;
  }
  [[nodiscard]] Place free_place(const Taken& of_address) const {
    if (all_.usual < usual_ && of_address.usual < of_an_address_) return Place::usual;
    const bool free = all_.reserved < reserved_ && of_address.reserved < reserved_of_an_address_;
    return free ? Place::reserved : Place::none;
  }

  std::size_t usual_, reserved_, of_an_address_, reserved_of_an_address_;
  Taken all_;
  std::map<std::string, Taken> held_;  ///< by address, of those that hold any
};

}  // namespace robomill::serve
