#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/http/server.hpp"

namespace robomill::serve {

/// {"text", "file", "line", "field", "value", "unit", "rule", "hint"}; all but text may be null. Paths are those below
/// root.
[[nodiscard]] io::Json error_object(const InvalidInput& error, const std::filesystem::path& root);
/// Of a text alone: all other keys are null.
[[nodiscard]] io::Json error_object(const std::string& text);

/// A message as a client may see it: without the way to root, printable.
[[nodiscard]] std::string client_text(std::string text, const std::filesystem::path& root);

[[nodiscard]] HttpResponse json_response(const io::Json& json, int status = 200);
/// {"error": error_object(text)}
[[nodiscard]] HttpResponse error_response(int status, const std::string& text);

/// What f returns; of an InvalidInput 400 with its parts, of another exception 500.
[[nodiscard]] HttpResponse answer_of(const std::filesystem::path& root, const std::function<HttpResponse()>& f);

}  // namespace robomill::serve
