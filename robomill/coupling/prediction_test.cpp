#include "robomill/coupling/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"

namespace robomill::coupling {
namespace prediction_test {

TEST(FindPeaks, LieBetweenTheLinesAndNotInTheNoise) {
  Random random(4);
  const Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(400, 101.0, 899.0);  // every 2 Hz
  Eigen::VectorXcd values(axis.size());
  const auto mode = [](double f, double f0, double zeta) {
    return 1.0 / std::complex<double>(1.0 - f * f / (f0 * f0), 2.0 * zeta * f / f0);
  };
  for (Eigen::Index i = 0; i < axis.size(); ++i) {
    const std::complex<double> noise(random.normal(), random.normal());
    const std::complex<double> exact = mode(axis(i), 300.4, 0.02) - 0.3 * mode(axis(i), 650.9, 0.015);
    values(i) = exact + 0.002 * noise * std::abs(exact);
  }
  const std::vector<PeakFound> found = find_peaks(axis, values);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].frequency_hz, 300.4, 0.3);
  EXPECT_NEAR(found[0].magnitude, 25.0, 0.3);
  EXPECT_NEAR(found[1].frequency_hz, 650.9, 0.5);
}

// The second mode of the bar, 1,847 Hz, lies 10 Hz behind the last line: its flank is no mode of the fit.
TEST(FitTip, WarnsWhereAModeStandsCloseBehindTheLastLine) {
  const AssemblyFile file = read_assembly(ROBOMILL_SOURCE_DIR "/examples/joint-bar/rigid.toml");
  const auto fit_of = [&](const Eigen::VectorXd& frequency_hz) {
    return fit_tip(tip_frfs(file.assembly, frequency_hz).frfs, {}, Progress::none());
  };
  EXPECT_TRUE(fit_of(file.frequency_hz).warnings.empty());
  const modal::FitResult fit = fit_of(Eigen::VectorXd::LinSpaced(919, 1.0, 1837.0));
  ASSERT_FALSE(fit.warnings.empty()) << fit.relative_error;
  EXPECT_NE(fit.warnings.back().find("close beyond the last line"), std::string::npos) << fit.relative_error;
}

}  // namespace prediction_test
}  // namespace robomill::coupling
