#include "robomill/monitor/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/monitor/learning/calm_cells.hpp"
#include "robomill/monitor/learning/calm_tones.hpp"
#include "robomill/monitor/learning/knock_finder.hpp"
#include "robomill/monitor/order_detector.hpp"
#include "robomill/monitor/orders/growth_test.hpp"
#include "robomill/monitor/sensor_agreement.hpp"

namespace robomill::monitor {
namespace {

static_assert(Machine::cell_hz == GrowthTest::cell_hz);

constexpr double first_speed_s = 0.3;  // of a recording, before which nothing is learnt: the windows fill
constexpr double speed_step = 0.06;    // of rows, in ln f
constexpr double apart = 0.3;          // rows of few hops are joined over so much of ln f
constexpr int enough_hops_of_row = 20;
constexpr double least_learnt_s = 1.0;

MonitorOptions as_learnt(MonitorOptions options) {
  options.kind = Kind::comb_cusum;
  options.machine = nullptr;
  return options;
}

/// What one sensor shows.
class SensorLearner {
 public:
  explicit SensorLearner(SensorPart&& part)
      : channels_(std::move(part.channels)),
        options_(std::move(part.options)),
        monitor_(options_),
        all_(GrowthTest::cells(orders().shown().spectra->highest_hz())),
        beside_(all_.size()),
        tones_(all_.size()),
        knocks_(all_.size(), options_.hop_s),
        air_(all_.size()) {}

  void begin(double spindle_speed_rad_per_s) {
    monitor_.set_spindle_speed(spindle_speed_rad_per_s > 0.0            ? spindle_speed_rad_per_s
                               : options_.spindle_speed_rad_per_s > 0.0 ? options_.spindle_speed_rad_per_s
                                                                        : -1.0);
    monitor_.reset();
    knocks_.begin();
    last_hop_ = 0;
  }
  void set_spindle_speed(double rad_per_s) { monitor_.set_spindle_speed(rad_per_s); }
  std::optional<double> push(std::span<const float> samples);
  /// Its channels of whole frames of the stream.
  std::span<const float> own(std::span<const float> samples, std::size_t channels) {
    if (channels_.size() == channels) return samples;
    own_.clear();
    for (std::size_t at = 0; at + channels <= samples.size(); at += channels) {
      for (const std::size_t channel : channels_) own_.push_back(samples[at + channel]);
    }
    return own_;
  }
  [[nodiscard]] Machine finish() const;

 private:
  [[nodiscard]] const CutTests& orders() const {
    return static_cast<const OrderDetector&>(detector_of(monitor_)).orders();
  }
  void learn(const Decision& decision);

  std::vector<std::size_t> channels_;
  MonitorOptions options_;
  ChatterMonitor monitor_;
  std::vector<float> own_;
  std::uint64_t last_hop_ = 0;
  std::vector<double> all_, beside_;
  CalmTones tones_;
  KnockFinder knocks_;
  CalmCells air_;
  std::map<int, CalmCells> rows_;  // by speed
  double quietest_ = std::numeric_limits<double>::infinity();
  int hops_ = 0;
};

void SensorLearner::learn(const Decision& decision) {
  const CutTests::Shown shown = orders().shown();
  const bool blind = decision.state == State::blind && decision.reason != BlindReason::speed_unknown &&
                     decision.reason != BlindReason::learning;
  if (blind || shown.seconds < first_speed_s) return;
  orders().show(all_, beside_);
  ++hops_;
  quietest_ = std::min(quietest_, shown.energy);
  if (shown.rotation_hz > 0.0) {
    const int place = static_cast<int>(std::floor(std::log(shown.rotation_hz) / speed_step));
    rows_.try_emplace(place, all_.size()).first->second.add(shown.rotation_hz, all_, beside_);
  } else {
    air_.add(0.0, all_, {});
  }
  tones_.add(shown);
  knocks_.add(decision.level, all_, shown);
}

std::optional<double> SensorLearner::push(std::span<const float> samples) {
  const auto channels = static_cast<std::size_t>(options_.channels);
  while (!samples.empty()) {
    const std::size_t count = std::min(samples.size(), monitor_.frames_to_next_decision() * channels);
    const Decision decision = monitor_.push(samples.first(count));
    samples = samples.subspan(count);
    if (std::exchange(last_hop_, decision.hop) == decision.hop) continue;
    if (decision.state == State::chatter) return decision.time_s;
    learn(decision);
  }
  return std::nullopt;
}

Machine SensorLearner::finish() const {
  const double hop_s = options_.hop_s;
  Machine out{.sample_rate_hz = options_.sample_rate_hz,
              .channels = options_.channels - (options_.tachometer_channel >= 0 ? 1 : 0),
              .seconds = hops_ * hop_s,
              .quietest_energy = rounded(quietest_)};
  if (out.seconds < least_learnt_s) {
    throw InvalidInput("recordings", fmt::format("hold {:.2g} s from which a machine can be learnt", out.seconds),
                       fmt::format("{:.0f} s are needed at least, of a spindle that turns", least_learnt_s));
  }
  // Of a spindle that runs up a speed has few hops: neighbours are joined; what stands alone is of no known speed.
  CalmCells air = air_;
  CalmCells row(all_.size());
  const auto end_row = [&] {
    if (row.hops() >= enough_hops_of_row) {
      out.rows.push_back(row.exceeded());
    } else {
      air.add_unknown(row);
    }
    row = CalmCells(all_.size());
  };
  for (const auto& [place, cells] : rows_) {
    const bool far = row.hops() > 0 && std::log(cells.rotation_hz() / row.rotation_hz()) > apart;
    if (far || row.hops() >= enough_hops_of_row) end_row();
    row.add(cells);
  }
  if (row.hops() > 0) end_row();
  out.air = air.exceeded();
  out.tones = tones_.found(hops_);
  out.knocks = knocks_.found(out.seconds);
  return out;
}

}  // namespace

struct MachineLearner::Parts {
  explicit Parts(const MonitorOptions& given) : channels(static_cast<std::size_t>(given.channels)) {
    const MonitorOptions options = as_learnt(given);
    options.validate();
    for (SensorPart& part : parts_by_sensor(options)) sensors.emplace_back(std::move(part));
  }
  std::size_t channels;
  std::vector<SensorLearner> sensors;
};

MachineLearner::MachineLearner(const MonitorOptions& options) : parts_(std::make_unique<Parts>(options)) {}
MachineLearner::~MachineLearner() = default;
MachineLearner::MachineLearner(MachineLearner&&) noexcept = default;
MachineLearner& MachineLearner::operator=(MachineLearner&&) noexcept = default;

void MachineLearner::begin(double spindle_speed_rad_per_s) {
  for (SensorLearner& sensor : parts_->sensors) sensor.begin(spindle_speed_rad_per_s);
}

void MachineLearner::set_spindle_speed(double rad_per_s) {
  for (SensorLearner& sensor : parts_->sensors) sensor.set_spindle_speed(rad_per_s);
}

// Sensors learn apart: one that sees chatter where the others do not would learn it.
std::optional<double> MachineLearner::push(std::span<const float> samples) {
  std::optional<double> first;
  for (SensorLearner& sensor : parts_->sensors) {
    const std::optional<double> alarm_s = sensor.push(sensor.own(samples, parts_->channels));
    if (alarm_s && (!first || *alarm_s < *first)) first = alarm_s;
  }
  return first;
}

Machine MachineLearner::finish() const {
  const std::vector<SensorLearner>& sensors = parts_->sensors;
  Machine out = sensors.front().finish();
  for (std::size_t s = 1; s < sensors.size(); ++s) out.others.push_back(sensors[s].finish());
  return out;
}

void Machine::validate() const {
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  if (channels < 1 || channels > 64) throw InvalidInput("channels", channels, "", "must be in [1, 64]");
  require_non_negative("quietest_energy", quietest_energy, "");
  if (air.hops == 0 && rows.empty()) throw InvalidInput("rows", "must hold one at least where air holds no hop");
  const std::size_t cells = air.hops > 0 ? air.all.size() : rows.front().all.size();
  const auto check = [&](const std::string& name, const std::vector<double>& energies) {
    if (energies.size() != cells || cells == 0) {
      throw InvalidInput(name, fmt::format("has {} cells, and others have {}", energies.size(), cells));
    }
    for (const double energy : energies) require_non_negative(name.c_str(), energy, "");
  };
  if (air.hops > 0) check("air.all", air.all);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string name = fmt::format("rows[{}].", i + 1);
    require_positive((name + "rotation_hz").c_str(), rows[i].rotation_hz, "Hz");
    if (i > 0 && rows[i].rotation_hz <= rows[i - 1].rotation_hz) {
      throw InvalidInput(name + "rotation_hz", rows[i].rotation_hz, "Hz", "must rise from row to row");
    }
    check(name + "all", rows[i].all);
    check(name + "beside", rows[i].beside);
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    const Machine& other = others[i];
    const std::string name = fmt::format("others[{}]", i + 1);
    if (!other.others.empty()) throw InvalidInput(name + ".others", "must be empty");
    if (other.sample_rate_hz != sample_rate_hz) {
      throw InvalidInput(name + ".sample_rate_hz", other.sample_rate_hz, "Hz", "must be that of the first sensor");
    }
    try {
      other.validate();
    } catch (const InvalidInput& error) {
      InvalidInput::Parts parts = error.parts();
      parts.field = name + "." + parts.field;
      throw InvalidInput(std::move(parts));
    }
  }
}

InvalidInput chatter_in(const std::string& recording, double alarm_s) {
  return InvalidInput(recording,
                      fmt::format("seems to contain chatter: the monitor raises an alarm at {:.2f} s", alarm_s),
                      "A machine is learnt from recordings without chatter: leave this one out, or cut it");
}

Machine learn_machine(std::span<const CalmRecording> recordings, const MonitorOptions& options, Progress& progress) {
  MachineLearner learner(options);
  progress.start("recordings", recordings.size());
  for (const CalmRecording& recording : recordings) {
    learner.begin(recording.spindle_speed_rad_per_s);
    if (const std::optional<double> alarm_s = learner.push(recording.samples))
      throw chatter_in(recording.name, *alarm_s);
    progress.advance();
  }
  return learner.finish();
}

}  // namespace robomill::monitor
