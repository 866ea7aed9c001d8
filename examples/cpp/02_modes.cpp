// From receptances to modes: those of a structure that is known, with noise, so that the deviations can be judged.
#include <robomill/base/random.hpp>
#include <robomill/modal/fit.hpp>
#include <robomill/modal/modes.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

using namespace robomill;

int main() {
  const modal::ModalModel truth =
      modal::modes_from_mass({{.frequency_hz = 420.0, .damping_ratio = 0.03, .modal_mass_kg = 1.2},
                              {.frequency_hz = 910.0, .damping_ratio = 0.015, .modal_mass_kg = 0.4}},
                             {{.frequency_hz = 450.0, .damping_ratio = 0.025, .modal_mass_kg = 1.1}});

  // Noise of 1 % of each FRF's highest peak. Where the deviation is given, the fit weights lines with it and the
  // deviations that it gives are those of this noise.
  modal::FrfSet measured = modal::synthesize(truth, Eigen::VectorXd::LinSpaced(1101, 100.0, 1200.0));
  std::erase_if(measured.frfs, [](const modal::Frf& frf) { return frf.name.response != frf.name.excitation; });
  Random random(7);
  for (modal::Frf& frf : measured.frfs) {
    const double deviation = 0.01 * frf.receptance.cwiseAbs().maxCoeff();
    for (std::complex<double>& value : frf.receptance)
      value += std::complex(random.normal(), random.normal()) * deviation / std::numbers::sqrt2;
    frf.deviation = Eigen::VectorXd::Constant(frf.receptance.size(), deviation);
  }

  const modal::FitResult fit = modal::fit_modes(measured, {.band_low_hz = 150.0, .band_high_hz = 1150.0});
  std::printf("%zu modes, fit and data differ by %.2f %%\n", fit.model.modes.size(), 100.0 * fit.relative_error);
  for (const std::string& warning : fit.warnings) std::printf("  %s\n", warning.c_str());
  bool good = fit.model.modes.size() == truth.modes.size();
  for (const modal::Mode& mode : fit.model.modes) {
    const modal::Mode& is = *std::ranges::min_element(
        truth.modes, {}, [&](const modal::Mode& other) { return std::abs(other.frequency_hz - mode.frequency_hz); });
    std::printf("%8.3f +- %.3f Hz (is %g), damping ratio %.4f +- %.4f %% (is %g)\n", mode.frequency_hz,
                mode.frequency_std_hz, is.frequency_hz, 100.0 * mode.damping_ratio, 100.0 * mode.damping_ratio_std,
                100.0 * is.damping_ratio);
    good = good && std::abs(mode.frequency_hz - is.frequency_hz) < 4.0 * mode.frequency_std_hz &&
           std::abs(mode.damping_ratio - is.damping_ratio) < 4.0 * mode.damping_ratio_std;
    // The modulus of a pole is the undamped natural frequency, whatever the damping.
    const double modulus_hz = std::abs(modal::pole(mode)) / (2.0 * std::numbers::pi);
    good = good && std::abs(modulus_hz / mode.frequency_hz - 1.0) < 1e-12;
  }
  return good ? 0 : 1;  // all found, each within four of its deviations
}
