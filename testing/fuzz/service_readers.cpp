#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "app/stream/commands.hpp"
#include "robomill/base/digest.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/shop_units.hpp"
#include "robomill/io/si.hpp"
#include "robomill/jobs/sweep/chunk.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/files/stream_block.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/answers.hpp"
#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/http/target.hpp"
#include "robomill/serve/jobs/verbs.hpp"
#include "robomill/serve/lobes/live_lobes.hpp"
#include "robomill/serve/process/frames.hpp"
#include "robomill/serve/program/live_program.hpp"
#include "robomill/serve/tap/settings.hpp"
#include "testing/fuzz/input.hpp"
#include "testing/fuzz/reader.hpp"
#include "testing/serve/http_client.hpp"

namespace robomill::fuzz {
namespace {

/// An MQTT message of samples: what is read is written as it was.
void read_stream_block(std::string_view bytes) {
  const monitor::DecodedBlock read = monitor::decode_stream_block(std::as_bytes(std::span(bytes)));
  require(read.block.has_value() == std::string_view(read.rejection).empty(), "what is no block says why");
  if (!read.block) return;
  require(!read.block->samples.empty() && std::isfinite(read.block->sample_rate_hz), "a block has samples and a rate");
  const std::string written = monitor::encode_stream_block(*read.block);
  require(written.size() == bytes.size() &&
              written.substr(monitor::stream_header_bytes) == bytes.substr(monitor::stream_header_bytes),
          "samples are written as they came");
}

/// Lines that order a stream of set-points, in pieces of the length that the first byte says.
void read_commands(std::string_view bytes) {
  app::CommandLines lines;
  const auto take = [](std::optional<std::string_view> line) {
    if (!line) return;
    require(line->size() <= app::CommandLines::longest, "lines are bounded");
    const app::ParsedCommand command = app::parse_command(*line);
    require(!command.command || command.error.empty(), "a command or an error");
    require(!command.command || (command.command->share >= 0.0 && command.command->share <= 1.5), "a share in range");
  };
  const std::size_t piece = bytes.empty() ? 1 : 1 + static_cast<unsigned char>(bytes.front()) % 64U;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(piece, bytes.size()))) lines.add(bytes.substr(0, piece), take);
  lines.end(take);
}

/// Short texts: quantities, units, names of FRFs, addresses.
void read_words(std::string_view bytes) {
  for (int i = 0; i <= static_cast<int>(io::ShopQuantity::mass); ++i) {
    accept_or_reject([&] {
      const auto quantity = static_cast<io::ShopQuantity>(i);
      require(std::isfinite(io::parse_quantity(bytes, quantity)), "a quantity is finite");
    });
  }
  require(std::isfinite(io::parse_unit(bytes).factor), "a factor is finite");
  static_cast<void>(io::unit_of_column(bytes));
  accept_or_reject([&] {
    const modal::FrfName name = modal::parse_frf_name(bytes);
    require(modal::parse_frf_name(modal::to_string(name)) == name, "a name is written as it is read");
  });
  accept_or_reject([&] { static_cast<void>(serve::parse_direction(std::string(bytes))); });
  accept_or_reject([&] {
    monitor::MqttSettings settings;
    static_cast<void>(monitor::parse_mqtt_address(std::string(bytes), settings));
  });
}

/// Bodies of requests, each as every address takes it: what is wrong with it is answered.
void read_body(std::string_view bytes) {
  static const serve::Folder served(folder());
  const auto answer = [](auto&& read) {
    const serve::HttpResponse response = serve::answer_of(folder(), [&]() -> serve::HttpResponse {
      read();
      return {};
    });
    require(response.status == 200 || response.status == 400, "a body is accepted or rejected");
  };
  answer([&] { static_cast<void>(serve::read_live_lobes_request(bytes)); });
  answer([&] { static_cast<void>(serve::read_live_program_request(bytes)); });
  answer([&] {
    const io::Json body = io::parse_json(bytes, "body");
    static_cast<void>(serve::read_job_request(body, [](const std::string& path) { return folder() / path; }));
  });
  answer([&] { static_cast<void>(serve::check_text(served, std::string(bytes))); });
  accept_or_reject([&] { const serve::TapSettings settings(folder() / "hits.toml", std::string(bytes)); });
}

/// Frames between server and process, as they come in two pieces.
void read_frames(std::string_view bytes) {
  serve::FrameReader reader(serve::longest_question);
  try {
    for (const std::string_view piece : {bytes.substr(0, bytes.size() / 2), bytes.substr(bytes.size() / 2)}) {
      reader.add(piece);
      while (const std::optional<serve::Frame> frame = reader.next()) {
        static_cast<void>(serve::response_of(frame->body));
      }
    }
  } catch (const std::length_error&) {
    // A frame that says it is longer than it may be ends the connection.
  }
}

/// A chunk of a study, as it stands and under a digest that fits: what is read is written as it was.
void read_study_chunk(std::string_view bytes) {
  for (const std::string& chunk : {std::string(bytes), std::string(bytes) + digest_of(bytes)}) {
    const std::optional<jobs::Chunk> read = jobs::read_chunk(chunk);
    require(!read || jobs::chunk_bytes(*read) == chunk, "a chunk is written as it was read");
  }
}

/// A server that takes bodies of 4 KiB and answers with them.
serve::HttpServer& server() {
  static serve::HttpServer made({.header_bytes = 4096});
  static const bool started = [] {
    made.start({.admit = [](const serve::HttpRequest&) -> std::variant<std::uint64_t, serve::HttpResponse> {
                  return std::uint64_t{4096};
                },
                .handle = [](serve::HttpRequest request,
                             const serve::Reply& reply) { reply({.body = std::move(request.body)}); }});
    return true;
  }();
  static_cast<void>(started);
  return made;
}

/// What a client sends; the server closes the connection, and answers the next client.
void read_http(std::string_view bytes) {
  std::string path;
  std::map<std::string, std::string, std::less<>> query;
  static_cast<void>(serve::split_target(bytes.substr(0, bytes.find(' ')), path, query));
  {
    test::HttpConnection client(server().port());
    client.send(bytes);
    client.send_end();
    require(client.ends(20.0), "a connection whose client has ended is closed");
  }
  require(test::http_ask(server().port(), "GET", "/").status == 200, "the server goes on");
}

constexpr std::array<Reader, 7> all = {{
    {"stream_block", read_stream_block},
    {"commands", read_commands},
    {"words", read_words},
    {"body", read_body},
    {"frames", read_frames},
    {"chunk", read_study_chunk},
    {"http", read_http},
}};

}  // namespace

std::span<const Reader> service_readers() {
  return all;
}

}  // namespace robomill::fuzz
