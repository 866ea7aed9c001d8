#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>

#include "robomill/modal/files/frf_files.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace frf_check_test {

/// One mode of 300 Hz, 3 % and 1e7 N/m.
std::complex<double> receptance(double frequency_hz) {
  const double r = frequency_hz / 300.0;
  return 1e-7 / std::complex<double>(1.0 - r * r, 0.06 * r);
}
std::complex<double> accelerance(double frequency_hz) {
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  return -omega * omega * receptance(frequency_hz);
}

/// Lines from 50 to 600 Hz.
std::string rows(const std::function<std::pair<double, double>(double)>& columns) {
  std::string text;
  for (int line = 0; line < 111; ++line) {
    const double frequency_hz = 50.0 + 5.0 * line;
    const auto [a, b] = columns(frequency_hz);
    char row[100];
    std::snprintf(row, sizeof row, "%.15g,%.15g,%.15g\n", frequency_hz, a, b);
    text += row;
  }
  return text;
}
std::string cartesian(const std::function<std::complex<double>(double)>& frf, double unit = 1.0) {
  return rows([&](double f) { return std::pair(frf(f).real() / unit, frf(f).imag() / unit); });
}
std::string polar(double unit, double angle) {
  return rows([&](double f) { return std::pair(std::abs(receptance(f)) / unit, std::arg(receptance(f)) / angle); });
}
constexpr double deg = std::numbers::pi / 180.0;

class FrfCheck : public ::testing::Test {
 protected:
  FrfFile read(const std::string& text) { return read_frfs({folder_.file("a.csv", text)}); }
  std::string rejection(const std::string& text) {
    return test::rejection([&] { static_cast<void>(read(text)); });
  }
  /// Whether the text is that mode, whatever its columns.
  void expect_receptance(const std::string& text) {
    const FrfSet set = read(text).set;
    for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
      const std::complex<double> expected = receptance(set.frequency_hz(i));
      ASSERT_LT(std::abs(set.frfs[0].receptance(i) - expected), 1e-12 * std::abs(expected)) << text.substr(0, 60);
    }
  }

  test::Folder folder_;
};

TEST_F(FrfCheck, SaysWhatIsTakenForGranted) {
  const FrfFile bare = read(cartesian(receptance));
  EXPECT_TRUE(bare.notes.empty());
  ASSERT_EQ(bare.assumed.size(), 2U);
  EXPECT_EQ(bare.assumed[0].taken, "Hz, real and imaginary part in m/N");
  EXPECT_EQ(bare.assumed[0].file, "a.csv");
  EXPECT_EQ(bare.assumed[1].taken, "xx");
  EXPECT_EQ(bare.assumed[1].key, "--as");
  const FrfFile unitless = read("frequency_hz,xx_re,xx_im\n" + cartesian(receptance));
  ASSERT_EQ(unitless.assumed.size(), 1U);
  EXPECT_EQ(unitless.assumed[0].what, "Unit of FRFs");
  EXPECT_EQ(unitless.assumed[0].taken, "m/N");
  EXPECT_EQ(read("Frequency (Hz),Real,Imag\n" + cartesian(receptance)).assumed.size(), 2U);
  EXPECT_TRUE(read("frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n" + cartesian(receptance)).assumed.empty());
}

TEST_F(FrfCheck, ReadsMagnitudeAndPhase) {
  expect_receptance("frequency_hz,xx_magnitude_m_per_n,xx_phase_deg\n" + polar(1.0, deg));
  expect_receptance("frequency_hz,xx_magnitude_um_per_n,xx_phase_rad\n" + polar(1e-6, 1.0));
  expect_receptance("Frequency (Hz),Magnitude (m/N),Phase (deg)\n" + polar(1.0, deg));
  expect_receptance("freq,Amplitude [um/N],phase [\xC2\xB0]\n" + polar(1e-6, deg));
  expect_receptance("f,mag_mm_per_n,phase_rad\n" + polar(1e-3, 1.0));
  expect_receptance("Frequency,Receptance real (mm/N),Receptance imaginary (mm/N)\n" + cartesian(receptance, 1e-3));
  // The other way round.
  expect_receptance("f,Phase (rad),Magnitude (m/N)\n" +
                    rows([](double f) { return std::pair(std::arg(receptance(f)), std::abs(receptance(f))); }));
  EXPECT_NE(rejection("f,xx_magnitude_m_per_n,xx_phase\n" + polar(1.0, deg)).find("xx_phase_deg"), std::string::npos);
  EXPECT_NE(rejection("Hz,Magnitude (m/N),Phase\n" + polar(1.0, deg)).find("degrees or radians"), std::string::npos);
  EXPECT_NE(rejection("Hz,Magnitude (dB),Phase (deg)\n" + polar(1.0, deg)).find("\"db\", a unit that is not known"),
            std::string::npos);
  EXPECT_NE(rejection("Hz,Real,Phase (deg)\n" + polar(1.0, deg)).find("columns Real and Phase (deg)"),
            std::string::npos);
}

TEST_F(FrfCheck, AccelerancesInWordsBecomeReceptances) {
  expect_receptance("Frequency (Hz),Real ((m/s^2)/N),Imag ((m/s^2)/N)\n" + cartesian(accelerance));
}

TEST_F(FrfCheck, AsksWhereTheGuessIsWrong) {
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = rejection(text);
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_NE(said.find("xx_phase_deg"), std::string::npos) << "does not say what to write: " << said;
  };
  for (const double unit : {1.0, 1e-6}) {
    expect(polar(unit, deg), "looks like magnitude and phase");
    expect(polar(unit, 1.0), "looks like magnitude and phase");
  }
  for (const double unit : {1e-3, 1e-6}) expect(cartesian(receptance, unit), "1 N would move the tool by");
  expect(cartesian(accelerance), "an accelerance");
  expect(cartesian([](double f) { return 1e-6 * accelerance(f); }), "an accelerance");
  expect(cartesian([](double f) { return -receptance(f); }), "a sensor that points against the hit");
  expect(cartesian([](double f) { return std::abs(receptance(f)); }), "no imaginary part");
  expect("f,xx_re,xx_im\n" + cartesian(receptance, 1e-6), "1 N would move the tool by");
}

// What a file states is believed; what is odd about it is said.
TEST_F(FrfCheck, NotesWhatIsOddAboutWhatAFileStates) {
  const auto note = [&](const std::string& text) {
    const FrfFile file = read("frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n" + text);
    return file.notes.empty() ? std::string() : file.notes.front();
  };
  EXPECT_NE(note(cartesian(receptance, 1e-6)).find("a.csv (xx) has a median of"), std::string::npos);
  EXPECT_NE(note(cartesian([](double f) { return -receptance(f); })).find("above 0"), std::string::npos);
  EXPECT_NE(note(cartesian([](double f) { return std::abs(receptance(f)); })).find("no imaginary part"),
            std::string::npos);
  // A cross FRF may have any sign.
  EXPECT_TRUE(
      read("f,xy_re_m_per_n,xy_im_m_per_n\n" + cartesian([](double f) { return -receptance(f); })).notes.empty());
}

// 5 Hz are 31.4159265 rad/s; steps that an analyser chose, 51200/65536 Hz or 1000/1024 Hz, are not taken for angular.
TEST_F(FrfCheck, NotesFrequenciesInRadiansPerSecond) {
  const auto at = [&](double unit) {
    std::string text;
    for (int line = 0; line < 111; ++line) {
      const double frequency_hz = 50.0 + 5.0 * line;
      char row[100];
      std::snprintf(row, sizeof row, "%.9g,%.9g,%.9g\n", frequency_hz * unit, receptance(frequency_hz).real(),
                    receptance(frequency_hz).imag());
      text += row;
    }
    return text;
  };
  const std::string header = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n";
  const std::vector<std::string> notes = read(header + at(2.0 * std::numbers::pi)).notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("2π × 5: the frequencies look like rad/s"), std::string::npos) << notes[0];
  for (const double unit : {1.0, 0.78125, 0.1953125, 0.762939453125 / 5.0, 1.0 / 3.0, std::numbers::e}) {
    EXPECT_TRUE(read(header + at(unit)).notes.empty()) << unit;
  }
}

TEST_F(FrfCheck, ATimeRecordIsNoFrf) {
  const auto record = [](int columns, double step) {
    std::string text;
    for (int i = 0; i < 2000; ++i) {
      char time[40];
      std::snprintf(time, sizeof time, "%.6e", i * step);
      text += time;
      for (int c = 1; c < columns; ++c) text += "\t" + std::to_string(std::sin(0.1 * c * i));
      text += "\n";
    }
    return text;
  };
  for (const int columns : {2, 3, 4, 5}) {
    const std::string said = rejection(record(columns, 1.0 / 51200.0));
    EXPECT_NE(said.find("looks like a time record"), std::string::npos) << said;
    EXPECT_NE(said.find("51200 samples a second"), std::string::npos) << said;
    EXPECT_NE(said.find("robomill frf"), std::string::npos) << said;
  }
  EXPECT_NE(rejection(record(2, 1e-3)).find("looks like a time record"), std::string::npos);
  EXPECT_NE(rejection("time_s,force_n,ax_m_per_s2\n0,1,2\n0.1,2,3\n").find("a column of times"), std::string::npos);
}

}  // namespace frf_check_test
}  // namespace robomill::modal
