#include <fmt/format.h>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/hits.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_peaks(const std::vector<modal::FrfGrade>& grades) {
  fmt::print("\nHighest peaks in the band that can be trusted (µm/N)\n");
  for (const modal::FrfGrade& grade : grades) {
    std::string peaks;
    for (const modal::FrfPeak& peak : grade.peaks) {
      peaks += fmt::format("{}{:.4g} Hz {:.3g}", peaks.empty() ? "" : ", ", peak.frequency_hz,
                           peak.receptance_m_per_n / units::um);
    }
    fmt::print("{:<6} {}\n", to_string(grade.name), peaks.empty() ? "none stands out" : peaks);
  }
}

void print_summary(const modal::FrfResult& result, const std::vector<std::string>& read_notes) {
  for (const modal::HitVerdict& hit : result.hits) {
    std::string reasons;
    for (const std::string& reason : hit.reasons) reasons += (reasons.empty() ? "" : "; ") + reason;
    fmt::print("{:<10} {} {}\n", hit.accepted ? "accepted" : "rejected", printable(hit.file), reasons);
  }
  fmt::print("\nFRF    grade   coherence  excited band\n");
  for (const modal::FrfGrade& grade : result.grades) {
    const std::string coherence = grade.mean_coherence >= 0.0 ? fmt::format("{:.3f}", grade.mean_coherence) : "-";
    fmt::print("{:<6} {:<7} {:>9}  {:.0f} to {:.0f} Hz\n", to_string(grade.name), to_string(grade.grade), coherence,
               grade.excited_low_hz, grade.excited_high_hz);
    for (std::size_t i = 0; i < grade.faults.size(); ++i) {
      fmt::print("       {}: {}\n", grade.faults[i], i < grade.remedies.size() ? grade.remedies[i] : "");
    }
  }
  print_peaks(result.grades);
  fmt::print("\nTrustworthy from {:.4g} Hz.\n", result.lowest_trustworthy_frequency_hz);
  print_notes(read_notes, "");
  print_notes(result.notes, "");
}

}  // namespace

Exit run(const FrfCommand& command, const Common& common, Progress& progress) {
  const modal::HitsFile hits = modal::read_hits(command.hits);
  const modal::FrfResult result = modal::estimate_frfs(hits.hits, hits.options, progress);
  if (common.to_stdout()) {
    fmt::print("{}", modal::frf_json(result));
  } else if (!common.output.empty()) {
    modal::write_frfs(common.output, result, {.binary_uff = command.binary});
  }
  if (common.wants_summary()) print_summary(result, hits.notes);
  return done;
}

}  // namespace robomill::app
