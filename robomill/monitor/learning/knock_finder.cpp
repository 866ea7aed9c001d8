#include "robomill/monitor/learning/knock_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/monitor/learning/calm_cells.hpp"
#include "robomill/monitor/orders/hops.hpp"

namespace robomill::monitor {
namespace {

constexpr double past_s = 1.0, rings_s = 0.15, usual_s = 0.5;
constexpr double rises_by = 6.0, falls_to = 1.0 / 3.0;  // of energies of hops
constexpr std::size_t parts = 6;                        // of 0.15 s
constexpr double still_rings = 0.01;                    // of the strongest part: below is noise

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Of the amplitude from the strongest part on.
double decay_of(const std::array<double, parts>& course, double part_s) {
  const auto top = static_cast<std::size_t>(std::ranges::max_element(course) - course.begin());
  std::size_t end = top + 1;
  while (end < parts && course[end] < course[end - 1] && course[end] > still_rings * course[top]) ++end;
  if (end == top + 1) return 0.0;
  return 0.5 * std::log(course[top] / course[end - 1]) / (part_s * static_cast<double>(end - 1 - top));
}

}  // namespace

KnockFinder::KnockFinder(std::size_t cells, double hop_s)
    : past_hops_(hops_of(past_s, hop_s)), longest_hops_(hops_of(rings_s, hop_s)), usual_(cells) {}

void KnockFinder::begin() {
  past_.clear();
  std::ranges::fill(usual_, 0.0);
  peak_ = 0.0;
}

void KnockFinder::add(double level, std::span<const double> cells, const CutTests::Shown& shown) {
  const double energy = level * level;
  const double usual = past_.size() >= past_hops_ ? median_of(past_) : 0.0;
  if (peak_ > 0.0) {
    ++since_;
    peak_ = std::max(peak_, energy);
    if (energy < falls_to * peak_ && since_ + 1 >= longest_hops_) {
      strength_.push_back(std::sqrt(peak_));
      measure(cells, shown);
      peak_ = 0.0;
    } else if (since_ > longest_hops_) {
      peak_ = 0.0;  // it lasts
    }
  } else if (usual > 0.0 && energy > rises_by * usual) {
    peak_ = energy;
    since_ = 0;
  } else {
    const double share = past_.empty() ? 1.0 : usual_s / static_cast<double>(past_hops_);
    for (std::size_t i = 0; i < usual_.size(); ++i) usual_[i] += share * (cells[i] - usual_[i]);
  }
  if (past_.size() >= past_hops_) past_.erase(past_.begin());
  past_.push_back(energy);
}

void KnockFinder::measure(std::span<const double> cells, const CutTests::Shown& shown) {
  std::size_t loudest = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] - usual_[i] > cells[loudest] - usual_[loudest]) loudest = i;
  }
  const Spectrum& like = shown.spectra->spectrum(1, 0);
  const auto line = [&](double cell) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(cell * Machine::cell_hz / like.step_hz), 1,
                                   shown.fast.size() - 2);
  };
  std::size_t at = line(static_cast<double>(loudest));
  for (std::size_t i = at; i <= line(static_cast<double>(loudest + 1)); ++i)
    at = shown.fast[i] > shown.fast[at] ? i : at;
  const double hz = like.peak_hz(at, shown.fast[at - 1], shown.fast[at], shown.fast[at + 1]);
  std::array<double, parts> course = {};
  for (std::size_t c = 0; c < shown.spectra->channels(); ++c) {
    if ((shown.bad_channels >> c & 1U) != 0) continue;
    std::array<double, parts> own = {};
    shown.spectra->course(1, c, hz, 0.0, own);
    for (std::size_t b = 0; b < parts; ++b) course[b] += own[b];
  }
  frequency_hz_.push_back(hz);
  const double decay = decay_of(course, like.seconds / parts);
  if (decay > 0.0) decay_per_s_.push_back(decay);
}

LearntKnocks KnockFinder::found(double seconds) const {
  return {.per_minute = rounded(60.0 * static_cast<double>(strength_.size()) / seconds),
          .strongest = strength_.empty() ? 0.0 : rounded(*std::ranges::max_element(strength_)),
          .frequency_hz = rounded(median_of(frequency_hz_)),
          .decay_per_s = rounded(median_of(decay_per_s_))};
}

}  // namespace robomill::monitor
