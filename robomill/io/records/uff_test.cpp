#include "robomill/io/records/uff.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace uff_test {

using test::rejection;
using Complex = std::complex<double>;

UffFunction sample(Eigen::Index n, double step, bool is_complex) {
  UffFunction function;
  function.type = is_complex ? 4 : 1;
  function.id[0] = "a function";
  function.response_node = 12;
  function.response_direction = -2;
  function.reference_node = 3;
  function.reference_direction = 6;
  function.is_complex = is_complex;
  function.abscissa_axis = {.type = 18, .label = "Frequency", .unit = "Hz"};
  function.numerator = {.type = 8, .length_exponent = 1, .label = "Displacement", .unit = "m"};
  function.denominator = {.type = 13, .force_exponent = 1, .label = "Force", .unit = "N"};
  function.abscissa = Eigen::VectorXd::LinSpaced(n, 5.0, 5.0 + step * static_cast<double>(n - 1));
  function.values.resize(n);
  Random random(7);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double scale = std::pow(10.0, random.uniform(-12.0, 3.0));
    function.values(i) = {scale * random.normal(), is_complex ? scale * random.normal() : 0.0};
  }
  return function;
}

void expect_same(const UffFunction& read, const UffFunction& written, double tolerance) {
  EXPECT_EQ(read.type, written.type);
  EXPECT_EQ(read.id, written.id);
  EXPECT_EQ(read.response_node, written.response_node);
  EXPECT_EQ(read.response_direction, written.response_direction);
  EXPECT_EQ(read.reference_node, written.reference_node);
  EXPECT_EQ(read.reference_direction, written.reference_direction);
  EXPECT_EQ(read.is_complex, written.is_complex);
  EXPECT_EQ(read.numerator.type, written.numerator.type);
  EXPECT_EQ(read.numerator.unit, written.numerator.unit);
  EXPECT_EQ(read.numerator.length_exponent, written.numerator.length_exponent);
  EXPECT_EQ(read.denominator.force_exponent, written.denominator.force_exponent);
  ASSERT_EQ(read.values.size(), written.values.size());
  for (Eigen::Index i = 0; i < read.values.size(); ++i) {
    EXPECT_NEAR(read.abscissa(i), written.abscissa(i), 1e-9 * std::abs(written.abscissa(i)));
    EXPECT_NEAR(std::abs(read.values(i) - written.values(i)), 0.0, tolerance * std::abs(written.values(i)));
  }
}

TEST(Uff, GivesBackWhatItWrote) {
  for (const bool is_complex : {false, true}) {
    for (const Eigen::Index n : {1, 2, 3, 4, 5, 16, 333}) {
      for (const double step : {0.25, 1.0 / 3.0, 0.0037}) {
        UffFunction uneven = sample(n, step, is_complex);
        if (n > 2) uneven.abscissa(1) += 0.37 * step;
        for (const UffFunction& written : {sample(n, step, is_complex), uneven}) {
          for (const bool binary : {false, true}) {
            const UffFile read = parse_uff(format_uff({written, written}, binary), "f.uff");
            ASSERT_EQ(read.functions.size(), 2u);
            EXPECT_TRUE(read.notes.empty()) << read.notes.front();
            // E20.12 carries 13 significant digits of either part; 58b all bits.
            expect_same(read.functions[1], written, binary ? 0.0 : 1e-12);
          }
        }
      }
    }
  }
}

/// A data set 58 as others write it.
std::string header(int type, int count, int even, const std::string& id = "NONE", const std::string& label = "NONE") {
  return fmt::format(
      "    -1\n    58\n{}\nNONE\n23-Mar-17 19:02:23\nNONE\nNONE\n"
      "    4         0    0         0 NONE               1   1 NONE               2  -3\n"
      "{:10}{:10}{:10} 0.00000E+00  2.50000E-01  0.00000E+00\n"
      "        18    0    0    0 NONE                 Hz\n"
      "        12    0    0    0 {:<20} m/s^2\n"
      "        13    0    0    0 NONE                 N\n"
      "         0    0    0    0 NONE                 NONE\n",
      id, type, count, even, label);
}

UffFunction only(const std::string& content) {
  const UffFile file = parse_uff(content, "f.uff");
  EXPECT_EQ(file.functions.size(), 1u);
  return file.functions.empty() ? UffFunction{} : file.functions.front();
}

std::string with_line_ends(const std::string& content, const std::string& end) {
  std::string text;
  for (const char letter : content) letter == '\n' ? text += end : text += letter;
  return text;
}

TEST(Uff, ReadsLineEndsOfEveryKindAndMix) {
  const std::string body = header(5, 3, 1) + "  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00\n 5.0E+00 6.0E+00\n";
  for (const std::string end : {"\n", "\r\n", "\r", "\r\r\n"}) {
    for (const std::string last : {"    -1\n", "    -1\r\n", "\r\n    -1", "    -1   ", "-1", ""}) {
      const UffFunction function = only(with_line_ends(body, end) + last);
      ASSERT_EQ(function.values.size(), 3);
      EXPECT_EQ(function.values(2), Complex(5.0, 6.0));
      EXPECT_EQ(function.abscissa(2), 0.5);
      EXPECT_EQ(function.reference_direction, -3);
    }
  }
}

TEST(Uff, ReadsGluedNumbers) {
  const UffFunction glued =
      only(header(2, 8, 1) + "-1.00000E+00-2.00000E+00-3.00000E+00-4.00000E+00-5.00000E+00-6.00000E+00\n" +
           " 1.00000E-10-1.50000E-101\n    -1\n");
  EXPECT_EQ(glued.values(5).real(), -6.0);
  EXPECT_EQ(glued.values(7).real(), -1.5e-101);
  // No sign and no blank between them: only the columns separate them.
  const UffFunction packed = only(header(2, 3, 1) + "12345.678901229876.543210935555.5555555\n    -1\n");
  EXPECT_EQ(packed.values(1).real(), 29876.5432109);
  // Columns of another width: only the signs separate them.
  const UffFunction odd = only(header(4, 3, 1) + "-1.25E+00-2.5D-03+3.75e+10\n    -1\n");
  EXPECT_EQ(odd.values(1).real(), -2.5e-3);
  EXPECT_EQ(odd.values(2).real(), 3.75e10);
}

TEST(Uff, ReadsFortranExponents) {
  const UffFunction function = only(header(4, 4, 1) + "  1.250000000000D+00  2.5d-03  -1.50000-101  7.5E+2\n    -1\n");
  EXPECT_EQ(function.values(0).real(), 1.25);
  EXPECT_EQ(function.values(1).real(), 2.5e-3);
  EXPECT_EQ(function.values(2).real(), -1.5e-101);
  EXPECT_EQ(function.values(3).real(), 750.0);
}

TEST(Uff, ReadsTextThatIsNotAscii) {
  const std::string data = " 1.0E+00 2.0E+00\n    -1\n";
  const UffFunction utf8 = only(header(2, 2, 1,
                                       "Pr\xC3\xBC"
                                       "fling",
                                       "a [m/s\xC2\xB2]") +
                                data);
  EXPECT_EQ(utf8.id[0],
            "Pr\xC3\xBC"
            "fling");
  EXPECT_EQ(utf8.numerator.label, "a [m/s\xC2\xB2]");
  const UffFunction latin1 = only(header(2, 2, 1,
                                         "Pr\xFC"
                                         "fling",
                                         "a [m/s\xB2]") +
                                  data);
  EXPECT_EQ(latin1.numerator.type, 12);
  EXPECT_EQ(latin1.numerator.unit, "m/s^2");
  // Names of entities beyond ASCII, and a "-1" within the header's text.
  std::string named = header(2, 2, 1, "    -1") + data;
  named.replace(named.find(" NONE               1"), 11, " S\xC3\xA4ule\xC2\xB2    ");
  const UffFunction function = only(named);
  EXPECT_EQ(function.response_node, 1);
  EXPECT_EQ(function.reference_node, 2);
  EXPECT_EQ(function.id[0], "-1");
}

TEST(Uff, ReadsAHalfFilledLastLineAndCountsThatAreWrong) {
  const std::string data = " 1.0E+00 2.0E+00 3.0E+00 4.0E+00 5.0E+00 6.0E+00\n 7.0E+00                       \n";
  EXPECT_EQ(only(header(2, 7, 1) + data + "    -1\n").values.size(), 7);
  const UffFile fewer = parse_uff(header(2, 2000000000, 1) + data + "    -1", "f.uff");
  EXPECT_EQ(fewer.functions.front().values.size(), 7);
  ASSERT_EQ(fewer.notes.size(), 1u);
  EXPECT_EQ(fewer.notes.front(), "f.uff: the data set that ends in line 15 says 2000000000 values and holds 7");
  const UffFile more = parse_uff(header(2, 5, 1) + data + "    -1\n", "f.uff");
  EXPECT_EQ(more.functions.front().values.size(), 5);
  EXPECT_EQ(more.notes.size(), 1u);
}

TEST(Uff, ReadsAnUnevenAbscissa) {
  const UffFunction single = only(header(5, 2, 0) + " 1.0E+00 2.0E+00 3.0E+00 4.0E+00 5.0E+00 6.0E+00\n    -1\n");
  EXPECT_EQ(single.abscissa(1), 4.0);
  EXPECT_EQ(single.values(1), Complex(5.0, 6.0));
  const std::string row = fmt::format("{:13.5E}{:20.12E}{:20.12E}\n", -4.0, -5.0, -6.0);
  const UffFunction twice = only(header(6, 2, 0) + row + row + "    -1\n");
  EXPECT_EQ(twice.abscissa(1), -4.0);
  EXPECT_EQ(twice.values(1), Complex(-5.0, -6.0));
}

TEST(Uff, SkipsDataSetsThatItDoesNotKnow) {
  const std::string unknown = "    -1\n    15\n         1         0         0         0  0.0 0.0 0.0\n    -1\n";
  const std::string text = header(2, 1, 1) + " 1.0E+00\n    -1\n";
  const UffFile file = parse_uff(unknown + text + unknown + "    -1\n  2411\nanything\n    -1\n" + text, "f.uff");
  EXPECT_EQ(file.functions.size(), 2u);
  EXPECT_EQ(file.notes,
            (std::vector<std::string>{"f.uff: skipped 2 of data set 15", "f.uff: skipped 1 of data set 2411"}));
  EXPECT_EQ(file.functions.front().line, 6u);
}

TEST(Uff, ReadsUnits) {
  const std::string units =
      "    -1\n   164\n         5mm (milli-newton)           2\n"
      "  1.00000000000000000D+03  1.00000000000000000D+03  1.00000000000000000D+00\n  2.73D+02\n    -1\n";
  const std::string text = header(2, 1, 1) + " 1.0E+00\n    -1\n";
  const UffFile file = parse_uff(text + units + text, "f.uff");
  ASSERT_EQ(file.functions.size(), 2u);
  EXPECT_EQ(file.functions[0].length_factor, 1.0);
  EXPECT_EQ(file.functions[1].length_factor, 1000.0);
  EXPECT_EQ(file.functions[1].force_factor, 1000.0);
}

template <class Float>
std::string bytes(const std::vector<double>& numbers, bool big_endian) {
  std::string out;
  for (const double number : numbers) {
    const auto part = static_cast<Float>(number);
    std::string one(reinterpret_cast<const char*>(&part), sizeof(part));
    if (big_endian != (std::endian::native == std::endian::big)) one.assign(one.rbegin(), one.rend());
    out += one;
  }
  return out;
}

std::string binary_header(int order, int bytes_said, int type, int count, int even, const std::string& end) {
  std::string text = header(type, count, even);
  text.replace(
      text.find("    58\n"), 7,
      fmt::format("    58b{:6}     2          11{:12}     0     0           0           0\n", order, bytes_said));
  return with_line_ends(text, end);
}

TEST(Uff, ReadsBinaryOfEitherByteOrderAndPrecision) {
  // The first double begins with the byte 0x0A in one order and ends with it in the other: like a line's end.
  const std::vector<double> numbers = {std::bit_cast<double>(std::uint64_t{0x0A0000000000000D}), -2.5, 3.25, 4.125};
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const std::string close : {"    -1\n", "\n    -1\n", "\r\n    -1\r\n", ""}) {
      for (const int order : {1, 2}) {
        const UffFunction twice =
            only(binary_header(order, 32, 6, 2, 1, end) + bytes<double>(numbers, order == 2) + close);
        ASSERT_EQ(twice.values.size(), 2);
        EXPECT_EQ(twice.values(0), Complex(numbers[0], -2.5));
        EXPECT_EQ(twice.values(1), Complex(3.25, 4.125));
        const UffFunction single =
            only(binary_header(order, 16, 2, 4, 1, end) + bytes<float>(numbers, order == 2) + close);
        EXPECT_EQ(single.values(3).real(), 4.125);
      }
    }
  }
}

TEST(Uff, ReadsAnUnevenBinaryAbscissaOfEitherPrecision) {
  const std::string close = "    -1\n";
  const UffFunction twice =
      only(binary_header(1, 0, 4, 2, 0, "\n") + bytes<double>({1.5, 10.0, 2.5, 20.0}, false) + close);
  EXPECT_EQ(twice.abscissa(1), 2.5);
  EXPECT_EQ(twice.values(1).real(), 20.0);
  const std::string mixed =
      bytes<float>({1.5}, true) + bytes<double>({10.0}, true) + bytes<float>({2.5}, true) + bytes<double>({20.0}, true);
  const UffFunction once = only(binary_header(2, 24, 4, 2, 0, "\n") + mixed + close);
  EXPECT_EQ(once.abscissa(1), 2.5);
  EXPECT_EQ(once.values(1).real(), 20.0);
}

TEST(Uff, GoesOnAfterABinaryDataSetThatCountsItsBytesWrongly) {
  const std::string set = binary_header(1, 16, 6, 2, 1, "\n") + bytes<double>({1.0, 2.0, 3.0, 4.0}, false) + "    -1\n";
  const UffFile file = parse_uff(set + set, "f.uff");
  EXPECT_EQ(file.functions.size(), 2u);
  EXPECT_EQ(file.notes.size(), 2u);
  EXPECT_EQ(file.functions[1].values(1), Complex(3.0, 4.0));
}

TEST(Uff, SkipsFloatingPointOfOtherMachines) {
  std::string set = binary_header(1, 8, 4, 1, 1, "\n") + bytes<double>({1.0}, false) + "    -1\n";
  set.replace(set.find("     2          11"), 6, "     3");
  const UffFile file = parse_uff(set, "f.uff");
  EXPECT_TRUE(file.functions.empty());
  EXPECT_EQ(file.notes.size(), 1u);
}

TEST(Uff, RejectsWhatItCannotRead) {
  const auto says = [](const std::string& content) { return rejection([&] { (void)parse_uff(content, "f.uff"); }); };
  EXPECT_NE(says("frequency_hz,xx\n1,2\n").find("f.uff:1: does not begin a universal data set"), std::string::npos);
  EXPECT_EQ(says("    -1\n"), "f.uff: holds no universal data set");
  EXPECT_NE(says("    -1\nhello\n").find("f.uff:2: \"hello\"; is no number of a universal data set"),
            std::string::npos);
  EXPECT_NE(says("    -1\n    58\nNONE\n").find("ends within a header"), std::string::npos);
  EXPECT_NE(says(header(3, 1, 1) + " 1.0\n    -1\n").find("f.uff:9: \"3\"; is no ordinate data type"),
            std::string::npos);
  EXPECT_NE(says(header(2, 0, 1) + "    -1\n").find("has no values"), std::string::npos);
  EXPECT_NE(
      says(header(2, 3, 1) + " 1.0 ***** 3.0\n    -1\n").find("f.uff:14: \"1.0 ***** 3.0\"; is no line of numbers"),
      std::string::npos);
  EXPECT_NE(says(header(2, 3, 1) + " 1.0 NaN 3.0\n    -1\n").find("value 2 of the function above is no finite"),
            std::string::npos);
  EXPECT_NE(says(header(2, 2000000000, 1) + " 1.0 2.0\n").find("ends within the data"), std::string::npos);
  EXPECT_NE(says(binary_header(1, 2000000000, 4, 250000000, 1, "\n") + "12345678").find("8 of 2000000000 bytes"),
            std::string::npos);
}

TEST(Uff, SurvivesMutations) {
  std::vector<std::string> originals;
  for (const bool binary : {false, true}) {
    UffFunction uneven = sample(9, 0.5, true);
    uneven.abscissa(3) += 0.1;
    originals.push_back(format_uff({sample(9, 0.5, true), sample(8, 0.1, false), uneven}, binary));
  }
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = originals[random.index(2)];
    for (std::uint64_t i = random.index(8); i > 0; --i) {
      const std::size_t place = random.index(content.size());
      const char* const likely = "-1 0925.eE+b\n\r\0";
      switch (random.index(4)) {
        case 0:
          content[place] = static_cast<char>(random.index(256));
          break;
        case 1:
          content[place] = likely[random.index(14)];
          break;
        case 2:
          content.erase(place, random.index(100));
          break;
        default:
          content.insert(place, content.substr(random.index(content.size()), random.index(100)));
      }
      if (content.empty()) content = "\n";
    }
    if (random.index(3) == 0) content.resize(random.index(content.size()) + 1);
    try {
      for (const UffFunction& function : parse_uff(content, "f.uff").functions) {
        ASSERT_EQ(function.abscissa.size(), function.values.size());
        ASSERT_TRUE(function.values.allFinite());
      }
    } catch (const InvalidInput& error) {
      EXPECT_EQ(std::string(error.what()).find("f.uff"), 0u) << error.what();
    }
  }
}

}  // namespace uff_test
}  // namespace robomill::io
