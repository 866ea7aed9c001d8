#include "robomill/io/records/child_reading.hpp"

#include <fmt/format.h>
#include <sys/mman.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/system/child.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {
namespace {

/// Beyond what is in use already and what the file's size asks for [bytes].
constexpr std::size_t most_memory = std::size_t{64} << 20;

/// To read a file in; a second more a megabyte.
constexpr std::chrono::seconds shortest_time(10);

/// How the child's answer begins.
constexpr char answered = '+', rejected = '-';

}  // namespace

std::mutex& mat_library() {
  static std::mutex mutex;
  return mutex;
}

bool is_hdf5(std::string_view content) {
  constexpr std::size_t version = 124;
  const std::string_view words = content.size() < 128 ? std::string_view() : content.substr(version, 4);
  return words == std::string_view("\0\2IM", 4) || words == std::string_view("\2\0MI", 4) ||
         content.starts_with("\x89HDF\r\n\x1a\n");
}

std::string read_in_child(
    const std::filesystem::path& path, const std::string& content, const ChildReading& how,
    const std::function<std::string(const std::string& content, const std::string& place)>& read) {
  const std::size_t file_bytes = content.size();
  // What matio cannot read it takes for zeros: it gets the file from memory, into which all of it was read.
  const Descriptor memory(how.by_name ? ::memfd_create("robomill", MFD_CLOEXEC) : -1);
  const std::string place = fmt::format("/proc/self/fd/{}", memory.get());
  if (how.by_name && write_all(memory.get(), content) != 0) {
    throw InvalidInput(path.string(), "cannot be read", "Is there enough memory?");
  }
  const std::lock_guard lock(mat_library());
  const auto in_child = [&]() -> std::string {
    try {
      return answered + read(content, place);
    } catch (const InvalidInput& error) {
      return rejected + error.parts().rule + '\n' + error.parts().hint;
    }
  };
  const ChildLimits limits = {.more_memory_bytes = most_memory + 64 * file_bytes,
                              .time = shortest_time + std::chrono::milliseconds(file_bytes / 1000),
                              .lent = memory.get(),
                              .more_files = how.by_name ? 1 : 0};
  std::optional<std::string> answer = run_in_child(limits, in_child);
  if (!answer || answer->empty()) throw InvalidInput(path.string(), how.fault);
  if (answer->front() == rejected) {
    const std::size_t hint = answer->find('\n');
    throw InvalidInput(path.string(), answer->substr(1, hint - 1), answer->substr(hint + 1));
  }
  answer->erase(0, 1);
  return *std::move(answer);
}

}  // namespace robomill::io
