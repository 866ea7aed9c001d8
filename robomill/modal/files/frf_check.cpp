#include "robomill/modal/files/frf_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/statistics.hpp"

namespace robomill::modal {
namespace {

constexpr Eigen::Index fewest_lines = 16;  // that say something

/// What is odd about an FRF, and the likely reason.
struct Doubt {
  std::string what, why;
};

constexpr const char* name_the_columns =
    "Name the columns and their units: frequency_hz, xx_re_m_per_n, xx_im_m_per_n, or xx_magnitude_um_per_n and "
    "xx_phase_deg, or xx_re_m_per_s2_per_n";

/// A magnitude and an angle, in degrees or radians, in the places of real and imaginary part.
bool looks_polar(const Eigen::VectorXcd& h) {
  const double largest = h.imag().cwiseAbs().maxCoeff();
  const bool radians = largest > 2.5 && largest < 6.3;
  const bool degrees = largest > 90.0 && largest < 360.5;
  return h.real().minCoeff() >= 0.0 && (radians || degrees);
}

bool is_direct(const FrfPart& frf) {
  return !frf.name || frf.name->response == frf.name->excitation;
}

/// Mean of sin φ: of a direct receptance no line is above 0, however noisy the file.
double mean_sine(const Eigen::VectorXcd& h) {
  double sum = 0.0;
  for (const std::complex<double>& value : h) sum += std::abs(value) > 0.0 ? value.imag() / std::abs(value) : 0.0;
  return sum / static_cast<double>(h.size());
}

std::optional<Doubt> doubt(const FrfPart& frf) {
  constexpr double softest_m_per_n = 2e-5;  // 50 N/mm
  constexpr double wrong_way = 0.1;
  const Eigen::VectorXcd& h = frf.values;
  if (h.size() < fewest_lines || h.squaredNorm() == 0.0) return std::nullopt;
  if (looks_polar(h)) return Doubt{"looks like magnitude and phase, not real and imaginary part", ""};
  if (h.imag().cwiseAbs().maxCoeff() == 0.0) {
    return Doubt{"has no imaginary part on any line", "Magnitudes alone are no FRF. "};
  }
  const bool angular =
      frf.name && (static_cast<int>(frf.name->response.axis) > 3 || static_cast<int>(frf.name->excitation.axis) > 3);
  const double middle = median(h.cwiseAbs());
  if (!angular && middle > softest_m_per_n) {
    return Doubt{fmt::format("has a median of {:.3g} m/N: 1 N would move the tool by {:.3g} mm", middle, 1e3 * middle),
                 "It may be an accelerance, or in mm/N or µm/N. "};
  }
  if (is_direct(frf) && mean_sine(h) > wrong_way) {
    return Doubt{"has an imaginary part above 0, where a direct receptance has none",
                 "It may be an accelerance, a sensor that points against the hit, or exp(-iωt). "};
  }
  return std::nullopt;
}

/// Whether a number or its inverse is written with so few digits that somebody chose it.
bool is_round(double value, int digits, double precision) {
  for (const double x : {value, 1.0 / value}) {
    const double scaled = x * std::pow(10.0, digits - 1 - std::floor(std::log10(x)));
    if (std::abs(scaled - std::round(scaled)) < precision * scaled) return true;
  }
  return false;
}

/// Lines whose distance is a round number of Hz only after a division by 2π, which no analyser chooses.
bool looks_angular(double step) {
  constexpr double written = 2e-7;  // of seven digits
  return step > 0.0 && std::isfinite(step) && is_round(step / (2.0 * std::numbers::pi), 3, written) &&
         !is_round(step, 6, written);
}

}  // namespace

void require_frequencies(const Eigen::VectorXd& axis, const std::string& where) {
  constexpr double finest_hz = 2e-3;  // of a record of 500 s
  const Eigen::Index n = axis.size();
  if (n < fewest_lines) return;
  const double step = (axis(n - 1) - axis(0)) / static_cast<double>(n - 1);
  if (!(step > 0.0 && step <= finest_hz)) return;
  const Eigen::VectorXd even = Eigen::VectorXd::LinSpaced(n, axis(0), axis(n - 1));
  if ((axis - even).cwiseAbs().maxCoeff() > 0.5 * step) return;
  throw InvalidInput(
      where,
      fmt::format("looks like a time record, not an FRF: its axis runs from {:.6g} to {:.6g} in steps of "
                  "{:.4g}, which is {:.6g} samples a second",
                  axis(0), axis(n - 1), step, 1.0 / step),
      "Hits become FRFs with robomill frf hits.toml, where [[hits]] names the file and its columns");
}

void check_content(FrfParts& parts) {
  const std::string file = parts.file.string();
  const Eigen::VectorXd& axis = parts.frequency_hz;
  const Eigen::Index lines = axis.size();
  const double step = lines < fewest_lines ? 0.0 : (axis(lines - 1) - axis(0)) / static_cast<double>(lines - 1);
  if (looks_angular(step)) {
    const std::string what = fmt::format(
        "has lines in steps of {:.9g}, which is 2π × {:.4g}: the frequencies look like "
        "rad/s",
        step, step / (2.0 * std::numbers::pi));
    const bool stated = std::ranges::all_of(parts.frfs, [](const FrfPart& frf) { return frf.stated; });
    if (!stated) throw InvalidInput(file, what, "Divide them by 2π: frequency_hz is in Hz");
    parts.notes.push_back(fmt::format("{} {}. Divide them by 2π, or check them before you use the file", file, what));
  }
  for (const FrfPart& frf : parts.frfs) {
    const std::optional<Doubt> odd = doubt(frf);
    if (!odd) continue;
    if (!frf.stated) throw InvalidInput(file, odd->what, odd->why + name_the_columns);
    const std::string name = frf.name ? " (" + to_string(*frf.name) + ")" : "";
    parts.notes.push_back(fmt::format("{}{} {}. {}Check it before you use it", file, name, odd->what, odd->why));
  }
}

}  // namespace robomill::modal
