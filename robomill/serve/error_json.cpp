#include "robomill/serve/error_json.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <new>
#include <string>
#include <utility>

#include "robomill/base/printable.hpp"
#include "robomill/base/progress.hpp"

namespace robomill::serve {
namespace {

/// Whether a name goes on at a place: what stands before it is not all of it.
bool goes_on(const std::string& text, std::size_t at) {
  const auto is_of_name = [&text](std::size_t place) {
    if (place >= text.size()) return false;
    const auto letter = static_cast<unsigned char>(text[place]);
    return std::isalnum(letter) != 0 || letter == '_' || letter == '-' || letter >= 0x80;
  };
  return is_of_name(at) || (at < text.size() && text[at] == '.' && is_of_name(at + 1));
}

/// Options of the command line are those of a request here: "--sample-rate-hz" is "options.sample_rate_hz".
InvalidInput in_words_of_requests(const InvalidInput& error) {
  InvalidInput::Parts parts = error.parts();
  if (!parts.field.starts_with("--")) return error;
  parts.field = "options." + parts.field.substr(2);
  std::ranges::replace(parts.field, '-', '_');
  return InvalidInput(std::move(parts));
}

}  // namespace

std::string without_root(std::string text, const std::filesystem::path& root) {
  if (root == root.root_path()) return text;  // all paths are below it, and "//" is in no path
  const std::string way = root.string();
  std::size_t at = text.find(way);
  if (at == std::string::npos) return text;
  std::string out;  // built once: erased in place, a long text with many paths would be moved for each
  std::size_t done = 0;
  for (; at != std::string::npos; at = text.find(way, done)) {
    out.append(text, done, at - done);
    done = at + way.size();
    if (done < text.size() && text[done] == '/') {
      ++done;  // what follows is below it
    } else {
      out += goes_on(text, done) ? way : root.filename().string();
    }
  }
  return out.append(text, done, std::string::npos);
}

std::string client_text(std::string text, const std::filesystem::path& root) {
  return printable(without_root(std::move(text), root));
}

io::Json AnsweredElsewhere::error() const {
  const io::Json body = io::parsed_or_discarded(response_.body);
  if (body.is_object() && body.contains("error") && body["error"].is_object()) return body["error"];
  return error_object(response_.body.substr(0, 200));
}

io::Json error_object(const InvalidInput& given, const std::filesystem::path& root) {
  const InvalidInput error = in_words_of_requests(given);
  const InvalidInput::Parts& parts = error.parts();
  std::string file = client_text(parts.where, root);
  io::Json line = nullptr;
  if (const std::size_t colon = file.rfind(':'); colon != std::string::npos) {
    int number = 0;
    const char* const end = file.data() + file.size();
    const std::from_chars_result read = std::from_chars(file.data() + colon + 1, end, number);
    if (read.ec == std::errc() && read.ptr == end) {
      line = number;
      file.resize(colon);
    }
  }
  io::Json value = parts.number ? io::number(*parts.number) : io::text_or_null(client_text(parts.value, root));
  return {{"text", client_text(error.what(), root)},
          {"file", io::text_or_null(file)},
          {"line", std::move(line)},
          {"field", io::text_or_null(client_text(parts.field, root))},
          {"value", std::move(value)},
          {"unit", io::text_or_null(parts.unit)},
          {"rule", io::text_or_null(client_text(parts.rule, root))},
          {"hint", io::text_or_null(client_text(parts.hint, root))}};
}

io::Json error_object(const std::string& text) {
  return {{"text", text},     {"file", nullptr}, {"line", nullptr}, {"field", nullptr},
          {"value", nullptr}, {"unit", nullptr}, {"rule", nullptr}, {"hint", nullptr}};
}

HttpResponse json_response(const io::Json& json, int status) {
  return {.status = status, .body = io::plain_text(json) + "\n"};
}

HttpResponse error_response(int status, const std::string& text) {
  return json_response({{"error", error_object(text)}}, status);
}

HttpResponse answer_of(const std::filesystem::path& root, const std::function<HttpResponse()>& f) {
  try {
    return f();
  } catch (const InvalidInput& error) {
    return json_response({{"error", error_object(error, root)}}, 400);
  } catch (const Interrupted&) {
    return json_response({{"superseded", true}}, 409);
  } catch (const AnsweredElsewhere& other) {
    return other.response();
  } catch (const io::Json::exception& error) {
    return error_response(400, "the body is not the JSON that is expected: " + std::string(error.what()));
  } catch (const std::bad_alloc&) {
    return error_response(500, "not enough memory for this");
  } catch (const std::exception& error) {
    return error_response(500, client_text(error.what(), root));
  }
}

}  // namespace robomill::serve
