#include "robomill/serve/tap/tap_tests.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/monitor_input.hpp"
#include "robomill/serve/http/target.hpp"

namespace robomill::serve {
namespace {

void require_range(const char* field, double value, const char* unit, double highest) {
  if (!(value >= 0.0 && value <= highest)) {
    throw InvalidInput(field, value, unit, fmt::format("must lie between 0 and {:.6g}", highest));
  }
}

}  // namespace

TapTests::TapTests(const Folder& folder, OpenStream open_stream, TapSession::Publish publish)
    : folder_(folder), open_stream_(std::move(open_stream)), publish_(std::move(publish)) {}

TapTests::~TapTests() {
  if (test_) test_->stop();
}

/// On another thread, or here where several end already.
void TapTests::end(std::shared_ptr<TapSession> test) {
  if (!test) return;
  test->stop();
  static_cast<void>(endings_.post([test = std::move(test)]() mutable { test.reset(); }));
}

HttpResponse TapTests::state() const {
  return {.body = (test_ ? test_->state() : "null") + "\n"};
}

HttpResponse TapTests::start(const io::Json& body) {
  const std::string name = body.at("hits");
  const std::string watched = body.value("watch", std::string());
  const std::filesystem::path hits = folder_.resolve(name);
  const double wanted = body.value("wanted", 0.0);
  require_range("wanted", wanted, "", static_cast<double>(TapHits::most_hits));
  TapSession::Options options = {.hits = hits,
                                 .text = Folder::read(hits),
                                 .name = name,
                                 .watch = watched.empty() ? hits.parent_path() : folder_.resolve(watched),
                                 .stream = body.value("stream", std::string()),
                                 .direction = body.value("force_direction", std::string()),
                                 .level_n = body.value("trigger_level_n", 0.0),
                                 .record_s = body.value("record_s", 0.0),
                                 .wanted = static_cast<int>(wanted),
                                 .id = last_ + 1,
                                 .root = folder_.root(),
                                 .open_stream = open_stream_};
  if (!options.stream.empty() && !watched.empty()) {
    throw InvalidInput("watch", "must not stand beside stream", "Hits come as files of a folder or out of a stream");
  }
  require_range("trigger_level_n", options.level_n, "N", 1e9);
  require_range("record_s", options.record_s, "s", 1e3);
  if (const std::string config = body.value("config", std::string()); !config.empty()) {
    if (options.stream.empty()) throw InvalidInput("config", "is of a stream's broker, and there is no stream");
    options.broker = read_broker_settings(folder_, config);
    options.config = folder_.resolve(config);
  }
  // Where it cannot begin, the one that runs goes on: its hits may not be saved yet.
  auto next = std::make_shared<TapSession>(options, publish_);
  end(std::exchange(test_, std::move(next)));
  ++last_;
  publish_("tap", test_->state());
  return {.body = "{\"state\":" + test_->state() + "}\n"};
}

HttpResponse TapTests::save(const io::Json& body) {
  const std::filesystem::path path = folder_.resolve(body.at("path").get<std::string>());
  const auto name_of = [&](const std::filesystem::path& file) {
    return file.lexically_relative(folder_.root()).generic_string();
  };
  const TapWritten written = test_->save(path, body.value("replace", false));
  if (written.there) {
    return error_response(409, printable(name_of(*written.there)) + " is there already; nothing was written");
  }
  io::Json files = io::Json::array();
  for (const std::filesystem::path& file : written.files) files.push_back(name_of(file));
  publish_("files", "{}");
  return json_response({{"files", std::move(files)}});
}

HttpResponse TapTests::about_hit(const HttpRequest& request) {
  const auto number = static_cast<std::size_t>(number_of(request.path, "/api/tap/"));
  if (request.method == "PUT" && test_) {
    const bool accepted = io::parse_json(request.body, "request").at("accepted");
    if (!test_->set_accepted(number, accepted)) return error_response(404, "there is no such hit");
  }
  const io::Json hit = test_ ? test_->about(number) : io::Json(nullptr);
  return hit.is_null() ? error_response(404, "there is no such hit") : json_response(hit);
}

HttpResponse TapTests::answer(const HttpRequest& request) {
  const bool saves = request.path == "/api/tap/save" && request.method == "POST";
  if (request.path != "/api/tap" && !saves) return about_hit(request);
  if (request.method == "GET") return state();
  if (request.method == "DELETE") {
    end(std::exchange(test_, nullptr));
    publish_("tap", "null");
    return state();
  }
  const io::Json body = io::parse_json(request.body, "request");
  if (request.method == "POST" && !saves) return start(body);
  if (!test_) return error_response(404, "there is no tap test; begin one");
  if (saves) return save(body);
  test_->set_direction(body.at("force_direction").get<std::string>());
  return state();
}

}  // namespace robomill::serve
