// A program of libFuzzer for the reader that its name ends with: fuzz_uff.
#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "testing/fuzz/reader.hpp"

namespace {

const robomill::fuzz::Reader* chosen = nullptr;

/// Where a library dies of a damaged file in a child process, that is an answer and no finding: the child dies by the
/// signal alone.
void die_by_signals() {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) ::signal(signal, SIG_DFL);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(const int* /*count*/, char*** words) {
  const std::string program = std::filesystem::path((*words)[0]).filename().string();
  for (const robomill::fuzz::Reader& reader : robomill::fuzz::readers()) {
    if (program == "fuzz_" + std::string(reader.name)) chosen = &reader;
  }
  if (chosen == nullptr) {
    std::fprintf(stderr, "%s: the program's name must be fuzz_READER, of a reader in testing/fuzz\n", program.c_str());
    std::exit(2);
  }
  ::pthread_atfork(nullptr, nullptr, die_by_signals);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  chosen->read({reinterpret_cast<const char*>(bytes), count});
  return 0;
}
