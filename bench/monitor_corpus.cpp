// How well the monitor detects chatter in 200 simulated cuts, class by class, beside two plain rules. Usage:
// monitor_corpus [first seed] [cuts]; every other seed from 1001 on is for tuning.
// monitor_corpus --machines [first seed] [cuts a class]: the same of the cuts with what recordings show (seeds 1 to 20
// of each class are reported; 1001 on for tuning, 5001 on held out), with and without a tachometer. Beside each rate
// stands its interval of 95 %.
// monitor_corpus --arms [first seed] [cuts a sensor]: the same of robot arms' cuts with slow spindles, by sensor,
// sample rate and speed; and how many of the delays are within 8 turns of the spindle or half a second, whichever is
// longer.
// monitor_corpus --sensors [first seed] [cuts]: arms' cuts with three sensors at once, by their agreement, each alone,
// and with the powers of all channels added.
//
// monitor_corpus --learnt [first seed] [cuts a class]: cuts with tones, a run-up, a microphone, and air, without and
// with the machine that was learnt from three recordings in air of the same machine.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/monitor/machine.hpp"
#include "testing/monitor/arm_cuts.hpp"
#include "testing/monitor/corpus.hpp"
#include "testing/monitor/ideal_observer.hpp"
#include "testing/monitor/machine_cuts.hpp"
#include "testing/monitor/score.hpp"

namespace {

using namespace robomill;
using namespace robomill::monitor::testing;

using Scores = std::map<std::string, std::vector<CutScore>>;

std::string rate(int events, int trials) {
  if (trials == 0) return "-";
  const RateInterval interval = rate_interval(events, trials);
  return fmt::format("{}/{} ({:.0f} to {:.0f} %)", events, trials, 100.0 * interval.low, 100.0 * interval.high);
}

std::string two(double median, double most, double factor, int digits) {
  if (median != median) return "-";
  return fmt::format("{:.{}f} / {:.{}f}", factor * median, digits, factor * most, digits);
}

void print(const std::string& detector, const Scores& scores) {
  fmt::print(
      "\n{}\n\n| class | cuts | found (95 %) | false alarms | cuts with false alarms (95 %) | delay, ms: median / 95 % "
      "| "
      "frequency, Hz | recovery, ms | blind, % of the time |\n|---|---|---|---|---|---|---|---|---|\n",
      detector);
  for (const auto& [group, of] : scores) {
    const Summary s = summarise(of);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {:.0f} |\n", group, s.cuts, rate(s.found, s.chatter),
               s.false_alarms, rate(s.with_false_alarms, s.cuts), two(s.delay_median_s, s.delay_95_s, 1e3, 0),
               two(s.frequency_median_hz, s.frequency_95_hz, 1.0, 2), two(s.recovery_median_s, s.recovery_95_s, 1e3, 0),
               100.0 * s.blind_share);
  }
}

/// A line for a cut that the monitor does badly on.
void print_if_bad(std::uint64_t seed, const CutScore& s) {
  if (s.false_alarms == 0 && s.found == s.chatter && !(s.delay_s > 0.15) && !(s.frequency_error_hz > 5.0)) return;
  fmt::print("seed {}: {}, {}, noise {}: found {} of {}, false alarms {}, delay {:.0f} ms, frequency off {:.1f} Hz\n",
             seed, s.kind, s.course, s.noise, s.found ? 1 : 0, s.chatter ? 1 : 0, s.false_alarms, 1e3 * s.delay_s,
             s.frequency_error_hz);
}

/// Cuts with chatter, to be given to the ideal observer at the rate of false alarms that the monitor showed.
struct Observed {
  RecordedCut recorded;  // without samples
  IdealObservation observation;
  CutScore monitor;
};

void print_ideal(const std::string& name, const std::vector<Observed>& cuts, double per_hour) {
  std::vector<double> delay, since_start, monitor_since_start, ratio;
  int found = 0, false_alarms = 0, within = 0, both = 0;
  for (const Observed& cut : cuts) {
    const CutScore s = score(cut.recorded, ideal_decisions(cut.observation, {.false_alarms_per_hour = per_hour}));
    false_alarms += s.false_alarms;
    if (!s.found) continue;
    ++found;
    const double before_s = cut.recorded.truth.t10_s - cut.recorded.truth.start_s;
    delay.push_back(s.delay_s);
    since_start.push_back(s.delay_s + before_s);
    if (!cut.monitor.found) continue;
    ++both;
    monitor_since_start.push_back(cut.monitor.delay_s + before_s);
    ratio.push_back(monitor_since_start.back() / std::max(since_start.back(), 0.025));
    within += ratio.back() <= 2.0 ? 1 : 0;
  }
  fmt::print("| {} | {:.3g} | {} | {} | {} | {} | {} | {:.1f} | {} |\n", name, per_hour,
             rate(found, static_cast<int>(cuts.size())), false_alarms,
             two(quantile(delay, 0.5), quantile(delay, 0.95), 1e3, 0),
             two(quantile(since_start, 0.5), quantile(since_start, 0.95), 1e3, 0),
             two(quantile(monitor_since_start, 0.5), quantile(monitor_since_start, 0.95), 1e3, 0), quantile(ratio, 0.5),
             rate(within, both));
}

/// @param seconds  of all cuts together, in which the monitor raised so many false alarms
void print_ideals(const std::vector<Observed>& cuts, double seconds, int false_alarms) {
  fmt::print(
      "\nideal observer (testing/monitor/README.md); delays in ms: median / 95 %\n\n"
      "| | false alarms asked for, 1/h | found (95 %) | false alarms | delay | since chatter's start | the monitor's "
      "since then | ratio to 25 ms at least, median | monitor within twice (95 %) |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  print_ideal("at the rate that the monitor is asked for", cuts, 0.1);
  const double measured = 3600.0 * false_alarms / seconds;
  if (false_alarms > 0) print_ideal("at the rate that the monitor shows on these cuts", cuts, measured);
}

void corpus(std::uint64_t first, std::uint64_t count) {
  const std::vector<std::pair<std::string, Detector>> detectors = {
      {"monitor", monitor_decisions}, {"comb, RMS ratio", comb_rms_ratio}, {"RMS 5 sigma", rms_five_sigma}};
  std::vector<Scores> scores(detectors.size());
  std::vector<Observed> observed;
  double drawing_s = 0.0, seconds = 0.0;
  int false_alarms = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const std::clock_t begun = std::clock();
    const DrawnCut drawn = draw(seed);
    const RecordedCut& cut = drawn.recorded;
    seconds += cut.seconds();
    drawing_s += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
    for (std::size_t d = 0; d < detectors.size(); ++d) {
      const CutScore s = score(cut, detectors[d].second(cut));
      for (const std::string& group :
           {std::string("all"), s.kind + ", " + s.course, fmt::format("noise {}", s.noise)}) {
        scores[d][group].push_back(s);
      }
      if (d > 0) continue;
      print_if_bad(seed, s);
      false_alarms += s.false_alarms;
      if (!s.chatter) continue;
      observed.push_back({cut, observe(drawn), s});
      observed.back().recorded.samples.assign(2, 0.0F);
    }
  }
  fmt::print("{} cuts drawn and simulated in {:.1f} s of processor time\n", count, drawing_s);
  for (std::size_t d = 0; d < detectors.size(); ++d) print(detectors[d].first, scores[d]);
  print_ideals(observed, seconds, false_alarms);
}

/// Every class but `pulses`, which has its own, is given one pulse a revolution for the comparison.
void machines(std::uint64_t first, std::uint64_t count) {
  const std::vector<std::string> names = {"monitor", "monitor, with a tachometer", "comb, RMS ratio", "RMS 5 sigma"};
  std::vector<Scores> scores(names.size());
  for (const auto& [name, kind] : machine_class_names) {
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
      const RecordedCut cut = machine_cut(kind, seed);
      const RecordedCut bare = without_tachometer(cut);
      RecordedCut with = cut;
      Random random(seed, 3000);
      if (with.tachometer_channel < 0) add_tachometer(with, {}, random);
      const std::vector<CutScore> here = {score(bare, monitor_decisions(bare)), score(with, monitor_decisions(with)),
                                          score(bare, comb_rms_ratio(bare)), score(bare, rms_five_sigma(bare))};
      for (std::size_t d = 0; d < here.size(); ++d) {
        for (const std::string& group : {std::string("all"), std::string(name)}) scores[d][group].push_back(here[d]);
      }
      print_if_bad(seed, here[0]);
    }
  }
  for (std::size_t d = 0; d < names.size(); ++d) print(names[d], scores[d]);
}

/// Of arms' cuts, also by whether the delay is within 8 turns or 0.5 s.
struct ArmScores {
  std::map<std::string, std::vector<CutScore>> scores = {};
  std::map<std::string, int> in_time = {};
};

void add(const RecordedCut& cut, const CutScore& s, ArmScores& all) {
  const auto at_start = static_cast<std::size_t>(cut.truth.start_s * cut.sample_rate_hz);
  const double turn_s = 2.0 * std::numbers::pi / static_cast<double>(cut.truth.speed_rad_per_s.at(at_start));
  const bool in_time = s.found && s.delay_s <= std::max(0.5, 8.0 * turn_s);
  const char* speed = turn_s > 0.1 ? "below 600 rpm" : turn_s > 1.0 / 25.0 ? "600 to 1,500 rpm" : "above 1,500 rpm";
  for (const std::string& group :
       {std::string("all"), s.kind, fmt::format("{}, {:.0f} Hz", s.kind, cut.sample_rate_hz), std::string(speed)}) {
    all.scores[group].push_back(s);
    all.in_time[group] += in_time ? 1 : 0;
  }
}

void print(const std::string& detector, ArmScores& all) {
  print(detector, all.scores);
  fmt::print(
      "\n| | found within 8 turns or 0.5 s, of those found (95 %) | of all that chatter (95 %) |\n|---|---|---|\n");
  for (const auto& [group, in_time] : all.in_time) {
    const Summary s = summarise(all.scores[group]);
    fmt::print("| {} | {} | {} |\n", group, rate(in_time, s.found), rate(in_time, s.chatter));
  }
}

/// Each channel less its mean: a joint's load is no vibration, and the plain rules do not know that.
RecordedCut without_mean(const RecordedCut& cut) {
  RecordedCut out = cut;
  const auto channels = static_cast<std::size_t>(cut.channels);
  for (std::size_t c = 0; c < channels; ++c) {
    double mean = 0.0;
    for (std::size_t i = c; i < out.samples.size(); i += channels) mean += static_cast<double>(out.samples[i]);
    mean /= static_cast<double>(out.samples.size() / channels);
    for (std::size_t i = c; i < out.samples.size(); i += channels) out.samples[i] -= static_cast<float>(mean);
  }
  return out;
}

void arms(std::uint64_t first, std::uint64_t count) {
  ArmScores monitor, combed, five_sigma;
  std::map<std::string, int> left_out;
  double drawing_s = 0.0;
  for (const auto& [name, sensor] : arm_sensor_names) {
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
      const std::clock_t begun = std::clock();
      const RecordedCut cut = arm_cut(sensor, seed);
      drawing_s += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
      const RecordedCut bare = without_mean(cut);
      add(cut, score(cut, comb_rms_ratio(bare)), combed);
      add(cut, score(cut, rms_five_sigma(bare)), five_sigma);
      try {
        const CutScore s = score(cut, monitor_decisions(cut));
        add(cut, s, monitor);
        print_if_bad(seed, s);
      } catch (const InvalidInput& e) {
        ++left_out[fmt::format("{} at {:.0f} Hz: {}", name, cut.sample_rate_hz, e.what())];
      }
    }
  }
  fmt::print("{} cuts drawn and simulated in {:.1f} s of processor time\n", count * std::size(arm_sensor_names),
             drawing_s);
  for (const auto& [why, cuts] : left_out) fmt::print("{} cuts left out, {}\n", cuts, why);
  print("monitor", monitor);
  print("comb, RMS ratio", combed);
  print("RMS 5 sigma", five_sigma);
}

/// One of the sensors alone.
RecordedCut alone(const RecordedCut& cut, int sensor) {
  RecordedCut out = cut;
  out.samples.clear();
  out.sensors.clear();
  const auto channels = static_cast<std::size_t>(cut.channels);
  for (std::size_t i = 0; i < cut.samples.size(); ++i) {
    if (cut.sensors[i % channels] == sensor) out.samples.push_back(cut.samples[i]);
  }
  out.channels = static_cast<int>(std::ranges::count(cut.sensors, sensor));
  return out;
}

void sensors(std::uint64_t first, std::uint64_t count) {
  constexpr const char* names[] = {"spindle accelerometer", "wrist accelerometer", "force"};
  Scores scores;
  const auto judge = [&](const std::string& kind, const RecordedCut& cut, const monitor::MonitorOptions& options) {
    scores[kind].push_back(score(cut, decisions_with(options, cut)));
  };
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const RecordedCut cut = arm_cut_of_three_sensors(seed);
    monitor::MonitorOptions options = monitor_options(cut);
    judge("agreement of more than half", cut, options);
    options.agreeing_sensors = 1;
    judge("any of them", cut, options);
    options.agreeing_sensors = 3;
    judge("all of them", cut, options);
    options.sensors.clear();
    options.agreeing_sensors = 0;
    judge("powers added", cut, options);
    for (int sensor = 0; sensor < 3; ++sensor) {
      const RecordedCut one = alone(cut, sensor);
      judge(fmt::format("{} alone", names[sensor]), one, monitor_options(one));
    }
  }
  print("monitor, three sensors at once", scores);
}

/// Of the recordings those in which the monitor raises no alarm; null: of none.
std::shared_ptr<const monitor::Machine> learnt_from(const std::vector<RecordedCut>& air, int& rejected) {
  std::vector<monitor::CalmRecording> calm;
  for (const RecordedCut& recording : air) {
    const monitor::CalmRecording each{.samples = recording.samples,
                                      .spindle_speed_rad_per_s = recording.hint_rad_per_s};
    try {
      (void)monitor::learn_machine(std::span(&each, 1), monitor_options(recording));
      calm.push_back(each);
    } catch (const InvalidInput&) {
      ++rejected;
    }
  }
  if (calm.empty()) return nullptr;
  return std::make_shared<const monitor::Machine>(monitor::learn_machine(calm, monitor_options(air.front())));
}

void learnt(std::uint64_t first, std::uint64_t count) {
  constexpr int recordings = 3;
  Scores without, with;
  std::map<std::string, int> rejected;
  for (const auto& [name, kind] : machine_class_names) {
    if (kind != MachineClass::tones && kind != MachineClass::run_up_down && kind != MachineClass::microphone &&
        kind != MachineClass::air) {
      continue;
    }
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
      const MachineWithAir drawn = machine_with_air(kind, seed, recordings);
      monitor::MonitorOptions options = monitor_options(drawn.cut);
      const CutScore before = score(drawn.cut, decisions_with(options, drawn.cut));
      options.machine = learnt_from(drawn.air, rejected[std::string(name)]);
      const CutScore after = score(drawn.cut, decisions_with(options, drawn.cut));
      for (const std::string& group : {std::string("all"), std::string(name)}) {
        without[group].push_back(before);
        with[group].push_back(after);
      }
    }
  }
  print("without a machine", without);
  print("with one that was learnt", with);
  for (const auto& [name, of] : rejected) {
    fmt::print("{}: {} of {} recordings in air rejected\n", name, of, recordings * count);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view which = argc > 1 ? argv[1] : "";
  const bool named = which == "--machines" || which == "--arms" || which == "--sensors" || which == "--learnt";
  const int at = named ? 2 : 1;
  const std::uint64_t first = argc > at ? std::strtoull(argv[at], nullptr, 10) : 1;
  const std::uint64_t all = named ? 20 : corpus_size;
  const std::uint64_t count = argc > at + 1 ? std::strtoull(argv[at + 1], nullptr, 10) : all;
  if (which == "--machines") {
    machines(first, count);
  } else if (which == "--arms") {
    arms(first, count);
  } else if (which == "--sensors") {
    sensors(first, count);
  } else if (which == "--learnt") {
    learnt(first, count);
  } else {
    corpus(first, count);
  }
  return 0;
}
