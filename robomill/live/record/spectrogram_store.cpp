#include "robomill/live/record/spectrogram_store.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace robomill::live {
namespace {

constexpr std::size_t most_columns = 600, most_drawn_rows = 257;
constexpr std::size_t single_lines = 256;  ///< below, each has a row of its own
constexpr double lowest_db = -120.0;
constexpr double drift_hz = 2.0;  ///< below, the spectrogram shows nothing: a sensor's offset would outshine the rest
constexpr double energy_share = 0.999, noise_factor = 2.0;

signal::SynchrosqueezeOptions transform_of(double sample_rate_hz, std::size_t window_samples) {
  signal::SynchrosqueezeOptions out;
  out.sample_rate_hz = sample_rate_hz;
  out.window_length = static_cast<Eigen::Index>(std::clamp<std::size_t>(window_samples / 2 * 2, 8, 65536));
  out.hop = std::max<Eigen::Index>(1, out.window_length / 8);
  return out;
}

std::vector<std::size_t> rows_of(std::size_t lines) {
  std::vector<std::size_t> first;
  for (std::size_t line = 0; line < lines;) {
    first.push_back(line);
    line += line < single_lines ? 1 : 2 * std::bit_floor(line / single_lines);
  }
  first.push_back(lines);
  return first;
}

}  // namespace

SpectrogramStore::SpectrogramStore(double sample_rate_hz, std::size_t window_samples)
    : options_(transform_of(sample_rate_hz, window_samples)),
      stream_(options_),
      drift_share_(1.0 - std::exp(-2.0 * std::numbers::pi * drift_hz / sample_rate_hz)),
      lines_(stream_.lines()),
      first_line_(rows_of(lines_.size())),
      peak_(first_line_.size() - 1),
      energy_(peak_.size()),
      cells_(peak_.size(), most_columns) {}

double SpectrogramStore::line_hz() const {
  return options_.sample_rate_hz / static_cast<double>(options_.window_length);
}

void SpectrogramStore::push(double value) {
  if (!stream_.push(value)) return;
  stream_.squeezed(lines_);
  for (std::size_t row = 0; row < peak_.size(); ++row) {
    double highest = 0.0;
    for (std::size_t line = first_line_[row]; line < first_line_[row + 1]; ++line) {
      const double power = std::norm(lines_[line]);
      energy_[row] += power;
      highest = std::max(highest, power);
    }
    peak_[row] = std::sqrt(highest);
  }
  cells_.add(peak_);
}

void SpectrogramStore::add(double sample) {
  if (!std::isfinite(sample)) return push(0.0);
  offset_ = std::exchange(any_, true) ? offset_ + drift_share_ * (sample - offset_) : sample;
  push(sample - offset_);
}

void SpectrogramStore::skip(std::uint64_t samples) {
  // What came before fades out of the window first.
  const auto window = static_cast<std::uint64_t>(options_.window_length);
  const auto hop = static_cast<std::uint64_t>(options_.hop);
  const std::uint64_t rest = samples > window ? samples - window : 0;
  for (std::uint64_t i = 0; i < std::min(samples, window) + rest % hop; ++i) push(0.0);
  cells_.skip(rest / hop);
}

double SpectrogramStore::energy_limit_hz() const {
  const auto lines_in = [this](std::size_t row) {
    return static_cast<double>(first_line_[row + 1] - first_line_[row]);
  };
  std::vector<std::size_t> order(energy_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t row) { return energy_[row] / lines_in(row); });
  double below = 0.0, noise = 0.0;
  for (const std::size_t row : order) {
    noise = energy_[row] / lines_in(row);
    below += lines_in(row);
    if (below >= 0.5 * static_cast<double>(lines_.size())) break;
  }
  std::vector<double> excess(energy_.size());
  for (std::size_t row = 0; row < excess.size(); ++row) {
    excess[row] = std::max(0.0, energy_[row] - noise_factor * noise * lines_in(row));
  }
  const double all = std::accumulate(excess.begin(), excess.end(), 0.0);
  if (!(all > 0.0)) return 0.5 * options_.sample_rate_hz;
  std::size_t row = excess.size();
  for (double above = 0.0; row > 1 && above + excess[row - 1] <= (1.0 - energy_share) * all;) above += excess[--row];
  return std::min(0.5 * options_.sample_rate_hz, line_hz() * static_cast<double>(first_line_[row]));
}

Spectrogram SpectrogramStore::part(double max_frequency_hz) const {
  Spectrogram out;
  const double step = static_cast<double>(cells_.length()) * static_cast<double>(options_.hop);
  out.step_s = step / options_.sample_rate_hz;
  out.begin_s = 0.5 * (step - static_cast<double>(options_.hop)) / options_.sample_rate_hz;
  out.max_frequency_hz = std::min(max_frequency_hz, 0.5 * options_.sample_rate_hz);
  // Row k covers the lines from k - 1/2 on.
  std::size_t rows = 1;
  while (rows < peak_.size() && (static_cast<double>(first_line_[rows]) - 0.5) * line_hz() < out.max_frequency_hz) {
    ++rows;
  }
  const std::size_t least = (first_line_[rows] + most_drawn_rows - 1) / most_drawn_rows;
  std::vector<std::pair<std::size_t, std::size_t>> groups;  // of rows, end excluded
  for (std::size_t row = 0; row < rows; ++row) {
    if (groups.empty() || first_line_[row] - first_line_[groups.back().first] >= least) groups.emplace_back(row, row);
    groups.back().second = row + 1;
  }
  out.frequency_hz.resize(static_cast<Eigen::Index>(groups.size()));
  Eigen::MatrixXd levels;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto [begin, end] = groups[i];
    const auto at = static_cast<Eigen::Index>(i);
    out.frequency_hz[at] = 0.5 * line_hz() * static_cast<double>(first_line_[begin] + first_line_[end] - 1);
    Eigen::VectorXd highest = cells_.band(begin).high;
    for (std::size_t row = begin + 1; row < end; ++row) highest = highest.cwiseMax(cells_.band(row).high);
    if (i == 0) levels.resize(out.frequency_hz.size(), highest.size());
    levels.row(at) = highest.transpose();
  }
  double strongest = 0.0;
  for (const double level : levels.reshaped()) strongest = std::fmax(strongest, level);
  if (!(strongest > 0.0)) return {};
  out.level_db = levels.unaryExpr([strongest](double level) {
    return std::isnan(level) ? level : std::max(lowest_db, 20.0 * std::log10(level / strongest));
  });
  return out;
}

}  // namespace robomill::live
