#include "robomill/serve/files/toml_literal.hpp"

#include <cstddef>

#include "robomill/io/toml/edit.hpp"

namespace robomill::serve {

std::string toml_literal(const io::JsonNode& value) {
  const io::Json& json = value.json();
  if (json.is_string()) return io::toml_quoted(value.text());
  if (json.is_number() || json.is_boolean()) return io::plain_text(json);
  if (!json.is_array()) throw value.reject("must be a number, a text, true or false, or a list of them");
  std::string out;
  for (std::size_t i = 0; i < value.size(); ++i) out += (i == 0 ? "" : ", ") + toml_literal(value.at(i));
  return "[" + out + "]";
}

}  // namespace robomill::serve
