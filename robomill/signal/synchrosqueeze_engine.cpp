#include "robomill/signal/synchrosqueeze_engine.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::signal {
namespace {

// An FFT of N takes as long as near 128 turns of N/2 lines (synchrosqueeze_bench.cpp).
constexpr Eigen::Index longest_sliding_hop = 128;
constexpr std::size_t pad = lane_count;  ///< lines before line 0

double* data(std::vector<Lanes>& store) {
  return store.data()->v;
}
const double* data(const std::vector<Lanes>& store) {
  return store.data()->v;
}
void clear(std::vector<Lanes>& store) {
  std::fill(store.begin(), store.end(), Lanes{});
}
std::size_t line_of(double target) {
  return static_cast<std::size_t>(std::bit_cast<std::uint64_t>(target) & 0xffffffffU);
}

}  // namespace

std::vector<std::uint8_t> bands_of_lines(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz) {
  const Eigen::Index bands = edges_hz.size() - 1;
  if (bands < 1 || bands > 255) {
    throw InvalidInput("edges_hz", static_cast<double>(edges_hz.size()), "edges", "must be 2 to 256");
  }
  for (Eigen::Index b = 0; b <= bands; ++b) {
    require_finite("edges_hz", edges_hz(b), "Hz");
    if (b > 0 && !(edges_hz(b) > edges_hz(b - 1))) throw InvalidInput("edges_hz", edges_hz(b), "Hz", "must rise");
  }
  std::vector<std::uint8_t> out;
  for (Eigen::Index k = 0; k < options.lines(); ++k) {
    const double f = static_cast<double>(k) * options.sample_rate_hz / static_cast<double>(options.window_length);
    // The first edge above f closes its band.
    const auto above = std::upper_bound(edges_hz.begin(), edges_hz.end(), f) - edges_hz.begin();
    const bool inside = above > 0 && (above <= bands || f == edges_hz(bands));
    out.push_back(static_cast<std::uint8_t>(inside ? std::min<Eigen::Index>(above - 1, bands - 1) : bands));
  }
  return out;
}

SynchrosqueezeEngine::SynchrosqueezeEngine(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz)
    : n(static_cast<std::size_t>(options.window_length)),
      lines(static_cast<std::size_t>(options.lines())),
      hop(static_cast<std::uint64_t>(options.hop)),
      fft_(n, false) {
  slides_ = options.hop <= longest_sliding_hop;
  groups_ = (lines + lane_count - 1) / lane_count;
  // Whole groups read their neighbours, also where only their first lines count.
  slide_groups_ = (pad + groups_ * lane_count + max_cosines - 1 + lane_count - 1) / lane_count;
  ring_.resize(2 * n);
  set_tables(options);
  if (edges_hz.size() > 0) set_bands(options, edges_hz);
  reset();
}

void SynchrosqueezeEngine::set_tables(const SynchrosqueezeOptions& options) {
  const Eigen::VectorXd g = window_samples(options.window, options.window_length);
  const Eigen::VectorXd slope = window_derivative(options.window, options.window_length, options.sample_rate_hz);
  const auto length = static_cast<double>(n);
  scale_ = 1.0 / (length * g(options.window_length / 2));
  for (Store* store : {&line_, &weight_, &sign_, &v_re_, &v_im_, &a_re_, &a_im_, &target_, &share_}) {
    store->resize(groups_);
    clear(*store);
  }
  for (std::size_t k = 0; k < groups_ * lane_count; ++k) {
    data(line_)[k] = static_cast<double>(k);
    if (k >= lines) continue;
    // The sliding lines have their phases relative to the sample after the newest, half a window after the centre.
    data(sign_)[k] = slides_ && k % 2 == 1 ? -1.0 : 1.0;
    data(weight_)[k] = data(sign_)[k] * (k == 0 || k + 1 == lines ? 1.0 : 2.0);
  }
  const double threshold = options.threshold * 0.5 * g.sum();
  squeeze_ = {.re = nullptr,
              .im = nullptr,
              .line = data(line_),
              .weight = data(weight_),
              .mix = {},
              .slope = {},
              .terms = 0,
              .threshold_squared = threshold * threshold,
              .last_line = static_cast<double>(lines - 1),
              .v_re = data(v_re_),
              .v_im = data(v_im_),
              .a_re = data(a_re_),
              .a_im = data(a_im_),
              .target = data(target_),
              .share = data(share_),
              .groups = groups_};
  if (!slides_) {
    g_.assign(g.begin(), g.end());
    for (const double value : slope)
      slope_.push_back(value * length / (2.0 * std::numbers::pi * options.sample_rate_hz));
    in_.resize(n);
    out_.resize(n);
    fft_.transform(in_.data(), out_.data());  // takes its working store now
    return;
  }
  for (Store* store : {&re_, &im_, &turn_re_, &turn_im_}) store->resize(slide_groups_);
  for (std::size_t k = 0; k < slide_groups_ * lane_count; ++k) {
    const auto turns = static_cast<double>((k + n - pad) % n) / length;
    data(turn_re_)[k] = std::cos(2.0 * std::numbers::pi * turns);
    data(turn_im_)[k] = std::sin(2.0 * std::numbers::pi * turns);
  }
  fresh_groups_ = (slide_groups_ + 3) / 4;
  fresh_re_.resize(fresh_groups_);
  fresh_im_.resize(fresh_groups_);
  squeeze_.re = data(re_) + pad;
  squeeze_.im = data(im_) + pad;
  const std::vector<double> cosines = window_cosines(options.window);
  squeeze_.terms = cosines.size();
  for (std::size_t j = 0; j < cosines.size(); ++j) {
    const double alternating = j % 2 == 1 ? -cosines[j] : cosines[j];
    squeeze_.mix[j] = j == 0 ? alternating : 0.5 * alternating;
    squeeze_.slope[j] = static_cast<double>(j) * alternating;
  }
}

void SynchrosqueezeEngine::set_bands(const SynchrosqueezeOptions& options, const Eigen::VectorXd& edges_hz) {
  band_of_line_ = bands_of_lines(options, edges_hz);
  bands = static_cast<std::size_t>(edges_hz.size() - 1);
  band_sums_.resize(bands + 1);  // the last for lines that no band has
  band_values.resize(bands);
  far_.resize((groups_ + far_groups - 1) / far_groups);
  std::size_t end = 0;  // after the last line that has a band
  for (std::size_t k = 0; k < lines; ++k) end = band_of_line_[k] < bands ? k + 1 : end;
  for (std::size_t b = 0; b <= bands; ++b) {
    std::size_t first = end;
    for (std::size_t k = end; k-- > 0;) first = band_of_line_[k] >= b && band_of_line_[k] < bands ? k : first;
    edge_.push_back(static_cast<double>(first));
  }
  for (std::size_t g = 0; g < groups_; ++g) {
    std::uint8_t lowest = 1, highest = 0;
    const std::size_t from = g * lane_count < band_reach ? 0 : g * lane_count - band_reach;
    for (std::size_t k = from; k < std::min(lines, (g + 1) * lane_count + band_reach); ++k) {
      if (band_of_line_[k] == bands) continue;
      lowest = lowest > highest ? band_of_line_[k] : lowest;
      highest = band_of_line_[k];
    }
    lowest_.push_back(lowest);
    highest_.push_back(highest);
  }
  squeeze_.bands = bands;
  squeeze_.edge = edge_.data();
  squeeze_.lowest = lowest_.data();
  squeeze_.highest = highest_.data();
  squeeze_.sums = band_sums_.data();
  squeeze_.far = far_.data();
}

void SynchrosqueezeEngine::reset() noexcept {
  std::fill(ring_.begin(), ring_.end(), 0.0);
  for (Store* store : {&re_, &im_, &fresh_re_, &fresh_im_, &v_re_, &v_im_}) clear(*store);
  for (std::size_t k = 0; k < groups_ * lane_count; ++k) data(target_)[k] = data(line_)[k] + rounding_shift;
  std::fill(band_values.begin(), band_values.end(), 0.0);
  newest_ = fresh_at_ = fresh_samples_ = 0;
  centre = 0;
  first_ = true;
  next = n / 2;
}

void SynchrosqueezeEngine::take(double sample) noexcept {
  if (!std::isfinite(sample)) sample = 0.0;
  newest_ = newest_ + 1 == n ? 0 : newest_ + 1;
  const double leaves = ring_[newest_];
  ring_[newest_] = ring_[newest_ + n] = sample;
  if (!slides_) return;
  Slide all = {.re = data(re_),
               .im = data(im_),
               .turn_re = data(turn_re_),
               .turn_im = data(turn_im_),
               .input = sample - leaves,
               .groups = slide_groups_};
  slide(all);
  Slide fresh = {.re = data(fresh_re_),
                 .im = data(fresh_im_),
                 .turn_re = data(turn_re_) + fresh_at_ * lane_count,
                 .turn_im = data(turn_im_) + fresh_at_ * lane_count,
                 .input = sample,
                 .groups = std::min(fresh_groups_, slide_groups_ - fresh_at_)};
  slide(fresh);
  if (++fresh_samples_ == n) renew();
}

void SynchrosqueezeEngine::renew() noexcept {
  const std::size_t count = std::min(fresh_groups_, slide_groups_ - fresh_at_);
  std::copy_n(fresh_re_.begin(), count, re_.begin() + static_cast<std::ptrdiff_t>(fresh_at_));
  std::copy_n(fresh_im_.begin(), count, im_.begin() + static_cast<std::ptrdiff_t>(fresh_at_));
  clear(fresh_re_);
  clear(fresh_im_);
  fresh_samples_ = 0;
  fresh_at_ = fresh_at_ + count == slide_groups_ ? 0 : fresh_at_ + count;
}

bool SynchrosqueezeEngine::push(double sample) noexcept {
  take(sample);
  if (--next != 0) return false;
  centre = first_ ? 0 : centre + hop;
  first_ = false;
  next = hop;
  column();
  return true;
}

void SynchrosqueezeEngine::column() noexcept {
  clear(band_sums_);
  clear(far_);
  if (slides_) {
    squeeze(squeeze_);
  } else {
    fft_column();
  }
  if (bands != 0) finish_bands();
}

void SynchrosqueezeEngine::fft_column() noexcept {
  // Sample d stands at d modulo N, so that phases are relative to the centre.
  const double* first = ring_.data() + newest_ + 1;
  for (std::size_t j = 0; j < n; ++j) in_[j < n / 2 ? j + n / 2 : j - n / 2] = {first[j] * g_[j], first[j] * slope_[j]};
  fft_.transform(in_.data(), out_.data());
  for (std::size_t k = 0; k < lines; ++k) {
    const std::complex<double> here = out_[k], mirror = std::conj(out_[k == 0 ? 0 : n - k]);
    const std::complex<double> v = 0.5 * (here + mirror), a = mirror - here;
    data(v_re_)[k] = v.real();
    data(v_im_)[k] = v.imag();
    data(a_re_)[k] = a.real();
    data(a_im_)[k] = a.imag();
  }
  reassign(squeeze_);
}

void SynchrosqueezeEngine::finish_bands() noexcept {
  for (std::size_t word = 0; word < far_.size(); ++word) {
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      for (auto marks = static_cast<std::uint64_t>(far_[word].v[lane]); marks != 0; marks &= marks - 1) {
        const std::size_t group = far_groups * word + static_cast<std::size_t>(std::countr_zero(marks));
        const std::size_t k = group * lane_count + lane;
        band_sums_[band_of_line_[line_of(data(target_)[k])]].v[lane] += data(share_)[k];
      }
    }
  }
  for (std::size_t b = 0; b < bands; ++b) {
    const double* v = band_sums_[b].v;
    band_values[b] = scale_ * (((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7])));
  }
}

void SynchrosqueezeEngine::transform(std::complex<double>* out) const noexcept {
  for (std::size_t k = 0; k < lines; ++k) {
    const double sign = data(sign_)[k];
    out[k] = {sign * data(v_re_)[k], sign * data(v_im_)[k]};
  }
}

void SynchrosqueezeEngine::squeezed(std::complex<double>* out) const noexcept {
  std::fill_n(out, lines, std::complex<double>());
  for (std::size_t k = 0; k < lines; ++k) {
    const double weight = data(weight_)[k];
    out[line_of(data(target_)[k])] += std::complex<double>(weight * data(v_re_)[k], weight * data(v_im_)[k]);
  }
}

}  // namespace robomill::signal
