#pragma once
#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/http/server.hpp"

namespace robomill::serve {

/// {"text", "file", "line", "field", "value", "unit", "rule", "hint"}; all but text may be null. Paths are those below
/// root.
[[nodiscard]] io::Json error_object(const InvalidInput& error, const std::filesystem::path& root);
/// Of a text alone: all other keys are null.
[[nodiscard]] io::Json error_object(const std::string& text);

/// A text whose paths below root are relative to it; of root itself it has the name alone.
[[nodiscard]] std::string without_root(std::string text, const std::filesystem::path& root);
/// A message as a client may see it: without the way to root, printable.
[[nodiscard]] std::string client_text(std::string text, const std::filesystem::path& root);

/// What another process answered instead of what was asked of it.
class AnsweredElsewhere : public std::exception {
 public:
  explicit AnsweredElsewhere(HttpResponse response) : response_(std::move(response)) {}
  [[nodiscard]] const char* what() const noexcept override { return "another process gave no answer"; }
  [[nodiscard]] const HttpResponse& response() const { return response_; }
  /// Its error_object; of what is none its text.
  [[nodiscard]] io::Json error() const;

 private:
  HttpResponse response_;
};

[[nodiscard]] HttpResponse json_response(const io::Json& json, int status = 200);
/// {"error": error_object(text)}
[[nodiscard]] HttpResponse error_response(int status, const std::string& text);

/// What f returns; of an InvalidInput 400 with its parts, of another exception 500.
[[nodiscard]] HttpResponse answer_of(const std::filesystem::path& root, const std::function<HttpResponse()>& f);

}  // namespace robomill::serve
