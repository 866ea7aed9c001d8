#include "robomill/serve/files/named_files.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/toml_values.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t longest_document = std::uintmax_t{1} << 20;
constexpr std::size_t longest_path = 1024;

/// Those of a value that are there and not yet known.
void add_files(const io::Json& value, const fs::path& folder, std::vector<fs::path>& files) {
  for (const io::Json& one : value.is_array() ? value : io::Json::array({value})) {
    if (one.is_array()) add_files(one, folder, files);
    if (!one.is_string()) continue;
    const auto& text = one.get_ref<const std::string&>();
    if (text.empty() || text.size() > longest_path || text.find('\0') != std::string::npos) continue;
    std::error_code ignored;
    const fs::path path = (folder / text).lexically_normal();
    if (fs::is_regular_file(path, ignored) && std::ranges::find(files, path) == files.end()) files.push_back(path);
  }
}

}  // namespace

std::vector<fs::path> files_named_in(const fs::path& document) {
  std::vector<fs::path> files;
  // Grows while it is read: documents name documents.
  for (std::size_t next = 0; next <= files.size(); ++next) {
    const fs::path path = next == 0 ? document : files[next - 1];
    if (io::format_of(path) != io::Format::toml) continue;
    try {
      const std::string text = io::read_file(path, longest_document);
      for (const io::TomlValue& value : io::toml_values(text, path.string())) {
        add_files(value.value, path.parent_path(), files);
      }
    } catch (const InvalidInput&) {
      // Missing, outside or no TOML: the job says so.
    }
  }
  return files;
}

}  // namespace robomill::serve
