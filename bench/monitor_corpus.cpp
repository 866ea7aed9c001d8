// How well the monitor detects chatter in 200 simulated cuts, class by class, beside two plain rules. Usage:
// monitor_corpus [first seed] [cuts]; every other seed from 1001 on is for tuning.
#include <fmt/core.h>

#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "testing/monitor/corpus.hpp"
#include "testing/monitor/score.hpp"

namespace {

using namespace robomill;
using namespace robomill::monitor::testing;

void print(const std::string& name, const Summary& s) {
  fmt::print("| {} | {} | {}/{} | {} | {:.0f} / {:.0f} | {:.2f} / {:.2f} | {:.0f} / {:.0f} |\n", name, s.cuts, s.found,
             s.chatter, s.false_alarms, 1e3 * s.delay_median_s, 1e3 * s.delay_95_s, s.frequency_median_hz,
             s.frequency_95_hz, 1e3 * s.recovery_median_s, 1e3 * s.recovery_95_s);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t first = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
  const std::uint64_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : corpus_size;
  const std::vector<std::pair<std::string, Detector>> detectors = {
      {"monitor", monitor_decisions}, {"comb, RMS ratio", comb_rms_ratio}, {"RMS 5 sigma", rms_five_sigma}};
  std::vector<std::map<std::string, std::vector<CutScore>>> scores(detectors.size());
  double drawing_s = 0.0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const std::clock_t begun = std::clock();
    const RecordedCut cut = monitor::testing::cut(seed);
    drawing_s += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
    for (std::size_t d = 0; d < detectors.size(); ++d) {
      const CutScore s = score(cut, detectors[d].second(cut));
      for (const std::string& group :
           {std::string("all"), s.kind + ", " + s.course, fmt::format("noise {}", s.noise)}) {
        scores[d][group].push_back(s);
      }
      if (d == 0 && (s.false_alarms > 0 || s.found != s.chatter || s.delay_s > 0.15 || s.frequency_error_hz > 5.0)) {
        fmt::print(
            "seed {}: {}, {}, noise {}: found {} of {}, false alarms {}, delay {:.0f} ms, frequency off {:.1f} Hz\n",
            seed, s.kind, s.course, s.noise, s.found ? 1 : 0, s.chatter ? 1 : 0, s.false_alarms, 1e3 * s.delay_s,
            s.frequency_error_hz);
      }
    }
  }
  fmt::print("{} cuts drawn and simulated in {:.1f} s of processor time\n", count, drawing_s);
  for (std::size_t d = 0; d < detectors.size(); ++d) {
    fmt::print(
        "\n{}\n\n| class | cuts | found | false alarms | delay, ms: median / 95 % | frequency, Hz | recovery, ms "
        "|\n|---|---|---|---|---|---|---|\n",
        detectors[d].first);
    for (const auto& [group, of] : scores[d]) print(group, summarise(of));
  }
  return 0;
}
