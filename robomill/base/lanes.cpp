#include "robomill/base/lanes.hpp"

namespace robomill {

Kernels best_kernels() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return Kernels::avx512;
  if (__builtin_cpu_supports("avx2")) return Kernels::avx2;
#endif
  return Kernels::baseline;
}

Kernels& kernels() {
  static Kernels chosen = best_kernels();
  return chosen;
}

}  // namespace robomill
