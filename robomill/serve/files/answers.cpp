#include "robomill/serve/files/answers.hpp"

#include <filesystem>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/toml/values.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/documents.hpp"
#include "robomill/serve/files/inspect.hpp"
#include "robomill/serve/files/kind.hpp"

namespace robomill::serve {
namespace {

constexpr std::size_t most_fields = 5000;

io::Json fields_of(const std::string& text, const std::string& name) {
  io::Json out = io::Json::array();
  for (const io::TomlValue& value : io::toml_values(text, name, most_fields)) {
    out.push_back({{"key", value.key},
                   {"value", value.value},
                   {"line", value.line},
                   {"comment", io::text_or_null(value.comment)}});
  }
  return out;
}

std::filesystem::path path_of(const Folder& folder, const io::Json& body) {
  return folder.resolve(body.at("path").get<std::string>());
}

}  // namespace

HttpResponse check_text(const Folder& folder, const std::string& body) {
  const io::Json asked = io::parse_json(body, "request");
  const std::filesystem::path path = path_of(folder, asked);
  const std::string text = asked.at("text");
  if (text.size() > most_edited_bytes) return error_response(413, too_long_to_edit);
  const std::string kind = kind_of_toml(text);
  std::optional<InvalidInput> error;
  io::Json fields = io::Json::array();
  try {
    fields = fields_of(text, path.string());
    error = check_document(kind, path, text);
  } catch (const InvalidInput& found) {
    error = found;
  }
  return json_response({{"kind", kind},
                        {"error", error ? error_object(*error, folder.root()) : io::Json(nullptr)},
                        {"fields", std::move(fields)}});
}

HttpResponse inspect_file(const Folder& folder, const std::string& body) {
  return json_response(inspect(path_of(folder, io::parse_json(body, "request"))));
}

}  // namespace robomill::serve
