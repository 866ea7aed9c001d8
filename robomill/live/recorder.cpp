#include "robomill/live/recorder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/signal/bands.hpp"
#include "robomill/signal/synchrosqueeze.hpp"

namespace robomill::live {
namespace {

constexpr std::size_t wave_runs = 3000, decision_runs = 1500, spectrogram_runs = 600;
constexpr std::size_t most_rows = 257;    ///< of a spectrogram
constexpr std::size_t most_channels = 4;  ///< whose spectrogram is kept
constexpr std::size_t most_events = 400;
constexpr std::size_t most_stays = 2000;
constexpr double lowest_db = -120.0;
constexpr double drift_hz = 2.0;  ///< below, the spectrogram shows nothing: a sensor's offset would outshine the rest

enum Curve : std::size_t { score, threshold, energy_entropy, speed, curves };

signal::SynchrosqueezeOptions transform_of(const monitor::MonitorOptions& options) {
  signal::SynchrosqueezeOptions out;
  out.sample_rate_hz = options.sample_rate_hz;
  out.window_length = static_cast<Eigen::Index>(options.window_samples() / 2 * 2);
  out.hop = std::max<Eigen::Index>(1, out.window_length / 8);
  return out;
}

double finite(double value) {
  return std::isfinite(value) ? value : 0.0;
}

/// One channel's spectrogram: the strongest of each cell.
class Columns {
 public:
  explicit Columns(const signal::SynchrosqueezeOptions& options)
      : stream_(options),
        drift_share_(1.0 - std::exp(-2.0 * std::numbers::pi * drift_hz / options.sample_rate_hz)),
        merged_((stream_.lines() + most_rows - 1) / most_rows),
        lines_(stream_.lines()),
        rows_((stream_.lines() + merged_ - 1) / merged_),
        cells_(rows_.size(), spectrogram_runs) {}

  void add(float sample) {
    const auto value = static_cast<double>(sample);
    offset_ = std::exchange(any_, true) ? offset_ + drift_share_ * (value - offset_) : value;
    if (!stream_.push(value - offset_)) return;
    stream_.squeezed(lines_);
    std::ranges::fill(rows_, 0.0);
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      rows_[k / merged_] = std::max(rows_[k / merged_], std::abs(lines_[k]));
    }
    cells_.add(rows_);
  }

  /// Rows of cells, in the transform's unit.
  [[nodiscard]] Eigen::MatrixXd levels() const {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(rows_.size()), cells_.band(0).high.size());
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      out.row(static_cast<Eigen::Index>(row)) = cells_.band(row).high.transpose();
    }
    return out;
  }
  [[nodiscard]] std::size_t columns_in_a_cell() const { return cells_.length(); }
  [[nodiscard]] std::size_t merged() const { return merged_; }

 private:
  signal::SynchrosqueezeStream stream_;
  double drift_share_, offset_ = 0.0;
  bool any_ = false;
  std::size_t merged_;  ///< lines in a row
  std::vector<std::complex<double>> lines_;
  std::vector<double> rows_;
  signal::Bands cells_;
};

}  // namespace

struct Recorder::Parts {
  Parts(const monitor::MonitorOptions& given, std::vector<std::string> names, std::string of)
      : options(given),
        channels(std::move(names)),
        unit(std::move(of)),
        transform(transform_of(given)),
        waves(channels.size(), wave_runs),
        decisions(curves, decision_runs),
        frame(channels.size()) {
    const std::size_t kept = std::min(channels.size(), most_channels);
    for (std::size_t i = 0; i < kept; ++i) spectrograms.emplace_back(transform);
  }

  monitor::MonitorOptions options;
  std::vector<std::string> channels;
  std::string unit;
  signal::SynchrosqueezeOptions transform;
  signal::Bands waves, decisions;
  std::vector<double> frame;
  std::vector<Columns> spectrograms;
  std::size_t count = 0, unreported = 0, unlisted = 0;
  monitor::State state = monitor::State::stable;  ///< of the last decision
  double compute_s = 0.0, compute_max_s = 0.0;
  int loudest = 0;  ///< channel of the last chatter
  std::vector<Stay> stays;
  std::vector<std::string> events;
};

Recorder::Recorder(const monitor::MonitorOptions& options, std::vector<std::string> channels, std::string unit) {
  options.validate();
  if (channels.size() != static_cast<std::size_t>(options.channels)) {
    throw InvalidInput("channels", static_cast<double>(channels.size()), "", "must be one name a channel");
  }
  parts_ = std::make_unique<Parts>(options, std::move(channels), std::move(unit));
}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

void Recorder::add(std::span<const float> samples) {
  Parts& parts = *parts_;
  const std::size_t channels = parts.channels.size();
  for (std::size_t at = 0; at + channels <= samples.size(); at += channels) {
    for (std::size_t c = 0; c < channels; ++c) {
      parts.frame[c] = finite(static_cast<double>(samples[at + c]));
      if (c < parts.spectrograms.size()) parts.spectrograms[c].add(static_cast<float>(parts.frame[c]));
    }
    parts.waves.add(parts.frame);
  }
}

void Recorder::skip(std::uint64_t frames) {
  const auto most = static_cast<std::uint64_t>(60.0 * parts_->options.sample_rate_hz);
  const std::vector<float> nothing(parts_->channels.size(), 0.0F);
  for (std::uint64_t i = 0; i < std::min(frames, most); ++i) add(nothing);
}

void Recorder::add(const monitor::Decision& decision, double compute_s) {
  Parts& parts = *parts_;
  std::array<double, curves> values = {};
  values[score] = finite(decision.score);
  values[threshold] = finite(decision.threshold);
  values[energy_entropy] = finite(decision.energy_entropy);
  values[speed] = finite(decision.spindle_speed_rad_per_s);
  parts.decisions.add(values);
  ++parts.count;
  parts.compute_s += compute_s;
  parts.compute_max_s = std::max(parts.compute_max_s, compute_s);
  if (decision.state == monitor::State::chatter) parts.loudest = decision.channel;
  if (parts.stays.empty()) parts.stays.push_back({.state = monitor::State::stable, .from_s = 0.0, .to_s = 0.0});
  if (parts.unlisted == 0) parts.stays.back().to_s = decision.time_s;
  if (decision.state == parts.state) return;
  parts.state = decision.state;
  if (parts.stays.size() < most_stays) {
    parts.stays.push_back({.state = decision.state, .from_s = decision.time_s, .to_s = decision.time_s});
  } else {
    ++parts.unlisted;
  }
}

void Recorder::add(const monitor::MonitorEvent& event) {
  if (parts_->events.size() < most_events) {
    parts_->events.push_back(monitor::event_line(event));
  } else {
    ++parts_->unreported;
  }
}

RecordedRun Recorder::run() const {
  const Parts& parts = *parts_;
  RecordedRun out;
  out.unit = parts.unit;
  out.wave_run_s = static_cast<double>(parts.waves.length()) / parts.options.sample_rate_hz;
  for (std::size_t c = 0; c < parts.channels.size(); ++c) {
    out.channels.push_back({.name = parts.channels[c], .wave = parts.waves.band(c)});
  }
  out.decision_run_s =
      static_cast<double>(parts.decisions.length() * parts.options.hop_samples()) / parts.options.sample_rate_hz;
  out.score = parts.decisions.band(score);
  out.threshold = parts.decisions.band(threshold);
  out.energy_entropy = parts.decisions.band(energy_entropy);
  out.spindle_speed_rad_per_s = parts.decisions.band(speed);
  out.stays = parts.stays;
  out.events = parts.events;
  out.decisions = parts.count;
  if (parts.count > 0) {
    out.compute_mean_s = parts.compute_s / static_cast<double>(parts.count);
    out.compute_max_s = parts.compute_max_s;
  }
  if (parts.unreported > 0) out.notes.push_back(std::to_string(parts.unreported) + " more events are not listed.");
  if (parts.unlisted > 0) out.notes.push_back(std::to_string(parts.unlisted) + " more changes of state are not drawn.");

  const auto shown = std::min(static_cast<std::size_t>(std::max(parts.loudest, 0)), parts.spectrograms.size() - 1);
  const Columns& columns = parts.spectrograms[shown];
  const Eigen::MatrixXd levels = columns.levels();
  const double highest = levels.size() > 0 ? levels.maxCoeff() : 0.0;
  if (highest > 0.0) {
    const double rate_hz = parts.options.sample_rate_hz;
    const double step = static_cast<double>(columns.columns_in_a_cell()) * static_cast<double>(parts.transform.hop);
    out.spectrogram.channel = parts.channels[shown];
    out.spectrogram.step_s = step / rate_hz;
    out.spectrogram.begin_s = 0.5 * (step - static_cast<double>(parts.transform.hop)) / rate_hz;
    const double row_hz =
        static_cast<double>(columns.merged()) * rate_hz / static_cast<double>(parts.transform.window_length);
    const double first_hz =
        0.5 * static_cast<double>(columns.merged() - 1) * rate_hz / static_cast<double>(parts.transform.window_length);
    out.spectrogram.frequency_hz =
        Eigen::VectorXd::LinSpaced(levels.rows(), first_hz, first_hz + row_hz * static_cast<double>(levels.rows() - 1));
    out.spectrogram.level_db =
        levels.unaryExpr([highest](double level) { return std::max(lowest_db, 20.0 * std::log10(level / highest)); });
  }
  return out;
}

}  // namespace robomill::live
