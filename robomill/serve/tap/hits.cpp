#include "robomill/serve/tap/hits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/impact/hits_check.hpp"
#include "robomill/page/thin.hpp"
#include "robomill/serve/error_json.hpp"

namespace robomill::serve {
namespace {

constexpr Eigen::Index most_lines = 1600;

modal::FrfSet thinned(const modal::FrfSet& set) {
  std::vector<Eigen::VectorXd> magnitudes;
  for (const modal::Frf& frf : set.frfs) magnitudes.emplace_back(frf.receptance.cwiseAbs());
  const std::vector<Eigen::Index> keep = page::thin_together(magnitudes, most_lines);
  modal::FrfSet out;
  out.frequency_hz = set.frequency_hz(keep);
  for (const modal::Frf& frf : set.frfs) {
    out.frfs.push_back({.name = frf.name, .receptance = frf.receptance(keep)});
    if (frf.coherence.size() > 0) out.frfs.back().coherence = frf.coherence(keep);
  }
  return out;
}

double coherence_at(const modal::FrfSet& set, const modal::FrfName& name, double frequency_hz) {
  const modal::Frf* const frf = set.find(name);
  if (frf == nullptr || frf->coherence.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  Eigen::Index nearest = 0;
  (set.frequency_hz.array() - frequency_hz).abs().minCoeff(&nearest);
  return frf->coherence(nearest);
}

io::Json peaks_of(const modal::FrfResult& result) {
  io::Json out = io::Json::array();
  for (const modal::FrfGrade& grade : result.grades) {
    for (const modal::FrfPeak& peak : grade.peaks) {
      out.push_back({{"frequency_hz", io::number(peak.frequency_hz)},
                     {"name", to_string(grade.name)},
                     {"receptance_m_per_n", io::number(peak.receptance_m_per_n)},
                     {"coherence", io::number(coherence_at(result.set, grade.name, peak.frequency_hz))}});
    }
  }
  return out;
}

std::size_t values_of(const modal::Hit& hit) {
  return static_cast<std::size_t>(hit.force_n.size()) * (1 + hit.responses.size());
}

io::Json summary_of(const TapHit& taken, std::size_t number) {
  io::Json reasons = io::Json::array();
  for (const std::string& reason : taken.reasons) reasons.push_back(printable(reason));
  return {{"number", number},
          {"file", printable(taken.name)},
          {"accepted", taken.accepted()},
          {"excluded", taken.excluded},
          {"reasons", std::move(reasons)},
          {"force_direction", taken.direction},
          {"peak_force_n", io::positive(taken.peak_force_n)}};
}

/// By itself; what is wrong with it is its own reason.
void judge(TapHit& taken, const modal::Hit& hit, const modal::HitOptions& options, const std::filesystem::path& root) {
  modal::require_sound({hit});
  const modal::HitVerdict verdict = modal::judge_hit(hit, modal::find_pulse(hit.force_n), options);
  taken.reasons = verdict.reasons;
  taken.peak_force_n = verdict.peak_force_n;
  std::optional<modal::FrfResult> alone;
  if (verdict.accepted) {
    try {
      alone = modal::estimate_frfs({hit}, options);
    } catch (const InvalidInput& error) {
      taken.reasons = {rejection_reason(error, root)};
    }
  }
  taken.curves = std::make_shared<const io::Json>(hit_curves(hit, alone));
}

}  // namespace

std::string rejection_reason(const std::exception& error, const std::filesystem::path& root) {
  if (const auto* const input = dynamic_cast<const InvalidInput*>(&error)) {
    const InvalidInput::Parts& parts = input->parts();
    return client_text(parts.rule + (parts.hint.empty() ? "" : ". " + parts.hint), root);
  }
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "not enough memory for this record";
  return client_text(error.what(), root);
}

std::size_t TapHits::size() const {
  const std::lock_guard lock(mutex_);
  return taken_.size();
}

void TapHits::add(TapHit taken, const std::string& reason) {
  taken.reasons = {reason};
  const std::lock_guard lock(mutex_);
  taken_.push_back(std::move(taken));
}

void TapHits::add(TapHit taken, const modal::Hit& hit) {
  try {
    judge(taken, hit, options_, root_);
  } catch (const InvalidInput& error) {
    taken.reasons = {rejection_reason(error, root_)};
  }
  const std::lock_guard lock(mutex_);
  const auto like = std::ranges::find_if(taken_, [](const TapHit& other) { return other.hit != nullptr; });
  if (like != taken_.end() && like->hit->sample_rate_hz != hit.sample_rate_hz) {
    taken.reasons.emplace_back("has another sample rate than the hits before");
  }
  if (values_ + values_of(hit) > most_values) {
    taken.reasons.emplace_back("the test holds as many samples as it may: save it, and begin another");
  }
  const bool is_kept = taken.reasons.empty();
  if (is_kept) taken.hit = std::make_shared<const modal::Hit>(hit);
  taken_.push_back(std::move(taken));
  if (is_kept) values_ += values_of(hit);
}

void TapHits::average() {
  for (;;) {
    std::vector<modal::Hit> hits;
    std::vector<std::size_t> which;
    for (const auto& [number, taken] : accepted()) {
      hits.push_back(*taken.hit);
      which.push_back(number - 1);
    }
    std::optional<modal::FrfResult> result;
    std::string reason;
    try {
      if (!hits.empty()) result = modal::estimate_frfs(hits, options_);
    } catch (const InvalidInput& error) {
      reason = client_text(error.what(), root_);  // the last does not go with the others: lengths, for one
    }
    const std::lock_guard lock(mutex_);
    if (!reason.empty()) {
      TapHit& last = taken_[which.back()];
      last.reasons = {reason};
      values_ -= values_of(*last.hit);
      last.hit.reset();
      continue;
    }
    frf_ = result ? io::parsed(modal::frf_json(thinned(result->set))) : io::Json(nullptr);
    peaks_ = result ? peaks_of(*result) : io::Json::array();
    return;
  }
}

bool TapHits::set_accepted(std::size_t number, bool accepted) {
  const std::lock_guard lock(mutex_);
  if (number < 1 || number > taken_.size()) return false;
  TapHit& taken = taken_[number - 1];
  if (accepted && !taken.hit) {
    throw InvalidInput("accepted", fmt::format("hit {} is rejected by itself: {}", number,
                                               taken.reasons.empty() ? "" : printable(taken.reasons.front())));
  }
  taken.excluded = !accepted && taken.hit != nullptr;
  return true;
}

io::Json TapHits::state() const {
  const std::lock_guard lock(mutex_);
  io::Json list = io::Json::array();
  for (std::size_t i = 0; i < taken_.size(); ++i) list.push_back(summary_of(taken_[i], i + 1));
  const auto good = std::ranges::count_if(taken_, [](const TapHit& taken) { return taken.accepted(); });
  return {{"good", good}, {"taken", std::move(list)}, {"frf", frf_}, {"peaks", peaks_}};
}

io::Json TapHits::about(std::size_t number) const {
  const std::lock_guard lock(mutex_);
  if (number < 1 || number > taken_.size()) return nullptr;
  io::Json out = summary_of(taken_[number - 1], number);
  if (const auto& curves = taken_[number - 1].curves) out.update(*curves);
  return out;
}

std::vector<std::pair<std::size_t, TapHit>> TapHits::accepted() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::size_t, TapHit>> out;
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (taken_[i].accepted()) out.emplace_back(i + 1, taken_[i]);
  }
  return out;
}

}  // namespace robomill::serve
