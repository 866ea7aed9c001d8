#pragma once
#include <string>
#include <vector>

#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"

namespace robomill::test_support {

/// The sample values of a document, whichever reader takes them.
inline std::vector<Assumption> all_samples(const io::TomlSource& source) {
  io::TomlFile file(source);
  for (const std::string& table : file.keys("")) file.skip(table);
  return io::sample_values(file);
}

}  // namespace robomill::test_support
