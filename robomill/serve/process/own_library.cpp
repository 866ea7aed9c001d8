#include "robomill/serve/process/own_library.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <unistd.h>

#include <cstdlib>

#include "robomill/io/system/descriptor.hpp"
#include "robomill/io/system/sanitized.hpp"

namespace robomill::serve {
namespace {

constexpr const char* preload = "LD_PRELOAD";

int open_own_library() noexcept {
  if (io::sanitized) return -1;  // AddressSanitizer insists on being loaded first
  Dl_info info = {};
  link_map* map = nullptr;
  const auto address = reinterpret_cast<const void*>(&open_own_library);
  if (::dladdr1(address, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0 || map == nullptr) return -1;
  if (*map->l_name == '\0') return -1;  // the program itself has no name in this list
  int error = 0;
  const io::Descriptor file = io::open_descriptor(map->l_name, O_RDONLY | O_CLOEXEC, error);
  // Above the descriptors that a process starts with: what is copied to those must not replace it.
  constexpr int above_all_given = 16;
  return error != 0 ? -1 : ::fcntl(file.get(), F_DUPFD_CLOEXEC, above_all_given);
}

}  // namespace

int own_library() noexcept {
  static const int descriptor = open_own_library();
  return descriptor;
}

std::string preload_variable(int descriptor) {
  return std::string(preload) + "=/proc/self/fd/" + std::to_string(descriptor);
}

void forget_preload(int descriptor) noexcept {
  if (std::getenv(preload) == nullptr) return;
  ::unsetenv(preload);
  ::close(descriptor);
}

}  // namespace robomill::serve
