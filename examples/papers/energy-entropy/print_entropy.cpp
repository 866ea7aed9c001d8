// print_entropy FOLDER [HOLES] [STAND-INS]: the source's threshold on simulated holes, and its named holes. Writes
//   summary.json        counts, thresholds, and of each named hole the medians over its stand-ins
//   passed.csv          a row a unit and sum: when the holes pass a threshold printed as 10⁵, and 105
//   stand-ins.csv       a row a stand-in: onset, alarms, visible line
//   hole-NAME.wav       the first stand-in of each, x and y in m/s²; what `robomill monitor` takes
//   course-NAME.csv     its entropy; wave-NAME.csv its acceleration; squeezed-NAME.csv its squeezed spectrogram
//   wall-NAME.csv       of experiment 4 and the stable hole: how far the wall lies beyond the drill's radius, a row a
//   turn
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "examples/papers/energy-entropy/drilled_wall.hpp"
#include "examples/papers/energy-entropy/holes_again.hpp"
#include "examples/papers/energy-entropy/squeezed_visibility.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/statistics.hpp"
#include "robomill/io/file.hpp"
#include "robomill/simulation/files/simulation_files.hpp"

namespace {

using namespace robomill;
using examples::EntropyCourse;
using examples::Hole;
using examples::NamedHole;
using examples::Passed;
using Json = nlohmann::ordered_json;

constexpr double g_m_per_s2 = 9.80665;
constexpr std::uint64_t seed = 1;

std::string number_or_none(double value, int digits = 3) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "none";
}
Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// Thresholds and whether an alarm is below.
struct Limit {
  std::string name;
  monitor::Entropy entropy = monitor::Entropy::energy;
  double threshold = 0.0;
  bool below = false;
};

Json json_of(const Passed& p) {
  return {{"chatter_before", p.chatter_before}, {"chatter_in", p.chatter_in},
          {"chatter_never", p.chatter_never},   {"stable_passes", p.stable_passes},
          {"stable_never", p.stable_never},     {"median_delay_s", number_or_null(p.median_delay_s)}};
}

Json json_of(const examples::OnsetThreshold& t) {
  return {{"threshold_m2_per_s4", t.threshold},
          {"low_decile_m2_per_s4", t.low_decile},
          {"high_decile_m2_per_s4", t.high_decile},
          {"high_to_low", t.high_decile / t.low_decile},
          {"verified", json_of(t.verified)}};
}

/// The printed number in each unit it may have: E in m/s² or g, as a mean or as a sum of the 512 squares.
void write_passed(const std::filesystem::path& folder, const std::vector<examples::JudgedHole>& holes) {
  std::string text =
      "printed,unit,energy,channels,threshold_m2_per_s4,chatter_before,chatter_in,chatter_never,stable_passes,stable_"
      "never,"
      "median_delay_s\n";
  for (const double printed : {1e5, 105.0}) {
    for (const bool in_g : {false, true}) {
      for (const bool sum : {false, true}) {
        const double threshold = printed * (in_g ? g_m_per_s2 * g_m_per_s2 : 1.0) / (sum ? 512.0 : 1.0);
        for (const bool both : {false, true}) {
          const Passed p = examples::count_passed(holes, threshold, both);
          text += fmt::format("{:.0f},{},{},{},{:.4g},{},{},{},{},{},{}\n", printed, in_g ? "g" : "m/s²",
                              sum ? "sum" : "mean", both ? "x and y" : "x", threshold, p.chatter_before, p.chatter_in,
                              p.chatter_never, p.stable_passes, p.stable_never, number_or_none(p.median_delay_s));
        }
      }
    }
  }
  io::write_file(folder / "passed.csv", text);
}

Json calibrated(const std::vector<monitor::Recording>& recordings, Limit& limit) {
  const monitor::Calibration c = monitor::calibrate(recordings, examples::entropy_options(limit.entropy));
  limit.threshold = c.options.threshold;
  limit.below = c.options.alarm_below;
  return {{"threshold", limit.threshold},
          {"alarm", limit.below ? "below" : "above"},
          {"detection_rate", c.verifying.chosen.detection_rate},
          {"false_alarm_rate", c.verifying.chosen.false_alarm_rate},
          {"median_delay_s", number_or_null(c.verifying.chosen.median_delay_s)},
          {"median_lead_s", number_or_null(c.median_lead_s)}};
}

/// The 480 holes: sets the thresholds of all limits but the printed one.
Json threshold_part(const std::filesystem::path& folder, std::uint64_t count, std::vector<Limit>& limits) {
  const std::vector<Hole> holes = examples::simulate_holes(count, seed);
  std::vector<examples::JudgedHole> judged(holes.size());
  std::vector<monitor::Recording> recordings(holes.size());
  parallel_for(holes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      judged[k] = {.chatter = holes[k].chatter,
                   .onset_s = holes[k].onset_s,
                   .energy = examples::entropy_course(holes[k], monitor::Entropy::energy)};
      if (holes[k].chatter)
        judged[k].tenth_s =
            examples::squeezed_visibility(examples::squeezed_power(holes[k]), holes[k].onset_s).tenth_s();
      recordings[k] = examples::recording_of(holes[k], fmt::format("hole {}", k + 1));
    }
  });
  write_passed(folder, judged);
  const examples::OnsetThreshold onset = examples::onset_threshold(judged, &examples::JudgedHole::onset_s);
  const examples::OnsetThreshold tenth = examples::onset_threshold(judged, &examples::JudgedHole::tenth_s);
  limits[1].threshold = tenth.threshold;
  Json out = {{"holes", holes.size()},
              {"chatter", std::ranges::count(holes, true, &Hole::chatter)},
              {"stable", std::ranges::count(holes, false, &Hole::chatter)},
              {"printed_threshold", 1e5},
              {"printed", json_of(examples::count_passed(judged, 1e5, true))},
              {"at_onset", json_of(onset)},
              {"at_tenth", json_of(tenth)}};
  out["energy"] = calibrated(recordings, limits[2]);
  out["normalised"] = calibrated(recordings, limits[3]);
  return out;
}

/// Of a stand-in; times in s of the record.
struct Result {
  Hole hole;
  EntropyCourse energy, normalised;
  examples::SqueezedPower squeezed;
  examples::SqueezedVisibility visible;
  examples::Growth growth;
  std::vector<double> alarm_s;            ///< a limit each
  double default_s = monitor::unknown_s;  ///< alarm of the default detector
  Eigen::MatrixXd wall_m;                 ///< experiment 4 and the stable hole
};

constexpr Eigen::Index wall_angles = 90;

bool has_wall(const NamedHole& named) {
  return named.name == "4" || !named.chatter;
}

/// Root mean square about the mean, and the range without the outermost hundredth on either side [µm].
struct Roughness {
  double rms_um = 0.0, range_um = 0.0;
};
Roughness roughness_of(const Eigen::MatrixXd& wall_m) {
  std::vector<double> um;
  for (const double out_m : wall_m.reshaped()) {
    if (std::isfinite(out_m)) um.push_back(1e6 * out_m);
  }
  std::sort(um.begin(), um.end());
  const Eigen::Map<const Eigen::ArrayXd> all(um.data(), static_cast<Eigen::Index>(um.size()));
  return {.rms_um = std::sqrt((all - all.mean()).square().mean()),
          .range_um = um[um.size() - 1 - um.size() / 100] - um[um.size() / 100]};
}

Result result_of(const NamedHole& named, const std::vector<Limit>& limits, std::uint64_t index) {
  Result r;
  r.hole = examples::simulate_hole(examples::conditions_of(named), named.chatter, seed, index);
  r.energy = examples::entropy_course(r.hole, monitor::Entropy::energy);
  r.normalised = examples::entropy_course(r.hole, monitor::Entropy::normalised);
  r.squeezed = examples::squeezed_power(r.hole);
  if (named.chatter) r.visible = examples::squeezed_visibility(r.squeezed, r.hole.onset_s);
  for (const Limit& limit : limits) {
    const EntropyCourse& course = limit.entropy == monitor::Entropy::energy ? r.energy : r.normalised;
    r.alarm_s.push_back(examples::passed_s(course.time_s, course.both, limit.threshold, limit.below));
  }
  if (named.chatter) r.growth = examples::growth_of(r.hole, r.energy);
  r.default_s = examples::default_alarm_s(r.hole);
  if (has_wall(named)) r.wall_m = examples::drilled_wall(r.hole, r.hole.record.displacement_m, wall_angles);
  return r;
}

void write_courses(const std::filesystem::path& folder, const NamedHole& named, const Result& r) {
  simulation::write_simulation(folder / fmt::format("hole-{}.wav", named.name), r.hole.record);
  std::string text = "time_s,energy_m2_per_s4,normalised\n";
  for (std::size_t m = 0; m < r.energy.time_s.size(); ++m) {
    text += fmt::format("{:.4f},{:.5g},{:.4f}\n", r.energy.time_s[m] - examples::hole_contact_s, r.energy.both[m],
                        r.normalised.both[m]);
  }
  io::write_file(folder / fmt::format("course-{}.csv", named.name), text);
  text = "time_s,ax_m_per_s2\n";
  const auto& a = r.hole.record.acceleration_m_per_s2;
  for (Eigen::Index m = 0; m < a.rows(); ++m) {
    text += fmt::format("{:.5f},{:.4g}\n", static_cast<double>(m) / examples::hole_rate_hz - examples::hole_contact_s,
                        a(m, 0));
  }
  io::write_file(folder / fmt::format("wave-{}.csv", named.name), text);
  text = "time_s";
  constexpr Eigen::Index shown = 129;  // up to 2.56 kHz
  for (Eigen::Index k = 0; k < shown; ++k) text += fmt::format(",{:.0f}", r.squeezed.frequency_hz(k));
  text += '\n';
  for (Eigen::Index m = 0; m + 5 <= r.squeezed.time_s.size(); m += 5) {
    text += fmt::format("{:.4f}", r.squeezed.time_s(m + 2) - examples::hole_contact_s);
    const Eigen::VectorXd mean = r.squeezed.power.block(0, m, shown, 5).rowwise().mean();
    for (const double power : mean) text += fmt::format(",{:.3g}", power);
    text += '\n';
  }
  io::write_file(folder / fmt::format("squeezed-{}.csv", named.name), text);
  if (r.wall_m.size() == 0) return;
  text = "depth_mm";
  for (Eigen::Index k = 0; k < wall_angles; ++k) text += fmt::format(",{}", 360 * k / wall_angles);
  text += '\n';
  for (Eigen::Index turn = 0; turn < r.wall_m.cols(); ++turn) {
    text += fmt::format("{:.4f}", 1e3 * r.hole.cut.feed_per_revolution_m * (static_cast<double>(turn) + 0.5));
    for (const double out_m : r.wall_m.col(turn)) text += "," + number_or_none(1e6 * out_m);
    text += '\n';
  }
  io::write_file(folder / fmt::format("wall-{}.csv", named.name), text);
}

Json middle(std::vector<double> x) {
  std::erase_if(x, [](double value) { return !std::isfinite(value); });
  return x.empty() ? Json(nullptr) : Json(median(std::move(x)));
}

/// What the alarms of all stand-ins are, under one limit.
Json alarms_json(const std::vector<Result>& results, std::size_t limit) {
  std::vector<double> alarms_s, delays_ms, leads_ms, rises_ms, settles_ms, amplitudes_ms;
  std::array<std::vector<double>, examples::visible_shares.size()> shares_ms;
  int before = 0, never = 0;
  for (const Result& r : results) {
    const double at_s = r.alarm_s[limit];
    if (!std::isfinite(at_s)) {
      ++never;
      continue;
    }
    if (at_s < r.hole.onset_s - 0.05) {
      ++before;
      continue;
    }
    alarms_s.push_back(at_s - examples::hole_contact_s);
    delays_ms.push_back(1e3 * (at_s - r.hole.onset_s));
    leads_ms.push_back(1e3 * (r.visible.visible_s - at_s));
    for (std::size_t k = 0; k < shares_ms.size(); ++k) shares_ms[k].push_back(1e3 * (r.visible.share_s[k] - at_s));
    rises_ms.push_back(1e3 * (at_s - r.growth.rises_s));
    settles_ms.push_back(1e3 * (r.growth.settles_s - at_s));
    amplitudes_ms.push_back(1e3 * (r.growth.amplitude_s - at_s));
  }
  Json at_shares = Json::array();
  for (const auto& lead_ms : shares_ms) at_shares.push_back(middle(lead_ms));
  std::vector<double> tenths_ms = shares_ms[1];
  std::sort(tenths_ms.begin(), tenths_ms.end());
  return {{"before", before},
          {"in", alarms_s.size()},
          {"never", never},
          {"ahead_of_tenth", std::ranges::count_if(tenths_ms, [](double lead_ms) { return lead_ms > 0.0; })},
          {"median_alarm_s", middle(alarms_s)},
          {"median_delay_ms", middle(delays_ms)},
          {"median_lead_ms", middle(leads_ms)},
          {"median_lead_at_share_ms", at_shares},
          {"least_lead_at_tenth_ms", tenths_ms.empty() ? Json(nullptr) : number_or_null(tenths_ms.front())},
          {"most_lead_at_tenth_ms", tenths_ms.empty() ? Json(nullptr) : number_or_null(tenths_ms.back())},
          {"median_since_rise_ms", middle(rises_ms)},
          {"median_to_settled_ms", middle(settles_ms)},
          {"median_to_amplitude_ms", middle(amplitudes_ms)}};
}

Json settings_json() {
  const monitor::MonitorOptions o = examples::entropy_options(monitor::Entropy::energy);
  return {{"sample_rate_hz", o.sample_rate_hz},
          {"sample_rate_khz", 1e-3 * o.sample_rate_hz},
          {"bands", o.bands},
          {"hop_ms", 1e3 * o.hop_s},
          {"window_ms", 1e3 * o.window_s},
          {"window_samples", o.window_samples()},
          {"contact_s", examples::hole_contact_s}};
}

/// Rows of stand-ins.csv, times since contact.
std::string rows_of(const NamedHole& named, const std::vector<Result>& results) {
  const auto since = [](double t) { return number_or_none(t - examples::hole_contact_s); };
  std::string text;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Result& r = results[k];
    text += fmt::format("{},{},{},{},{},{}", named.name, k + 1, r.hole.draws,
                        since(named.chatter ? r.hole.onset_s : monitor::unknown_s),
                        number_or_none(r.visible.line_hz, 0), since(r.visible.visible_s));
    for (const double share_s : r.visible.share_s) text += "," + since(share_s);
    for (const double alarm_s : r.alarm_s) text += "," + since(alarm_s);
    text += "," + since(r.default_s) + "\n";
  }
  return text;
}

/// Conditions as printed, and the medians over the stand-ins.
Json named_json(const NamedHole& named, const std::vector<Result>& results, const std::vector<Limit>& limits) {
  const auto& first = results.front();
  std::vector<double> lines_hz, tenths_s, defaults_s, onsets_s, rms_um, range_um;
  int before = 0;
  for (const Result& r : results) {
    onsets_s.push_back(r.hole.onset_s - examples::hole_contact_s);
    lines_hz.push_back(r.visible.line_hz);
    tenths_s.push_back(r.visible.tenth_s() - examples::hole_contact_s);
    if (r.default_s < r.hole.onset_s - 0.05) {
      ++before;
    } else if (std::isfinite(r.default_s)) {
      defaults_s.push_back(r.default_s - examples::hole_contact_s);
    }
    if (r.wall_m.size() == 0) continue;
    rms_um.push_back(roughness_of(r.wall_m).rms_um);
    range_um.push_back(roughness_of(r.wall_m).range_um);
  }
  Json json = {{"diameter_mm", named.diameter_mm},
               {"point_angle_deg", named.point_angle_deg},
               {"spindle_speed_rpm", named.spindle_speed_rpm},
               {"feed_mm_per_s", named.feed_mm_per_s},
               {"feed_per_turn_mm", 1e3 * first.hole.cut.feed_per_revolution_m},
               {"entry_s", first.hole.cut.schedule.depth[1].time_s - first.hole.cut.schedule.depth[0].time_s},
               {"stand_ins", results.size()},
               {"wall_rms_um", middle(rms_um)},
               {"wall_range_um", middle(range_um)},
               {"default_found", defaults_s.size()},
               {"default_before", before},
               {"default_median_alarm_s", middle(defaults_s)}};
  if (named.chatter) {
    json["median_onset_s"] = middle(onsets_s);
    json["median_line_hz"] = middle(lines_hz);
    json["median_tenth_s"] = middle(tenths_s);
  }
  for (std::size_t limit = 0; limit < limits.size(); ++limit) {
    json["alarms"][limits[limit].name] = alarms_json(results, limit);
  }
  return json;
}

Json named_part(const std::filesystem::path& folder, const std::vector<Limit>& limits, std::uint64_t count) {
  Json out = Json::object();
  std::string text = "hole,stand_in,draws,onset_s,line_hz,visible_s";
  for (const double share : examples::visible_shares) text += fmt::format(",visible_{:.0f}_percent_s", 100.0 * share);
  for (const Limit& limit : limits) text += fmt::format(",alarm_{}_s", limit.name);
  text += ",alarm_default_s\n";
  for (const NamedHole& named : examples::named_holes()) {
    std::vector<Result> results(count);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) results[k] = result_of(named, limits, k);
    });
    write_courses(folder, named, results.front());
    text += rows_of(named, results);
    out[std::string(named.name)] = named_json(named, results, limits);
  }
  io::write_file(folder / "stand-ins.csv", text);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::fputs("usage: print_entropy FOLDER [HOLES] [STAND-INS]\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    std::vector<Limit> limits = {{.name = "printed", .threshold = 1e5},
                                 {.name = "at_tenth"},
                                 {.name = "energy"},
                                 {.name = "normalised", .entropy = monitor::Entropy::normalised}};
    Json summary = {{"settings", settings_json()}};
    summary["thresholds"] = threshold_part(folder, argc > 2 ? std::stoull(argv[2]) : 480, limits);
    summary["named"] = named_part(folder, limits, argc > 3 ? std::stoull(argv[3]) : 20);
    io::write_file(folder / "summary.json", summary.dump(1) + "\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "print_entropy: {}\n", error.what());
    return 1;
  }
  return 0;
}
