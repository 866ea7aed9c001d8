#include "robomill/serve/process/job_process.hpp"

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/serve/error_json.hpp"

namespace robomill::serve {
namespace {

std::string text_of(const JobRequest& request) {
  return io::plain_text(
      {{"verb", request.verb}, {"inputs", request.inputs}, {"output", request.output}, {"options", request.options}});
}

JobRun run_of(const std::string& text) {
  const std::size_t line_end = text.find('\n');
  const io::Json found = io::parsed(std::string_view(text).substr(0, line_end));
  JobRun out;
  out.outcome.shortfall = found.at("shortfall").get<std::string>();
  out.outcome.summary = found.at("summary").get<std::string>();
  out.blocks = found.at("blocks").get<std::size_t>();
  if (line_end != std::string::npos) out.outcome.report = text.substr(line_end + 1);
  return out;
}

}  // namespace

JobRequest request_of(const std::string& text) {
  const io::Json json = io::parsed(text);
  return {.verb = json.at("verb").get<std::string>(),
          .inputs = json.at("inputs").get<std::vector<std::string>>(),
          .output = json.at("output").get<std::string>(),
          .options = json.at("options")};
}

// On one line what is small, and then the data of the page as it is.
std::string text_of(const JobOutcome& outcome, std::size_t blocks) {
  return io::plain_text({{"shortfall", outcome.shortfall}, {"summary", outcome.summary}, {"blocks", blocks}}) + "\n" +
         outcome.report;
}

JobRun run_in_process(const WorkerOptions& options, const JobRequest& request, const Progress::Report& report,
                      const std::atomic<bool>& stop) {
  const auto process = std::make_shared<WorkerProcess>(options, true);
  HttpResponse answer = process->ask(
      {.kind = Frame::job, .body = text_of(request), .stopped = [&stop] { return stop.load(); }, .report = report});
  if (answer.status != 200) throw AnsweredElsewhere(std::move(answer));
  JobRun run = run_of(answer.body);
  if (run.blocks > 0) {
    run.turn = [process](const std::string& body, Progress& progress) {
      return live_answer(*process, Frame::program, body, progress);
    };
  }
  return run;
}

}  // namespace robomill::serve
