#pragma once
// Counts what a test program takes from the heap. operator new and Eigen both end in
// malloc, which this replaces; under a sanitizer, which brings its own, nothing is counted.
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ROBOMILL_OWN_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define ROBOMILL_OWN_MALLOC 0
#endif
#endif
#ifndef ROBOMILL_OWN_MALLOC
#define ROBOMILL_OWN_MALLOC 1
#endif

namespace robomill::test {

inline thread_local std::size_t taken = 0;

/// Allocations of this thread while f runs; 0 where they cannot be counted.
template <class F>
std::size_t allocations(F&& f) {
  const std::size_t before = taken;
  f();
  return taken - before;
}

}  // namespace robomill::test

#if ROBOMILL_OWN_MALLOC
extern "C" void* __libc_malloc(std::size_t size);  // NOLINT: glibc's name
extern "C" __attribute__((visibility("default"), weak)) void* malloc(std::size_t size) {
  ++robomill::test::taken;
  return __libc_malloc(size);
}
#endif
