#include "robomill/coupling/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/modal/directions.hpp"

namespace robomill::coupling {
namespace {

constexpr std::size_t peaks_an_frf = 6;
/// A peak stands so far above the minima beside it: scatter of a measured holder does not.
constexpr double prominence = 1.5;
/// A fit of a prediction, which has no noise, is closer than this to it.
constexpr double poor_fit = 0.02;
/// Peaks further apart than this share of frequency are not the same.
constexpr double same_peak = 0.25;

/// The lowest value on the way from a peak to the next higher one, or to the end.
double minimum_beside(const Eigen::VectorXd& size, Eigen::Index peak, Eigen::Index step) {
  double lowest = size(peak);
  for (Eigen::Index i = peak + step; i >= 0 && i < size.size() && size(i) <= size(peak); i += step) {
    lowest = std::min(lowest, size(i));
  }
  return lowest;
}

/// A curve at frequencies between its lines, by the cubic through the four next to each: about a resonance a straight
/// line would be percents away.
Eigen::VectorXcd interpolate(const Eigen::VectorXd& axis, const Eigen::VectorXcd& values, const Eigen::VectorXd& at) {
  const Eigen::Index points = std::min<Eigen::Index>(4, axis.size());
  Eigen::VectorXcd out = Eigen::VectorXcd::Zero(at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const auto above = std::lower_bound(axis.begin(), axis.end(), at(i)) - axis.begin();
    const Eigen::Index first = std::clamp<Eigen::Index>(above - 2, 0, axis.size() - points);
    for (Eigen::Index j = first; j < first + points; ++j) {
      double weight = 1.0;
      for (Eigen::Index k = first; k < first + points; ++k) {
        if (k != j) weight *= (at(i) - axis(k)) / (axis(j) - axis(k));
      }
      out(i) += weight * values(j);
    }
  }
  return out;
}

/// The prediction at the lines of a measurement: computed there, or between its own lines where the holder was
/// measured.
modal::FrfSet predict_at(const Assembly& assembly, const TipResult& tip, const Eigen::VectorXd& frequency_hz) {
  if (assembly.holder.receptances.frfs.empty()) return tip_frfs(assembly, frequency_hz).frfs;
  modal::FrfSet out{.frequency_hz = frequency_hz, .frfs = {}};
  for (const modal::Frf& frf : tip.frfs.frfs) {
    out.frfs.push_back(
        {.name = frf.name, .receptance = interpolate(tip.frfs.frequency_hz, frf.receptance, frequency_hz)});
  }
  return out;
}

}  // namespace

bool is_round(const modal::FrfSet& set) {
  if (set.frfs.size() != 2) return false;
  const modal::Frf* x = set.find(modal::parse_frf_name("xx"));
  const modal::Frf* y = set.find(modal::parse_frf_name("yy"));
  return x != nullptr && y != nullptr && x->receptance == y->receptance;
}

std::vector<PeakFound> find_peaks(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXcd& receptance) {
  const Eigen::VectorXd size = receptance.cwiseAbs();
  std::vector<PeakFound> out;
  for (Eigen::Index i = 1; i + 1 < size.size(); ++i) {
    if (!(size(i) > size(i - 1) && size(i) >= size(i + 1))) continue;
    if (size(i) < prominence * std::max(minimum_beside(size, i, -1), minimum_beside(size, i, 1))) continue;
    // Newton's parabola through three points of log |H|.
    const double x0 = frequency_hz(i - 1);
    const double x1 = frequency_hz(i);
    const double x2 = frequency_hz(i + 1);
    const double y1 = std::log(size(i));
    const double first = (y1 - std::log(size(i - 1))) / (x1 - x0);
    const double second = ((std::log(size(i + 1)) - y1) / (x2 - x1) - first) / (x2 - x0);
    PeakFound peak{.frequency_hz = x1, .magnitude = size(i)};
    if (std::isfinite(second) && second < 0.0) {
      peak.frequency_hz = std::clamp(0.5 * (x0 + x1 - first / second), x0, x2);
      peak.magnitude = std::exp(y1 + (first + second * (peak.frequency_hz - x0)) * (peak.frequency_hz - x1));
    }
    out.push_back(peak);
  }
  return out;
}

std::vector<TipPeak> tip_peaks(const modal::FrfSet& tip, const modal::FrfSet* measured) {
  const bool round = is_round(tip);
  std::vector<TipPeak> out;
  for (const modal::Frf& frf : tip.frfs) {
    if (frf.name.response != frf.name.excitation) continue;
    if (round && frf.name.response.axis != modal::Axis::x) continue;
    std::vector<PeakFound> seen;
    if (const modal::Frf* other = measured != nullptr ? measured->find(frf.name) : nullptr) {
      seen = find_peaks(measured->frequency_hz, other->receptance);
    }
    std::vector<PeakFound> found = find_peaks(tip.frequency_hz, frf.receptance);
    found.resize(std::min(found.size(), peaks_an_frf));
    for (const PeakFound& peak : found) {
      TipPeak row{.name = frf.name, .frequency_hz = peak.frequency_hz, .receptance_m_per_n = peak.magnitude};
      double nearest = same_peak;
      for (const PeakFound& other : seen) {
        const double apart = std::abs(std::log(other.frequency_hz / peak.frequency_hz));
        if (apart >= nearest) continue;
        nearest = apart;
        row.measured_frequency_hz = other.frequency_hz;
      }
      out.push_back(row);
    }
  }
  return out;
}

TipComparison compare_tip(const Assembly& assembly, const TipResult& tip, const modal::FrfSet& measured,
                          const std::string& name) {
  const Eigen::VectorXd& axis = tip.frfs.frequency_hz;
  modal::FrfSet lines;
  try {
    lines = lines_between(measured, axis(0), axis(axis.size() - 1));
  } catch (const InvalidInput&) {
    throw InvalidInput(
        name, fmt::format("has no line in the predicted range, {:.6g} to {:.6g} Hz", axis(0), axis(axis.size() - 1)));
  }
  const modal::FrfSet predicted = predict_at(assembly, tip, lines.frequency_hz);
  TipComparison out = {.measured = {.frequency_hz = lines.frequency_hz, .frfs = {}}, .error = {}};
  for (const modal::Frf& frf : lines.frfs) {
    const modal::Frf* model = predicted.find(frf.name);
    if (model == nullptr) continue;
    const Eigen::VectorXcd apart = model->receptance - frf.receptance;
    const double size = frf.receptance.norm();
    out.error.push_back({.name = frf.name, .relative = size > 0.0 ? apart.norm() / size : 0.0});
    out.measured.frfs.push_back(frf);
  }
  if (out.measured.frfs.empty()) {
    throw InvalidInput(name, "holds none of the FRFs that are predicted, xx and yy",
                       "Write xx and yy without a number; only FRFs that all stand at one point, as 1x:1x and 1y:1y, "
                       "are taken as the tip's");
  }
  return out;
}

modal::FitResult fit_tip(const modal::FrfSet& tip, const modal::FitOptions& options, Progress& progress) {
  const bool round = is_round(tip);
  const modal::FrfSet x{.frequency_hz = tip.frequency_hz, .frfs = {*tip.find(modal::parse_frf_name("xx"))}};
  modal::FitResult out = modal::fit_modes(round ? x : tip, options, progress);
  if (round) out = modal::with_equal_directions(std::move(out));
  if (out.relative_error > poor_fit) {
    out.warnings.push_back(fmt::format(
        "The modes differ from the predicted FRFs by {:.0f} %. A mode close beyond the last line is the usual "
        "cause: extend frequency.range_hz of the assembly, or end job.band_hz well below that mode.",
        100.0 * out.relative_error));
  }
  // The fit's residual is not noise: it says nothing of how well joint and material are known.
  for (modal::Mode& mode : out.model.modes) {
    mode.frequency_std_hz = mode.damping_ratio_std = std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

}  // namespace robomill::coupling
