#include "robomill/serve/client_order.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

namespace robomill::serve {
namespace {

constexpr std::size_t longest_name = 64;

std::string name_of(const io::JsonNode& body, const char* key) {
  if (!body.has(key)) return {};
  std::string name = body.at(key).text();
  if (name.size() > longest_name) throw body.at(key).reject(fmt::format("must have {} letters at most", longest_name));
  return name;
}

}  // namespace

ClientOrder read_client_order(const io::JsonNode& body) {
  ClientOrder out = {.client = name_of(body, "client"), .channel = name_of(body, "channel")};
  const io::JsonNode sequence = body.at("sequence");
  if (!sequence.json().is_number_unsigned()) throw sequence.reject("must be a whole number, 0 or more");
  out.sequence = sequence.json().get<std::uint64_t>();
  return out;
}

}  // namespace robomill::serve
