#include "robomill/jobs/sweep/shown_points.hpp"

#include "robomill/base/digest.hpp"

namespace robomill::jobs {
namespace {

constexpr std::size_t longest = 200;

}  // namespace

std::string shown_text(const std::string& text) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // within a letter of UTF-8
  Digest digest;
  digest.text(text);
  return text.substr(0, end) + " \u2026 " + digest.hex().substr(0, 8);
}

}  // namespace robomill::jobs
