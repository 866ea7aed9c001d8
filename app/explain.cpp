#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/stability/files/peak_classification_json.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

using Kind = stability::Explanation::Kind;

InvalidInput reject(const char* option, double value, const char* unit, const char* rule, const char* hint = "") {
  return {option, value, unit, rule, hint};
}

/// In the user's words and units.
void check(const ExplainCommand& command) {
  for (const double f : command.peaks_hz) {
    if (!(f > 0.0 && f <= 1e6)) throw reject("--peaks", f, "Hz", "must lie between 0 and 1 MHz");
  }
  if (!(command.rpm > 0.0 && command.rpm <= 1e6)) throw reject("--rpm", command.rpm, "rpm", "must be > 0");
  if (!(command.tolerance_hz > 0.0 && command.tolerance_hz < 0.25 * command.rpm / 60.0)) {
    throw reject("--tolerance-hz", command.tolerance_hz, "Hz",
                 "must be > 0 and below a quarter of the rotation frequency",
                 "Otherwise every peak is a multiple of it");
  }
  if (!(command.speed_tolerance_percent >= 0.0 && command.speed_tolerance_percent <= 5.0)) {
    throw reject("--speed-tolerance-percent", command.speed_tolerance_percent, "%", "must lie between 0 and 5");
  }
  if (command.lobes.empty() != command.at.empty()) {
    throw InvalidInput(command.at.empty() ? "--at" : "--lobes", "--lobes and --at go together",
                       "The cut says whether its chatter needs the delay: --lobes lobes.toml --at 6500,0.8");
  }
  if (!command.at.empty() && !(command.at[0] > 0.0 && command.at[1] >= 0.0)) {
    throw InvalidInput("--at", "must read RPM,MM, RPM > 0, MM >= 0");
  }
}

/// A reading with frequencies, difference and tolerance; the short one of a report is jobs::Peak::text.
std::string full_reading(const stability::Explanation& e, int teeth) {
  switch (e.kind) {
    case Kind::tooth_passing:
      return fmt::format("tooth passing x {} ({:+.2f} Hz)", e.harmonic / teeth, e.difference_hz);
    case Kind::rotation:
      return fmt::format("rotation x {} ({:+.2f} Hz)", e.harmonic, e.difference_hz);
    case Kind::chatter: {
      const std::string name = fmt::format("{} at {:.2f} Hz", to_string(e.mode), e.mode_frequency_hz);
      const std::string turns = e.of_tooth_passing ? fmt::format("tooth passing x {}", std::abs(e.harmonic) / teeth)
                                                   : fmt::format("rotation x {}", std::abs(e.harmonic));
      const std::string tail = fmt::format(" ({:+.2f} Hz, within {:.2f})", e.difference_hz, e.tolerance_hz);
      if (e.harmonic == 0) return fmt::format("chatter: {}{}", name, tail);
      if (e.harmonic > 0) return fmt::format("chatter: {} + {}{}", name, turns, tail);
      return fmt::format("chatter: {}{}",
                         e.mirrored ? fmt::format("{} - {}", turns, name) : fmt::format("{} - {}", name, turns), tail);
    }
    case Kind::cut_or_chatter:
    case Kind::unexplained:
      break;
  }
  return "unexplained";
}

/// What is known of a peak whose best readings are about as good as each other.
const char* undecided(Kind kind) {
  return kind == Kind::chatter ? "chatter of an unidentified mode" : "ambiguous: the cut, or chatter";
}

void print_peak(const stability::ExplainedPeak& peak, int teeth) {
  const bool named = peak.state != stability::ExplainedPeak::State::ambiguous;
  fmt::print("{:>10.2f} Hz  {}\n", peak.frequency_hz,
             named ? full_reading(peak.best, teeth) : undecided(peak.best.kind));
  for (const stability::Explanation& other : peak.others) {
    const double odds = other.likelihood_per_hz / (named ? peak.best : peak.others.front()).likelihood_per_hz;
    fmt::print("               or {}, relative likelihood {:.2g}\n", full_reading(other, teeth), odds);
  }
}

void print_summary(const stability::PeakClassification& found, int teeth,
                   const std::optional<stability::ChatterMechanism>& verdict) {
  fmt::print("spindle {:.1f} rpm{}\n", found.spindle_speed_rad_per_s / units::rpm,
             found.speed_from_peaks ? ", from the peaks that are multiples of rotation" : ", as given");
  for (const stability::ExplainedPeak& peak : found.peaks) {
    print_peak(peak, teeth);
  }
  switch (found.state) {
    case stability::PeakClassification::State::named:
      fmt::print("Chatter of {} at {:.2f} Hz.\n", to_string(found.mode), found.chatter_frequency_hz);
      break;
    case stability::PeakClassification::State::ambiguous:
      fmt::print("These peaks do not determine which mode chatters, if any.\n");
      break;
    case stability::PeakClassification::State::no_chatter:
      fmt::print("No peak is chatter of a known mode.\n");
      break;
  }
  if (!verdict) {
    fmt::print("Whether it is regenerative depends on the cut: give --lobes and --at.\n");
    return;
  }
  fmt::print("The cut: {} (|μ| = {:.5g}, without the delay {:.5g}).\n", to_string(verdict->kind),
             verdict->spectral_radius, verdict->without_delay);
}

}  // namespace

Exit run(const ExplainCommand& command, const Common& common, Progress&) {
  require_output(common, {io::Format::json}, "explanations are written as .json");
  check(command);
  jobs::ExplainJob job = {.peaks = {command.peaks_hz, command.rpm * units::rpm, command.teeth},
                          .options = {command.tolerance_hz, command.speed_tolerance_percent / 100.0},
                          .modes = command.modes,
                          .lobes = command.lobes};
  if (!command.at.empty()) job.point = {command.at[0] * units::rpm, command.at[1] * units::mm};
  const jobs::ExplainResult result = jobs::run_explain(job);
  write_output(common, [&result](io::Format) {
    return stability::peak_classification_json(result.peaks, result.mechanism ? &*result.mechanism : nullptr);
  });
  if (!common.wants_summary()) return done;
  print_summary(result.peaks, command.teeth, result.mechanism);
  if (result.cut) print_notes(result.cut->notes, "Note: ");
  return done;
}

}  // namespace robomill::app
