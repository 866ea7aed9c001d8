#include "testing/monitor/machine_cuts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "testing/monitor/corpus.hpp"
#include "testing/monitor/modelled_chatter.hpp"
#include "testing/monitor/sensors.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::monitor::testing {
namespace {

using std::numbers::pi;

constexpr std::array<double, 3> noise_shares = {0.03, 0.1, 0.3};
constexpr double abrupt_s = 0.1;

std::vector<double> rotations_hz(const CleanCut& clean) {
  return {static_cast<double>(clean.speed_rad_per_s.front()) / (2.0 * pi),
          static_cast<double>(clean.speed_rad_per_s.back()) / (2.0 * pi)};
}

double entry_of(const CleanCut& clean) {
  const auto first = std::ranges::find_if(clean.depth_share, [](float d) { return d > 0.0F; });
  if (first == clean.depth_share.end()) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(first - clean.depth_share.begin()) / corpus_rate_hz;
}

bool abrupt_enough(const MachineCut& cut) {
  const Truth& truth = cut.at_corpus_rate;
  const auto latest = static_cast<std::ptrdiff_t>((cut.entry_s + abrupt_s) * corpus_rate_hz);
  const auto& a = truth.amplitude_m_per_s2;
  return *std::max_element(a.begin(), a.begin() + latest) >= 0.9 * truth.final_m_per_s2;
}

void take(DrawnCut drawn, MachineCut& out) {
  out.plan = std::move(drawn.plan);
  out.clean = std::move(drawn.clean);
  out.at_corpus_rate = std::move(drawn.recorded.truth);
  out.recorded.course = drawn.recorded.course;
  out.entry_s = entry_of(out.clean);
}

/// By the time-domain simulation.
void simulate_cut(MachineClass kind, bool chatter, int pulses, Random& random, MachineCut& out) {
  CutWish wish = {.chatter = chatter};
  wish.low = random.uniform() < 0.3;
  wish.course = std::array{"ramp", "step", "abrupt"}.at(random.index(3));
  // So that the pulses stay below 0.4 of 204,800 Hz.
  if (pulses >= 500) wish.most_speed_rad_per_s = 2.0 * pi * 0.4 * 204800.0 / pulses;
  if (kind == MachineClass::abrupt && chatter) {
    wish.low = false;
    wish.course = "abrupt";
    wish.least_growth_per_s = 60.0;
    wish.most_growth_per_s = 250.0;
    wish.most_limits = 8.0;
  }
  for (int tries = 0; tries < 100; ++tries) {
    take(draw(wish, random), out);
    if (kind != MachineClass::abrupt || !chatter || abrupt_enough(out)) return;
  }
  throw InvalidInput("draws", 100.0, "", "gave no chatter that is full in a tenth of a second");
}

/// Stable milling by the time-domain simulation, with chatter by the model.
void model_cut(MachineClass kind, bool chatter, Random& random, MachineCut& out) {
  do {
    out.plan = stable_plan(false, random.uniform(3.6, 4.6), random);
    out.clean = simulate(out.plan);
  } while (out.clean.diverged || !settles(out.plan, out.clean));
  out.entry_s = entry_of(out.clean);
  out.recorded.course = chatter ? "model" : "stable";
  if (!chatter) {
    out.at_corpus_rate = truth_of(out.plan, out.clean, false);
    return;
  }
  const double cut_end_s = out.plan.idle_before_s + out.plan.seconds - 0.2;
  ModelledChatter c = {.final_m_per_s2 = reference_level(out.plan, out.clean) * log_uniform(0.5, 3.0, random),
                       .growth_per_s = log_uniform(8.0, 80.0, random),
                       .decay_per_s = random.uniform(60.0, 200.0),
                       .sideband = random.uniform(0.2, 0.6),
                       .wander_hz = log_uniform(0.3, 2.0, random)};
  c.half_s = out.entry_s + std::max(8.0 / c.growth_per_s, random.uniform(0.5, 1.2));
  c.end_s = random.uniform() < 0.5 ? cut_end_s : random.uniform(c.half_s + 0.9, cut_end_s);
  // What is sampled too slowly is above half that rate.
  const bool fold = kind == MachineClass::aliased;
  const double base_hz = fold ? log_uniform(900.0, 3500.0, random) : log_uniform(250.0, 1500.0, random);
  c.modes.push_back({base_hz, random.uniform(0.0, 2.0 * pi)});
  if (kind == MachineClass::drifting) {
    c.drift_hz_per_s = (random.uniform() < 0.5 ? -1.0 : 1.0) * log_uniform(50.0, 500.0, random);
    c.drift_from_s = c.half_s - random.uniform(1.0, 4.0) / c.growth_per_s;
    c.drift_to_s = c.drift_from_s + std::min(random.uniform(0.2, 0.8), 0.3 * base_hz / std::abs(c.drift_hz_per_s));
  } else if (kind == MachineClass::hopping) {
    const int others = 1 + static_cast<int>(random.index(2));
    for (int k = 1; k <= others; ++k) {
      c.modes.push_back({base_hz * (1.0 + k * random.uniform(0.08, 0.45)), random.uniform(0.0, 2.0 * pi)});
    }
    double t = c.half_s;
    for (std::size_t mode = 0; t < c.end_s; t += random.uniform(0.1, 0.5)) {
      c.visits.push_back({t, mode});
      mode = (mode + 1 + random.index(c.modes.size() - 1)) % c.modes.size();
    }
  }
  out.at_corpus_rate = add_chatter(c, out.plan, random, out.clean);
  if (fold) out.at_corpus_rate.course_hz.clear();  // it hardly moves
}

/// The spindle turns and nothing is cut.
void idle(Random& random, MachineCut& out) {
  out.plan.seconds = random.uniform(4.0, 6.0);
  out.plan.idle_before_s = out.plan.idle_after_s = 0.0;
  out.plan.milling.structure = modal::tip_modes(data::robot_modes(), {}, random.uniform(0.0, 2.0 * pi));
  out.plan.milling.milling.tool.teeth = 2 + static_cast<int>(random.index(3));
  const double speed = random.uniform(2000.0, 15000.0) * pi / 30.0;
  out.plan.milling.spindle_speed_rad_per_s = speed;
  const auto rows = static_cast<Eigen::Index>(out.plan.seconds * corpus_rate_hz);
  out.clean.acceleration_m_per_s2.setZero(rows, 2);
  out.clean.forced_m_per_s2.setZero(rows, 2);
  out.clean.regenerated_m.setZero(rows, 2);
  const double after = random.uniform() < 0.5 ? speed : speed * random.uniform(0.7, 1.3);
  const double from_s = random.uniform(1.0, 2.0), to_s = from_s + random.uniform(0.3, 1.0);
  double angle = 0.0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / corpus_rate_hz;
    const double now = speed + (after - speed) * std::clamp((t - from_s) / (to_s - from_s), 0.0, 1.0);
    out.clean.rotation_rad.push_back(angle);
    out.clean.speed_rad_per_s.push_back(static_cast<float>(now));
    angle += now / corpus_rate_hz;
  }
  out.clean.depth_share.assign(static_cast<std::size_t>(rows), 0.0F);
  out.at_corpus_rate = {.end_s = out.plan.seconds};
  out.at_corpus_rate.amplitude_m_per_s2.assign(static_cast<std::size_t>(rows), 0.0F);
  out.at_corpus_rate.speed_rad_per_s = out.clean.speed_rad_per_s;
  out.entry_s = std::numeric_limits<double>::quiet_NaN();
  out.recorded.course = "stable";
}

/// Puts time before and after a cut in which the spindle runs up and down.
void run_up_and_down(Random& random, MachineCut& cut) {
  const double stand_s = random.uniform(0.2, 0.5), up_s = random.uniform(0.5, 2.0), idle_s = random.uniform(0.1, 0.4);
  const double wait_s = random.uniform(0.1, 0.4), down_s = random.uniform(0.5, 2.0);
  const auto rows_of = [](double seconds) { return static_cast<std::size_t>(seconds * corpus_rate_hz); };
  const std::size_t before = rows_of(stand_s + up_s + idle_s), after = rows_of(wait_s + down_s + stand_s);
  CleanCut& clean = cut.clean;
  const std::size_t rows = clean.depth_share.size(), all = before + rows + after;
  for (CleanCut::Columns* x : {&clean.acceleration_m_per_s2, &clean.forced_m_per_s2, &clean.regenerated_m}) {
    CleanCut::Columns longer = CleanCut::Columns::Zero(static_cast<Eigen::Index>(all), 2);
    longer.middleRows(static_cast<Eigen::Index>(before), static_cast<Eigen::Index>(rows)) = *x;
    *x = longer;
  }
  const auto pad = [&](auto& values) {
    values.insert(values.begin(), before, 0.0F);
    values.resize(all, 0.0F);
  };
  const double first = static_cast<double>(clean.speed_rad_per_s.front());
  const double last = static_cast<double>(clean.speed_rad_per_s.back());
  pad(clean.depth_share);
  pad(clean.speed_rad_per_s);
  pad(cut.at_corpus_rate.amplitude_m_per_s2);
  clean.rotation_rad.clear();
  double angle = 0.0;
  for (std::size_t i = 0; i < all; ++i) {
    const double t = static_cast<double>(i) / corpus_rate_hz,
                 end_s = static_cast<double>(before + rows) / corpus_rate_hz;
    float& speed = clean.speed_rad_per_s[i];
    if (i < before) speed = static_cast<float>(first * std::clamp((t - stand_s) / up_s, 0.0, 1.0));
    if (i >= before + rows)
      speed = static_cast<float>(last * std::clamp(1.0 - (t - end_s - wait_s) / down_s, 0.0, 1.0));
    clean.rotation_rad.push_back(angle);
    angle += static_cast<double>(speed) / corpus_rate_hz;
  }
  const double later_s = static_cast<double>(before) / corpus_rate_hz;
  Truth& truth = cut.at_corpus_rate;
  truth.speed_rad_per_s = clean.speed_rad_per_s;
  if (truth.chatter) {
    truth.start_s += later_s;
    truth.t10_s += later_s;
    truth.end_s += later_s;
  } else {
    truth.end_s = static_cast<double>(all) / corpus_rate_hz;
  }
  cut.entry_s += later_s;
}

Sensors sensors_of(MachineClass kind, double rotation_hz, const PulseTrain& train, Random& random) {
  Sensors out;
  if (kind == MachineClass::microphone) {
    out.sample_rate_hz = random.uniform() < 0.5 ? 44100.0 : 48000.0;
    const int channels = 1 + static_cast<int>(random.index(2));
    const double direction = random.uniform(0.0, 2.0 * pi);
    out.mix.resize(channels, 2);
    for (Eigen::Index c = 0; c < channels; ++c) {
      // Two microphones of one recorder differ by next to nothing.
      const double here = direction + 0.02 * static_cast<double>(c);
      out.mix.row(c) << std::cos(here), std::sin(here);
    }
    const std::uint64_t echoes = 2 + random.index(5);
    for (std::uint64_t k = 0; k < echoes; ++k) {
      out.echoes.push_back({random.uniform(0.002, 0.04), random.uniform(-0.4, 0.4)});
    }
  } else if (kind == MachineClass::aliased) {
    out.sample_rate_hz = aliased_rate_hz;
    out.mix.resize(3, 2);
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double direction = 0.5 * pi * static_cast<double>(c) + random.uniform(-0.3, 0.3);
      const double gain = c == 2 ? random.uniform(0.2, 1.0) : 1.0;
      out.mix.row(c) << gain * std::cos(direction), gain * std::sin(direction);
    }
  }
  if (kind == MachineClass::pulses) {
    // The shorter level lasts for 1.25 samples at least: every pulse is seen.
    const double shorter = std::min(train.duty, 1.0 - train.duty);
    while (train.pulses_per_revolution * rotation_hz * 1.25 > shorter * out.sample_rate_hz) out.sample_rate_hz *= 2.0;
  }
  return out;
}

std::vector<MachineTone> tones_of(MachineClass kind, double level, const MachineCut& cut, Random& random) {
  std::vector<MachineTone> out;
  const std::vector<double> rotations = rotations_hz(cut.clean);
  const auto one = [&](double low, double high, double least, double most) {
    MachineTone tone = draw_tone(low, high, level * log_uniform(least, most, random), rotations, random);
    tone.swing = random.uniform() < 0.5 ? random.uniform(0.0, 0.5) : 0.0;
    tone.swing_hz = random.uniform(0.2, 3.0);
    out.push_back(tone);
  };
  const std::uint64_t count = 2 + random.index(4);
  for (std::uint64_t k = 0; k < count; ++k) {
    if (kind == MachineClass::tones) one(60.0, 3500.0, 0.03, 0.5);
    if (kind == MachineClass::microphone) one(45.0, 2500.0, 0.02, 0.2);
    if (kind == MachineClass::run_up_down) one(60.0, 3500.0, 0.01, 0.1);
    if (kind == MachineClass::air) {
      one(60.0, 3500.0, 0.02, 0.5);
      if (random.uniform() < 0.5) continue;
      // A pump, a fan, an axis that moves.
      out.back().from_s = random.uniform(0.3, 3.0);
      out.back().to_s = out.back().from_s + random.uniform(0.3, 3.0);
      out.back().fade_s = log_uniform(0.02, 0.5, random);
    }
  }
  return out;
}

/// Low-pass noise of a room, above the microphone's own; then 16 bits.
void add_room(double level, double sample_rate_hz, int channels, Random& random, std::vector<float>& samples,
              double& gain) {
  const auto count = static_cast<std::size_t>(channels);
  const double keep = std::exp(-2.0 * pi * 300.0 / sample_rate_hz), drive = std::sqrt(1.0 - keep * keep);
  double room = 0.0, most = 1e-300;
  for (std::size_t i = 0; i < samples.size(); i += count) {
    room = keep * room + drive * random.normal();
    for (std::size_t c = 0; c < count; ++c) {
      samples[i + c] += static_cast<float>(level * (0.8 * room + 0.3 * random.normal()));
      most = std::max(most, std::abs(static_cast<double>(samples[i + c])));
    }
  }
  const double scale = random.uniform(0.2, 0.9) / most;
  if (gain == 0.0) gain = scale;
  for (float& s : samples) s = static_cast<float>(std::round(gain * static_cast<double>(s) * 32768.0) / 32768.0);
}

std::vector<double> rotation_of(const std::vector<float>& speed_rad_per_s, double sample_rate_hz, double first_rad) {
  std::vector<double> out;
  double angle = first_rad;
  for (const float speed : speed_rad_per_s) {
    out.push_back(angle);
    angle += static_cast<double>(speed) / sample_rate_hz;
  }
  return out;
}

/// @param anew  where not null, draws what differs from one recording of a machine to the next; nothing is cut then
void record(MachineClass kind, const PulseTrain& train, Random& random, MachineCut& cut, Random* anew = nullptr) {
  RecordedCut& out = cut.recorded;
  const double level = reference_level(cut.plan, cut.clean);
  const double noise = noise_shares.at(static_cast<std::size_t>(out.noise));
  const bool turns_alone = kind == MachineClass::run_up_down || kind == MachineClass::air;
  const Disturbance disturbance = {
      .noise = kind == MachineClass::microphone ? 0.3 * noise : noise,
      .hum = random.uniform(0.01, 0.05),
      .unbalance = turns_alone ? 0.0 : random.uniform(0.01, 0.1),
      .gain_swing = random.uniform(0.0, 0.15),
      .knocks_per_s = kind == MachineClass::air ? random.uniform(0.3, 2.0) : random.uniform(0.1, 0.6)};
  std::vector<float> two = disturbed(cut.plan, cut.clean, disturbance, random);
  if (anew != nullptr) {
    CleanCut air = cut.clean;
    air.acceleration_m_per_s2.setZero();
    std::ranges::fill(air.depth_share, 0.0F);
    two = disturbed(cut.plan, air, disturbance, *anew);
  }
  const double fastest_hz = std::max(rotations_hz(cut.clean)[0], cut.plan.speed_rad_per_s() / (2.0 * pi));
  const Sensors sensors = sensors_of(kind, fastest_hz, train, random);
  out.sample_rate_hz = sensors.sample_rate_hz;
  out.channels = static_cast<int>(sensors.mix.rows());
  CleanCut::Columns vibration(cut.clean.acceleration_m_per_s2.rows(), 2);
  for (std::size_t i = 0; i < two.size(); ++i) {
    vibration(static_cast<Eigen::Index>(i / 2), static_cast<Eigen::Index>(i % 2)) = static_cast<double>(two[i]);
  }
  out.samples = sensed(vibration, sensors);
  out.truth = at_rate(cut.at_corpus_rate, out.sample_rate_hz);
  add_tones(tones_of(kind, level, cut, random), out.sample_rate_hz, out.channels, random, out.samples);
  if (turns_alone || (kind == MachineClass::tones && random.uniform() < 0.5)) {
    const DriveOrders orders = {.nominal_rad_per_s = cut.plan.speed_rad_per_s(),
                                .amplitude = level * random.uniform(0.01, 0.2),
                                .thirds = level * random.uniform(0.0, 0.05),
                                .resonance_hz = random.uniform(500.0, 600.0)};
    const std::vector<double> rotation = rotation_of(out.truth.speed_rad_per_s, out.sample_rate_hz, 0.0);
    add_orders(orders, rotation, out.truth.speed_rad_per_s, out.channels, random, out.samples);
  }
  if (kind == MachineClass::microphone)
    add_room(noise * level, out.sample_rate_hz, out.channels, random, out.samples, cut.gain);
  if (kind == MachineClass::pulses) cut.upward_edges = add_tachometer(out, train, random);
}

/// Of a seed of `pulses`: every count that shops have, from 1 to 1,024.
PulseTrain train_of(std::uint64_t seed, Random& random) {
  constexpr std::array<int, 20> counts = {1, 2,   1024, 60,  4, 360, 512, 1, 128, 1000,
                                          8, 256, 16,   100, 3, 32,  500, 1, 64,  720};
  PulseTrain out = {.pulses_per_revolution = counts.at((seed - 1) % counts.size())};
  if (out.pulses_per_revolution <= 4) out.duty = log_uniform(0.03, 0.5, random);
  out.inverted = random.uniform() < 0.5;
  return out;
}

}  // namespace

double folded_hz(double frequency_hz, double rate_hz) {
  return std::abs(frequency_hz - rate_hz * std::round(frequency_hz / rate_hz));
}

int add_tachometer(RecordedCut& cut, const PulseTrain& train, Random& random) {
  const auto channels = static_cast<std::size_t>(cut.channels);
  const std::size_t frames = cut.samples.size() / channels;
  const double first = random.uniform(0.0, 2.0 * pi);
  const std::vector<double> rotation = rotation_of(cut.truth.speed_rad_per_s, cut.sample_rate_hz, first);
  std::vector<float> out;
  out.reserve(frames * (channels + 1));
  int edges = 0;
  bool before = true;
  for (std::size_t i = 0; i < frames; ++i) {
    const double pulse = rotation[i] / (2.0 * pi) * train.pulses_per_revolution;
    const bool high = (pulse - std::floor(pulse) < train.duty) != train.inverted;
    edges += high && !before ? 1 : 0;
    before = high;
    for (std::size_t c = 0; c < channels; ++c) out.push_back(cut.samples[i * channels + c]);
    out.push_back(static_cast<float>((high ? 5.0 : 0.0) + 0.005 * random.normal()));
  }
  cut.samples = std::move(out);
  cut.tachometer_channel = cut.channels++;
  cut.pulses_per_revolution = train.pulses_per_revolution;
  return edges;
}

namespace {

/// All but the recording, for which `random` is left as it is then.
MachineCut draw_unrecorded(MachineClass kind, std::uint64_t seed, PulseTrain& train, Random& random) {
  const bool chatter = kind != MachineClass::air && seed % 2 == 1;
  MachineCut out;
  out.recorded.kind = name_in(machine_class_names, kind);
  out.recorded.noise = static_cast<int>(seed / 2 % 3);
  if (kind == MachineClass::pulses) train = train_of(seed, random);
  const bool modelled = kind == MachineClass::drifting || kind == MachineClass::hopping ||
                        (kind == MachineClass::aliased && seed % 4 == 1);
  if (kind == MachineClass::air) {
    idle(random, out);
  } else if (modelled) {
    model_cut(kind, chatter, random, out);
  } else {
    simulate_cut(kind, chatter, train.pulses_per_revolution, random, out);
  }
  if (kind == MachineClass::run_up_down) run_up_and_down(random, out);
  return out;
}

void add_hint(MachineClass kind, Random& random, MachineCut& out) {
  out.recorded.teeth = out.plan.teeth();
  const auto speed = static_cast<double>(
      out.clean
          .speed_rad_per_s[kind == MachineClass::air ? 0 : static_cast<std::size_t>(out.entry_s * corpus_rate_hz)]);
  out.recorded.hint_rad_per_s = speed * (random.uniform() < 0.2 ? 1.0 : 1.0 + random.uniform(-0.05, 0.05));
}

}  // namespace

MachineCut draw_machine_cut(MachineClass kind, std::uint64_t seed) {
  Random random(seed, 2000 + static_cast<std::uint64_t>(kind));
  PulseTrain train;
  MachineCut out = draw_unrecorded(kind, seed, train, random);
  record(kind, train, random, out);
  add_hint(kind, random, out);
  return out;
}

MachineWithAir machine_with_air(MachineClass kind, std::uint64_t seed, int recordings) {
  Random random(seed, 2000 + static_cast<std::uint64_t>(kind));
  PulseTrain train;
  const MachineCut drawn = draw_unrecorded(kind, seed, train, random);
  MachineWithAir out;
  double gain = 0.0;
  for (int i = 0; i <= recordings; ++i) {
    MachineCut one = drawn;
    one.gain = gain;
    Random same = random;
    Random anew(seed, 3000 + static_cast<std::uint64_t>(i));
    record(kind, train, same, one, i == 0 ? nullptr : &anew);
    gain = one.gain;
    add_hint(kind, same, one);
    if (i == 0) {
      out.cut = std::move(one.recorded);
    } else {
      one.recorded.truth.chatter = false;
      out.air.push_back(std::move(one.recorded));
    }
  }
  return out;
}

RecordedCut machine_cut(MachineClass kind, std::uint64_t seed) {
  return draw_machine_cut(kind, seed).recorded;
}

}  // namespace robomill::monitor::testing
