#pragma once
#include <cstdint>
#include <string>

#include "robomill/io/json.hpp"

// Method: robomill/serve/README.md, "The latest request wins"

namespace robomill::serve {

/// Where a request stands among those of its client.
struct ClientOrder {
  std::string client = {}, channel = {};  ///< whose requests follow each other …
  std::uint64_t sequence = 0;             ///< … in which order
};

/// Of the body of a request: `sequence`, and `client` and `channel` where it has them.
/// @throws InvalidInput naming the member
[[nodiscard]] ClientOrder read_client_order(const io::JsonNode& body);

}  // namespace robomill::serve
