#pragma once
#include <cstddef>

/// Eight points at a time: every arithmetic step of a kernel is done for the eight lanes of its operands. Lanes never
/// meet and nothing is contracted (-ffp-contract=off), so that each lane has the same bits whatever vectors the machine
/// has.
namespace robomill {

inline constexpr std::size_t lane_count = 8;

struct alignas(8 * lane_count) Lanes {
  double v[lane_count];
};

/// What the kernels run on.
enum class Kernels { baseline, avx2, avx512 };
/// The best that this machine has.
Kernels best_kernels();
/// What runs now; the best at first.
Kernels& kernels();

/// `width` lanes of a Lanes, as what the compiler keeps in one register.
template <std::size_t width>
struct Register {
  typedef double Type __attribute__((vector_size(8 * width), may_alias));
};

#define ROBOMILL_KERNEL_CORE \
  template <class V>         \
  __attribute__((always_inline)) inline

/// Defines function(a) that runs function_core<V>(a, offset), inlined into a variant for each instruction set, for the
/// lanes offset, offset + 1, … that a register V holds.
#if defined(__x86_64__)
#define ROBOMILL_KERNEL_VARIANT(variant, width, function, Arguments)                                      \
  static void function##_##variant(Arguments& a) {                                                        \
    for (std::size_t at = 0; at < lane_count; at += width) function##_core<Register<width>::Type>(a, at); \
  }
#define ROBOMILL_KERNEL(function, Arguments)                                                          \
  ROBOMILL_KERNEL_VARIANT(baseline, 2, function, Arguments)                                           \
  __attribute__((target("avx2"))) ROBOMILL_KERNEL_VARIANT(avx2, 4, function, Arguments)               \
      __attribute__((target("avx512f"))) ROBOMILL_KERNEL_VARIANT(avx512, 8, function, Arguments) void \
      function(Arguments& a) {                                                                        \
    switch (kernels()) {                                                                              \
      case Kernels::avx512:                                                                           \
        return function##_avx512(a);                                                                  \
      case Kernels::avx2:                                                                             \
        return function##_avx2(a);                                                                    \
      default:                                                                                        \
        return function##_baseline(a);                                                                \
    }                                                                                                 \
  }
#else
#define ROBOMILL_KERNEL(function, Arguments)                                                      \
  void function(Arguments& a) {                                                                   \
    for (std::size_t at = 0; at < lane_count; at += 2) function##_core<Register<2>::Type>(a, at); \
  }
#endif

}  // namespace robomill
