#include "testing/fuzz/reader.hpp"

#include <vector>

namespace robomill::fuzz {

std::span<const Reader> readers() {
  static const std::vector<Reader> all = [] {
    std::vector<Reader> out;
    for (const std::span<const Reader> some :
         {record_readers(), document_readers(), program_readers(), service_readers()}) {
      out.insert(out.end(), some.begin(), some.end());
    }
    return out;
  }();
  return all;
}

}  // namespace robomill::fuzz
