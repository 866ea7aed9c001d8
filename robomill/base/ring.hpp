#pragma once
#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// A queue of bounded room between one thread that writes and one that reads; wait-free on both sides, nothing is
/// allocated after construction.
///
/// Entries are counted from the first ever written. The writer fills slots with put() and hands them over together
/// with publish(), a store with release order; the reader's end() loads with acquire order, so that what lies before
/// it is seen whole. The reader gives slots back with drop_before(), and the writer's room() sees that in the same way.
template <class T>
class Ring {
 public:
  /// @param capacity  rounded up to a power of two
  explicit Ring(std::size_t capacity) : slots_(std::bit_ceil(capacity)) {}

  /// Entries that can be put. Writer only, as the next four.
  [[nodiscard]] std::size_t room() const noexcept {
    return slots_.size() - (written_ - begin_.load(std::memory_order_acquire));
  }
  /// Needs room.
  void put(const T& entry) noexcept { slots_[written_++ & (slots_.size() - 1)] = entry; }
  void publish() noexcept { end_.store(written_, std::memory_order_release); }
  [[nodiscard]] std::size_t written() const noexcept { return written_; }
  /// What was put, until the reader has given its slot back and it is filled anew.
  [[nodiscard]] const T& put_at(std::size_t index) const noexcept { return slots_[index & (slots_.size() - 1)]; }

  /// The one after the last that can be read. Reader only, as the next two.
  [[nodiscard]] std::size_t end() const noexcept { return end_.load(std::memory_order_acquire); }
  [[nodiscard]] const T& operator[](std::size_t index) const noexcept { return slots_[index & (slots_.size() - 1)]; }
  void drop_before(std::size_t index) noexcept { begin_.store(index, std::memory_order_release); }

  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

 private:
  std::vector<T> slots_;
  // On cache lines of their own, so that the threads do not wait for each other's.
  alignas(64) std::size_t written_ = 0;
  alignas(64) std::atomic<std::size_t> end_{0};
  alignas(64) std::atomic<std::size_t> begin_{0};
};

}  // namespace robomill
