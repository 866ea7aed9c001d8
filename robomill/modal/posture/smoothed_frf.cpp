#include "robomill/modal/posture/smoothed_frf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;
/// An error counts over this share of the receptance, and of the matrix where an entry is small beside it.
constexpr double counted_share = 0.05;
constexpr double small_entry = 0.1;
constexpr double usual_damping_ratio = 0.03;

int axis_row(const Dof& dof) {
  return dof.point == 0 && static_cast<int>(dof.axis) <= 3 ? static_cast<int>(dof.axis) - 1 : -1;
}

}  // namespace

PostureData::PostureData(const MeasuredPosture& measured, const PostureModelOptions& options)
    : joints_(measured.joints), modes_(measured.modes) {
  if (modes_) {
    double highest = 0.0, lowest = 1e300;
    for (const Mode& mode : modes_->modes) {
      highest = std::max(highest, mode.frequency_hz);
      lowest = std::min(lowest, mode.frequency_hz);
    }
    for (const Dof& response : modes_->responses) {
      for (const Dof& excitation : modes_->excitations) {
        if (axis_row(response) >= 0 && axis_row(excitation) >= 0)
          known_(axis_row(response) + 3 * axis_row(excitation)) = true;
      }
    }
    low_hz_ = std::max(options.band_low_hz, 0.5 * lowest);
    high_hz_ = std::min(options.band_high_hz, 1.1 * highest);
  } else {
    std::vector<Eigen::Index> lines;
    for (Eigen::Index k = 0; k < measured.frfs.frequency_hz.size(); ++k) {
      const double f = measured.frfs.frequency_hz(k);
      if (f > 0.0 && f >= options.band_low_hz && f <= options.band_high_hz) lines.push_back(k);
    }
    if (lines.size() < 20) {
      throw InvalidInput(measured.name, "has fewer than 20 lines within the band of the postures",
                         "Measure from 5 to 700 Hz, a line a hertz or finer");
    }
    const Eigen::Index count = static_cast<Eigen::Index>(lines.size());
    frequency_hz_.resize(count);
    value_.setZero(9, count);
    for (Eigen::Index k = 0; k < count; ++k)
      frequency_hz_(k) = measured.frfs.frequency_hz(lines[static_cast<std::size_t>(k)]);
    for (const Frf& frf : measured.frfs.frfs) {
      const int row = axis_row(frf.name.response), column = axis_row(frf.name.excitation);
      if (row < 0 || column < 0) continue;
      known_(row + 3 * column) = true;
      for (Eigen::Index k = 0; k < count; ++k) {
        value_(row + 3 * column, k) = frf.receptance(lines[static_cast<std::size_t>(k)]);
      }
    }
    low_hz_ = frequency_hz_(0);
    high_hz_ = frequency_hz_(count - 1);
  }
  if (!known_.any()) {
    throw InvalidInput(measured.name, "has nothing at the tool's tip in x, y or z", "The tip carries no number");
  }
}

Eigen::Matrix<Complex, 9, 1> PostureData::of_modes(Complex s) const {
  Eigen::Matrix<Complex, 9, 1> sum = Eigen::Matrix<Complex, 9, 1>::Zero();
  for (const Mode& mode : modes_->modes) {
    const Complex lambda = pole(mode);
    for (std::size_t r = 0; r < modes_->responses.size(); ++r) {
      for (std::size_t e = 0; e < modes_->excitations.size(); ++e) {
        const int row = axis_row(modes_->responses[r]), column = axis_row(modes_->excitations[e]);
        if (row < 0 || column < 0) continue;
        const Complex residue = mode.right(static_cast<Eigen::Index>(r)) * mode.left(static_cast<Eigen::Index>(e));
        sum(row + 3 * column) += residue / (s - lambda) + std::conj(residue) / (s - std::conj(lambda));
      }
    }
  }
  for (const Residual& residual : modes_->residuals) {
    const int row = axis_row(residual.name.response), column = axis_row(residual.name.excitation);
    if (row >= 0 && column >= 0) sum(row + 3 * column) += residual.stiffness + residual.mass / (s * s);
  }
  return sum;
}

Eigen::Matrix<Complex, 9, 1> PostureData::of_lines(double at_hz, double sigma_hz) const {
  // Each line stands for the cell about it; below the first one the receptance is static.
  const Eigen::Index count = frequency_hz_.size();
  const auto below = [&](double f) {
    const double x = (f - at_hz) / sigma_hz;
    return (2.0 * std::atan(x) - std::atan(0.5 * x)) / pi;
  };
  const auto share_of = [&](double from, double to) { return below(to) - below(from); };
  const double middle = share_of(-frequency_hz_(0), frequency_hz_(0));
  double whole = middle;
  Eigen::Matrix<Complex, 9, 1> sum = middle * value_.col(0).real().cast<Complex>();
  for (Eigen::Index k = 0; k < count; ++k) {
    const double from = k == 0 ? frequency_hz_(0) : 0.5 * (frequency_hz_(k - 1) + frequency_hz_(k));
    const double to = k + 1 == count ? frequency_hz_(k) : 0.5 * (frequency_hz_(k) + frequency_hz_(k + 1));
    const double positive = share_of(from, to), negative = share_of(-to, -from);
    sum += positive * value_.col(k) + negative * value_.col(k).conjugate();
    whole += positive + negative;
  }
  return sum / whole;
}

SmoothedFrf PostureData::smoothed(double share, int lines, bool resolved) const {
  SmoothedFrf out;
  const Eigen::Index count = frequency_hz_.size();
  const double spacing_hz = count > 1 ? (high_hz_ - low_hz_) / static_cast<double>(count - 1) : 0.0;
  // Beyond the last line the integral knows nothing: the lines end where two per cent of the kernel lie there.
  constexpr double widths_to_the_end = 3.0;
  const double last_hz = modes_ ? high_hz_ : high_hz_ / (1.0 + widths_to_the_end * share);
  const double ratio = std::pow(last_hz / low_hz_, 1.0 / (lines - 1));
  std::vector<Eigen::Matrix<Complex, 9, 1>> values;
  const auto put = [&](double at_hz, double sigma_hz, const Eigen::Matrix<Complex, 9, 1>& value) {
    out.s.emplace_back(2.0 * pi * sigma_hz, 2.0 * pi * at_hz);
    values.push_back(value);
  };
  double f = low_hz_;
  if (resolved && !modes_) {
    constexpr double lines_a_width = 2.0;
    for (Eigen::Index k = 0; k < count && share * frequency_hz_(k) < lines_a_width * spacing_hz; ++k) {
      put(frequency_hz_(k), 0.0, value_.col(k));
      f = frequency_hz_(k) + spacing_hz;
    }
  }
  for (; f <= last_hz * (1.0 + 1e-12); f = std::max(f * ratio, f + spacing_hz)) {
    const double sigma_hz = std::max(share * f, spacing_hz);
    put(f, sigma_hz,
        modes_ ? 2.0 * of_modes({2.0 * pi * sigma_hz, 2.0 * pi * f}) - of_modes({4.0 * pi * sigma_hz, 2.0 * pi * f})
               : of_lines(f, sigma_hz));
  }
  if (resolved && !modes_) {
    for (Eigen::Index k = 0; k < count; ++k) {
      if (frequency_hz_(k) > last_hz) put(frequency_hz_(k), 0.0, value_.col(k));
    }
  }
  const Eigen::Index n = static_cast<Eigen::Index>(values.size());
  out.value.setZero(9, n);
  out.weight.setZero(9, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Matrix<Complex, 9, 1>& value = values[static_cast<std::size_t>(i)];
    const double norm = value.norm() / 3.0;
    // Lines farther apart than a mode is wide miss its peak, and so does their integral.
    const Complex at = out.s[static_cast<std::size_t>(i)];
    const double missed =
        at.real() > 0.0 && spacing_hz > 0.0 ? std::exp(-usual_damping_ratio * at.imag() / spacing_hz) : 0.0;
    for (Eigen::Index e = 0; e < 9; ++e) {
      if (!known_(e)) continue;
      out.value(e, i) = value(e);
      out.weight(e, i) = 1.0 / (std::hypot(counted_share, missed) * std::hypot(std::abs(value(e)), small_entry * norm));
    }
  }
  return out;
}

}  // namespace robomill::modal::detail
