// Allocations in place of the C library's, on whose heap they are made. operator new calls malloc.
#include <cerrno>
#include <cstddef>

#include "testing/faults/shim.hpp"

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace robomill::faults {
namespace {

bool fails() noexcept {
  if (!is_at_work() || next(Call::allocate, "").error == 0) return false;
  errno = ENOMEM;
  return true;
}

}  // namespace
}  // namespace robomill::faults

using robomill::faults::fails;

ROBOMILL_INTERPOSED void* malloc(std::size_t size) {
  return fails() ? nullptr : __libc_malloc(size);
}
ROBOMILL_INTERPOSED void* calloc(std::size_t count, std::size_t size) {
  return fails() ? nullptr : __libc_calloc(count, size);
}
ROBOMILL_INTERPOSED void* realloc(void* old, std::size_t size) {
  return fails() ? nullptr : __libc_realloc(old, size);
}
ROBOMILL_INTERPOSED void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
ROBOMILL_INTERPOSED int posix_memalign(void** made, std::size_t alignment, std::size_t size) {
  if (fails()) return ENOMEM;
  *made = __libc_memalign(alignment, size);
  return *made == nullptr ? ENOMEM : 0;
}
