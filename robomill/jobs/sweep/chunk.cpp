#include "robomill/jobs/sweep/chunk.hpp"

#include <stdexcept>
#include <utility>

#include "robomill/base/digest.hpp"
#include "robomill/io/packed.hpp"

namespace robomill::jobs {
namespace {

constexpr std::string_view magic = "robomill chunk 1";
constexpr std::size_t digest_bytes = 64;

}  // namespace

std::string chunk_bytes(const Chunk& chunk) {
  std::string out(magic);
  io::pack_text(out, chunk.fingerprint);
  io::pack_text(out, chunk.processor);
  const std::size_t columns = chunk.points.empty() ? 0 : chunk.points.front().values.size();
  for (const std::uint64_t number : {chunk.first, std::uint64_t{chunk.points.size()}, std::uint64_t{columns}}) {
    io::pack_number(out, number);
  }
  for (const PointOutcome& point : chunk.points) {
    io::pack_number(out, static_cast<std::uint64_t>(point.state));
    io::pack_values(out, point.values);
    io::pack_text(out, point.reason);
  }
  return out + digest_of(out);
}

std::optional<Chunk> read_chunk(std::string_view bytes) {
  if (!bytes.starts_with(magic) || bytes.size() < magic.size() + digest_bytes) return std::nullopt;
  const std::string_view content = bytes.substr(0, bytes.size() - digest_bytes);
  if (digest_of(content) != bytes.substr(content.size())) return std::nullopt;
  try {
    io::Unpacker from(content.substr(magic.size()));
    Chunk out;
    out.fingerprint = from.text();
    out.processor = from.text();
    out.first = from.number();
    const std::uint64_t points = from.number(), columns = from.number();
    if (points == 0) return std::nullopt;
    constexpr std::size_t fixed = 2 * sizeof(std::uint64_t);  // of a point: its state, and the length of its reason
    from.require(columns, sizeof(double));
    from.require(points, fixed + static_cast<std::size_t>(columns) * sizeof(double));
    out.points.resize(static_cast<std::size_t>(points));
    for (PointOutcome& point : out.points) {
      const std::uint64_t state = from.number();
      if (state > static_cast<std::uint64_t>(PointState::rejected)) return std::nullopt;
      point.state = static_cast<PointState>(state);
      point.values.resize(static_cast<std::size_t>(columns));
      from.values(point.values);
      point.reason = from.text();
    }
    if (!from.at_end()) return std::nullopt;
    return out;
  } catch (const std::length_error&) {
    return std::nullopt;
  }
}

}  // namespace robomill::jobs
