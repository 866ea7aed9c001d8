#include "robomill/jobs/files/named_files.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/toml/values.hpp"

namespace robomill::jobs {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_path = 1024;
constexpr std::size_t most_documents = 64, most_files = 10'000;  // a job of hits names hundreds
constexpr std::size_t most_bytes = std::size_t{8} << 20;         // of all documents

/// Files in their order, each once.
struct Found {
  std::vector<fs::path> files = {};
  std::set<fs::path> known = {};
};

/// Those of a value that are there and not yet known.
void add_files(const io::Json& value, const fs::path& folder, Found& found) {
  for (const io::Json& one : value.is_array() ? value : io::Json::array({value})) {
    if (one.is_array()) add_files(one, folder, found);
    if (!one.is_string()) continue;
    const auto& text = one.get_ref<const std::string&>();
    if (text.empty() || text.size() > longest_path || text.find('\0') != std::string::npos) continue;
    std::error_code ignored;
    const fs::path path = (folder / text).lexically_normal();
    if (found.known.contains(path) || !fs::is_regular_file(path, ignored)) continue;
    if (found.files.size() == most_files) {
      throw InvalidInput("input", fmt::format("names more than {} files", most_files));
    }
    found.known.insert(path);
    found.files.push_back(path);
  }
}

/// None where it is missing, outside or no TOML: the job says so.
/// @param bytes  of the text are added
std::vector<io::TomlValue> values_of(const fs::path& path, Unreadable unreadable, std::size_t& bytes) {
  bool is_read = false;
  try {
    const std::string text = io::read_file(path, longest_document);
    is_read = true;
    bytes += text.size();
    return io::toml_values(text, path.string());
  } catch (const InvalidInput&) {
    if (!is_read && unreadable == Unreadable::rejected) throw;
    return {};
  }
}

}  // namespace

std::vector<fs::path> files_named_in(const fs::path& document, Unreadable unreadable) {
  Found found;
  std::size_t documents = 0, bytes = 0;
  // Grows while it is read: documents name documents.
  for (std::size_t next = 0; next <= found.files.size(); ++next) {
    const fs::path path = next == 0 ? document : found.files[next - 1];
    if (io::format_of(path) != io::Format::toml) continue;
    const std::vector<io::TomlValue> values = values_of(path, unreadable, bytes);
    if (++documents > most_documents || bytes > most_bytes) {
      throw InvalidInput("input",
                         fmt::format("names more than {} TOML documents, or documents of more than {} MB together",
                                     most_documents, most_bytes >> 20));
    }
    for (const io::TomlValue& value : values) add_files(value.value, path.parent_path(), found);
  }
  return std::move(found.files);
}

std::vector<fs::path> files_named_by(const std::vector<io::Json>& values, const fs::path& folder) {
  Found found;
  for (const io::Json& value : values) add_files(value, folder, found);
  return std::move(found.files);
}

}  // namespace robomill::jobs
