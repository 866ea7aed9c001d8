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

}  // namespace

struct MachineLearner::Parts {
  explicit Parts(const MonitorOptions& given)
      : options(as_learnt(given)),
        monitor(options),
        all(GrowthTest::cells(shown_hz())),
        beside(all.size()),
        tones(all.size()),
        knocks(all.size(), options.hop_s),
        air(all.size()) {}

  [[nodiscard]] const CutTests& orders() const {
    return static_cast<const OrderDetector&>(detector_of(monitor)).orders();
  }
  [[nodiscard]] double shown_hz() const { return orders().shown().spectra->highest_hz(); }

  void learn(const Decision& decision) {
    const CutTests::Shown shown = orders().shown();
    const bool blind = decision.state == State::blind && decision.reason != BlindReason::speed_unknown &&
                       decision.reason != BlindReason::learning;
    if (blind || shown.seconds < first_speed_s) return;
    orders().show(all, beside);
    ++hops;
    quietest = std::min(quietest, shown.energy);
    if (shown.rotation_hz > 0.0) {
      const int place = static_cast<int>(std::floor(std::log(shown.rotation_hz) / speed_step));
      rows.try_emplace(place, all.size()).first->second.add(shown.rotation_hz, all, beside);
    } else {
      air.add(0.0, all, {});
    }
    tones.add(shown);
    knocks.add(decision.level, all, shown);
  }

  MonitorOptions options;
  ChatterMonitor monitor;
  std::uint64_t last_hop = 0;
  std::vector<double> all, beside;
  CalmTones tones;
  KnockFinder knocks;
  CalmCells air;
  std::map<int, CalmCells> rows;  // by speed
  double quietest = std::numeric_limits<double>::infinity();
  int hops = 0;
};

MachineLearner::MachineLearner(const MonitorOptions& options) : parts_(std::make_unique<Parts>(options)) {}
MachineLearner::~MachineLearner() = default;
MachineLearner::MachineLearner(MachineLearner&&) noexcept = default;
MachineLearner& MachineLearner::operator=(MachineLearner&&) noexcept = default;

void MachineLearner::begin(double spindle_speed_rad_per_s) {
  Parts& p = *parts_;
  p.monitor.set_spindle_speed(spindle_speed_rad_per_s > 0.0             ? spindle_speed_rad_per_s
                              : p.options.spindle_speed_rad_per_s > 0.0 ? p.options.spindle_speed_rad_per_s
                                                                        : -1.0);
  p.monitor.reset();
  p.knocks.begin();
  p.last_hop = 0;
}

void MachineLearner::set_spindle_speed(double rad_per_s) {
  parts_->monitor.set_spindle_speed(rad_per_s);
}

std::optional<double> MachineLearner::push(std::span<const float> samples) {
  Parts& p = *parts_;
  const auto channels = static_cast<std::size_t>(p.options.channels);
  while (!samples.empty()) {
    const std::size_t count = std::min(samples.size(), p.monitor.frames_to_next_decision() * channels);
    const Decision decision = p.monitor.push(samples.first(count));
    samples = samples.subspan(count);
    if (std::exchange(p.last_hop, decision.hop) == decision.hop) continue;
    if (decision.state == State::chatter) return decision.time_s;
    p.learn(decision);
  }
  return std::nullopt;
}

Machine MachineLearner::finish() const {
  const Parts& p = *parts_;
  const double hop_s = p.options.hop_s;
  Machine out{.sample_rate_hz = p.options.sample_rate_hz,
              .channels = p.options.channels - (p.options.tachometer_channel >= 0 ? 1 : 0),
              .seconds = p.hops * hop_s,
              .quietest_energy = rounded(p.quietest)};
  if (out.seconds < least_learnt_s) {
    throw InvalidInput("recordings", fmt::format("hold {:.2g} s from which a machine can be learnt", out.seconds),
                       fmt::format("{:.0f} s are needed at least, of a spindle that turns", least_learnt_s));
  }
  // Of a spindle that runs up a speed has few hops: neighbours are joined; what stands alone is of no known speed.
  CalmCells air = p.air;
  CalmCells row(p.all.size());
  const auto end_row = [&] {
    if (row.hops() >= enough_hops_of_row) {
      out.rows.push_back(row.exceeded());
    } else {
      air.add_unknown(row);
    }
    row = CalmCells(p.all.size());
  };
  for (const auto& [place, cells] : p.rows) {
    const bool far = row.hops() > 0 && std::log(cells.rotation_hz() / row.rotation_hz()) > apart;
    if (far || row.hops() >= enough_hops_of_row) end_row();
    row.add(cells);
  }
  if (row.hops() > 0) end_row();
  out.air = air.exceeded();
  out.tones = p.tones.found(p.hops);
  out.knocks = p.knocks.found(out.seconds);
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
