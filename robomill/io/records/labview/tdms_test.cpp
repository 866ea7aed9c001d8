#include "robomill/io/records/labview/tdms.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/records/labview/tdms_scale.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace tdms_test {

using test::Folder;
using test::rejection;

constexpr std::uint32_t metadata = 2, new_list = 4, raw_data = 8, interleaved = 32, big = 64, daqmx = 128;
constexpr std::uint32_t usual = metadata | new_list | raw_data;
constexpr std::uint32_t no_data = 0xFFFFFFFF, as_before = 0;

/// Bytes in an order.
class Bytes {
 public:
  explicit Bytes(bool big_endian = false) : big_(big_endian) {}
  Bytes& number(std::uint64_t value, std::size_t width) {
    for (std::size_t i = 0; i < width; ++i) {
      text_ += static_cast<char>(value >> (8 * (big_ ? width - 1 - i : i)) & 0xFF);
    }
    return *this;
  }
  Bytes& u32(std::uint64_t value) { return number(value, 4); }
  Bytes& u64(std::uint64_t value) { return number(value, 8); }
  Bytes& real(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
  Bytes& text(std::string_view value) {
    u32(value.size());
    text_ += value;
    return *this;
  }
  Bytes& add(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  [[nodiscard]] bool is_big() const { return big_; }
  [[nodiscard]] const std::string& get() const { return text_; }

 private:
  bool big_;
  std::string text_;
};

struct Property {
  std::string name;
  std::uint32_t type = 0x0A;
  double number = 0.0;
  std::string text = {};
};
Property text_property(const std::string& name, const std::string& text) {
  return {.name = name, .type = 0x20, .text = text};
}

/// An object of a segment: its path, index and properties.
void object(Bytes& to, const std::string& path, const std::string& index,
            const std::vector<Property>& properties = {}) {
  to.text(path).add(index).u32(properties.size());
  for (const Property& property : properties) {
    to.text(property.name).u32(property.type);
    if (property.type == 0x20) {
      to.text(property.text);
    } else if (property.type == 0x0A) {
      to.real(property.number);
    } else if (property.type == 0x44) {  // whole seconds
      const auto seconds = static_cast<std::uint64_t>(property.number);
      to.u64(to.is_big() ? seconds : 0).u64(to.is_big() ? 0 : seconds);
    } else {
      to.u32(static_cast<std::uint64_t>(property.number));
    }
  }
}
std::string u32_of(std::uint32_t value, bool big_endian = false) {
  return Bytes(big_endian).u32(value).get();
}
std::string index_of(std::uint32_t type, std::uint64_t values, bool big_endian = false) {
  return Bytes(big_endian).u32(20).u32(type).u32(1).u64(values).get();
}

/// @param meta  objects behind their number
std::string segment(std::uint32_t flags, std::uint32_t objects, const std::string& meta, const std::string& raw,
                    std::uint64_t length = 0) {
  const bool big_endian = (flags & big) != 0;
  const std::string all = (flags & metadata) != 0 ? u32_of(objects, big_endian) + meta : "";
  Bytes out(big_endian);
  out.add("TDSm").add(u32_of(flags)).u32(4713);
  out.u64(length == 0 ? all.size() + raw.size() : length).u64(all.size()).add(all).add(raw);
  return out.get();
}

std::vector<Property> waveform(double rate_hz, const std::string& unit) {
  return {{.name = "wf_increment", .number = 1.0 / rate_hz}, text_property("unit_string", unit)};
}

std::string doubles(const std::vector<double>& values, bool big_endian = false) {
  Bytes out(big_endian);
  for (const double value : values) out.real(value);
  return out.get();
}

/// Force and response, three samples each.
std::string small_file(bool big_endian = false, bool rows = false) {
  Bytes meta(big_endian);
  object(meta, "/", u32_of(no_data, big_endian), {text_property("name", "hit")});
  object(meta, "/'Hits'", u32_of(no_data, big_endian));
  object(meta, "/'Hits'/'Hammer'", index_of(0x0A, 3, big_endian), waveform(51200.0, "N"));
  object(meta, "/'Hits'/'Acc'", index_of(0x0A, 3, big_endian), waveform(51200.0, "g"));
  const std::vector<double> values =
      rows ? std::vector<double>{1, -4, 2, -5, 3, -6} : std::vector<double>{1, 2, 3, -4, -5, -6};
  return segment(usual | (big_endian ? big : 0) | (rows ? interleaved : 0), 4, meta.get(), doubles(values, big_endian));
}

TEST(Tdms, ReadsChannelsWithTheirRateAndUnits) {
  const Folder folder;
  for (const bool big_endian : {false, true}) {
    for (const bool rows : {false, true}) {
      const Record record = read_record(folder.file("a.tdms", small_file(big_endian, rows)));
      EXPECT_EQ(record.sample_rate_hz, 51200.0);
      EXPECT_FALSE(record.rate_is_stated);
      EXPECT_EQ(record.names, (std::vector<std::string>{"Hammer", "Acc"}));
      EXPECT_EQ(record.column("Hammer"), Eigen::Vector3d(1, 2, 3));
      EXPECT_EQ(record.column("Acc"), Eigen::Vector3d(-4, -5, -6));
      EXPECT_EQ(record.unit(0), "N");
      EXPECT_EQ(record.unit(1), "g");
      EXPECT_TRUE(record.notes.empty());
    }
  }
  std::string old = small_file();
  old.replace(8, 4, u32_of(4712));
  EXPECT_EQ(read_record(folder.file("a.tdms", old)).column("Hammer"), Eigen::Vector3d(1, 2, 3));
}

// Every type that holds numbers, in both orders of bytes, by the extremes of each.
TEST(Tdms, ReadsEveryTypeOfNumber) {
  const Folder folder;
  struct Type {
    std::uint32_t code;
    std::size_t width;
    std::vector<std::pair<std::uint64_t, double>> values;  ///< bits, number
  };
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  const auto bits_4 = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
  const Type types[] = {{1, 1, {{0x80, -128.0}, {0x7F, 127.0}}},
                        {2, 2, {{0x8000, -32768.0}, {0xFFFE, -2.0}}},
                        {3, 4, {{0x80000000, -2147483648.0}, {5, 5.0}}},
                        {4, 8, {{0xFFFFFFFFFFFFFFFF, -1.0}, {std::uint64_t{1} << 40, 1099511627776.0}}},
                        {5, 1, {{0xFF, 255.0}, {1, 1.0}}},
                        {6, 2, {{0xFFFF, 65535.0}, {0x0102, 258.0}}},
                        {7, 4, {{0xFFFFFFFF, 4294967295.0}, {1, 1.0}}},
                        {8, 8, {{0x8000000000000000, 9223372036854775808.0}, {7, 7.0}}},
                        {9, 4, {{bits_4(-1.5F), -1.5}, {bits_4(3.25F), 3.25}}},
                        {0x0A, 8, {{bits(0.1), 0.1}, {bits(-1e300), -1e300}}},
                        {0x19, 4, {{bits_4(2.5F), 2.5}, {bits_4(-0.125F), -0.125}}},
                        {0x1A, 8, {{bits(0.3), 0.3}, {bits(1e-300), 1e-300}}},
                        {0x21, 1, {{1, 1.0}, {0, 0.0}}}};
  for (const bool big_endian : {false, true}) {
    Bytes meta(big_endian), raw(big_endian);
    for (const Type& type : types) {
      object(meta, fmt::format("/'g'/'{}'", type.code), index_of(type.code, 2, big_endian));
      for (const auto& [value, number] : type.values) raw.number(value, type.width);
    }
    const std::uint32_t order = big_endian ? big : 0;
    const Record record = read_record(folder.file(
        "a.tdms", segment(usual | order, static_cast<std::uint32_t>(std::size(types)), meta.get(), raw.get())));
    ASSERT_EQ(record.columns.size(), std::size(types));
    for (std::size_t i = 0; i < std::size(types); ++i) {
      EXPECT_EQ(record.columns[i](0), types[i].values[0].second) << types[i].code;
      EXPECT_EQ(record.columns[i](1), types[i].values[1].second) << types[i].code;
    }
  }
}

TEST(Tdms, TimesAreSecondsFromTheFirst) {
  const Folder folder;
  for (const bool big_endian : {false, true}) {
    Bytes meta(big_endian), raw(big_endian);
    object(meta, "/'g'/'Time'", index_of(0x44, 3, big_endian));
    object(meta, "/'g'/'Acc'", index_of(0x05, 3, big_endian));
    for (const int i : {0, 1, 2}) {
      const std::uint64_t second = 3'600'000'000 + static_cast<std::uint64_t>(i / 2);
      const std::uint64_t half = i % 2 == 1 ? std::uint64_t{1} << 63 : 0;
      raw.u64(big_endian ? second : half).u64(big_endian ? half : second);
    }
    raw.add("\x01\x02\x03");
    const Record record =
        read_record(folder.file("a.tdms", segment(usual | (big_endian ? big : 0), 2, meta.get(), raw.get())));
    EXPECT_EQ(record.column("Time"), Eigen::Vector3d(0.0, 0.5, 1.0));
    EXPECT_EQ(record.sample_rate_hz, 2.0);
  }
}

TEST(Tdms, ReadsSegmentsThatReuseMetadata) {
  const Folder folder;
  std::string content = small_file();
  content += segment(raw_data, 0, "", doubles({4, 5, 6, -7, -8, -9, 7, 8, 9, -10, -11, -12}));  // two chunks
  Bytes same;
  object(same, "/'Hits'/'Hammer'", u32_of(as_before));
  object(same, "/'Hits'/'Acc'", u32_of(no_data));
  content += segment(metadata | raw_data, 2, same.get(), doubles({10, 11, 12}));
  Bytes other;  // Acc alone, of another type and length
  object(other, "/'Hits'/'Acc'", index_of(0x01, 2), {{.name = "wf_start_offset", .number = 0.0}});
  content += segment(metadata | new_list | raw_data, 1, other.get(), std::string("\x0D\xF2\x0F", 2));
  content += segment(raw_data, 0, "", std::string("\x0F"));  // no whole chunk
  const Record record = read_record(folder.file("a.tdms", content));
  // Of 12 and 12 samples: each 9 of both, then 3 of the first and 3 of the second.
  Eigen::VectorXd force(12), response(12);
  force << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
  response << -4, -5, -6, -7, -8, -9, -10, -11, -12, 13, -14, 15;
  EXPECT_EQ(record.column("Hammer"), force);
  EXPECT_EQ(record.column("Acc"), response);
}

TEST(Tdms, ReadsAnInterruptedFileAsFarAsItGoes) {
  const Folder folder;
  for (const bool rows : {false, true}) {
    std::string content = small_file(false, rows);
    const std::string values = rows ? doubles({4, -7, 5}) : doubles({4, 5, 6, -7, -8});
    content += segment(raw_data | (rows ? interleaved : 0), 0, "", values + "\x01\x02", std::uint64_t{0} - 1);
    const Record record = read_record(folder.file("a.tdms", content));
    const Eigen::Index more = rows ? 1 : 2;
    EXPECT_EQ(record.column("Hammer").size(), 3 + more);
    EXPECT_EQ(record.column("Acc")(3), -7.0);
    EXPECT_EQ(record.column("Hammer")(2 + more), 3.0 + static_cast<double>(more));
    ASSERT_EQ(record.notes.size(), 1U);
    EXPECT_EQ(record.notes[0], "Warning: " + folder.at("a.tdms").string() +
                                   " ends within its last segment: it was not closed or was cut off, and is read as "
                                   "far as it goes");
  }
  // Within the metadata or the lead-in of its last segment.
  for (const std::size_t bytes : {10U, 30U}) {
    const std::string content = small_file() + small_file().substr(0, bytes);
    const Record record = read_record(folder.file("a.tdms", content));
    EXPECT_EQ(record.column("Acc"), Eigen::Vector3d(-4, -5, -6));
    EXPECT_EQ(record.notes.size(), 1U);
  }
}

TEST(Tdms, LeavesOutWhatDoesNotGoTogether) {
  const Folder folder;
  Bytes meta;
  object(meta, "/'a'/'Force'", index_of(0x0A, 2), waveform(51200.0, "N"));
  object(meta, "/'b'/'Force'", index_of(0x0A, 2), waveform(51200.0, "N"));
  object(meta, "/'a'/'Temp'", index_of(0x0A, 1), waveform(10.0, "degC"));
  object(meta, "/'a'/'Log'", Bytes().u32(28).u32(0x20).u32(1).u64(1).u64(6).get());
  object(meta, "/'a'/'It''s'", index_of(0x0A, 2));
  std::vector<Property> late = waveform(51200.0, "g");
  late.push_back({.name = "wf_start_offset", .number = 0.004});
  late.push_back({.name = "wf_start_time", .type = 0x44, .number = 3.6e9});
  object(meta, "/'a'/'Late'", index_of(0x0A, 2), late);
  const std::string raw = doubles({1, 2, 3, 4, 5}) + u32_of(2) + "on" + doubles({6, 7, 8, 9});
  const Record record = read_record(folder.file("a.tdms", segment(usual, 6, meta.get(), raw)));
  EXPECT_EQ(record.names, (std::vector<std::string>{"a/Force", "b/Force", "It's", "Late"}));
  EXPECT_EQ(record.column("b/Force"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(record.column("It's"), Eigen::Vector2d(6, 7));
  EXPECT_EQ(record.left_out, (std::vector<std::string>{"Temp (10 Hz, 1 samples)", "Log (text)"}));
  EXPECT_NE(rejection([&] { (void)record.column("Temp"); }).find("Left out: Temp (10 Hz, 1 samples), Log (text)"),
            std::string::npos);
  EXPECT_NE(rejection([&] { (void)open_samples(folder.at("a.tdms"), {.channels = {"Temp"}}); }).find("Left out: Temp"),
            std::string::npos);
}

// Two recordings that began apart do not stand beside each other.
TEST(Tdms, ChannelsThatStartApartDoNotGoTogether) {
  const Folder folder;
  const auto names = [&](double later_s) {
    Bytes meta;
    for (const char* const name : {"A", "B", "C"}) {
      std::vector<Property> properties = waveform(1000.0, "g");
      properties.push_back({.name = "wf_start_time", .type = 0x44, .number = 3.6e9});
      properties.push_back({.name = "wf_start_offset", .number = name[0] == 'C' ? later_s : 0.0});
      object(meta, fmt::format("/'g'/'{}'", name), index_of(0x05, 2), properties);
    }
    return read_record(folder.file("a.tdms", segment(usual, 3, meta.get(), "\1\2\3\4\5\6")));
  };
  EXPECT_EQ(names(0.0004).names.size(), 3U);
  const Record apart = names(0.25);
  EXPECT_EQ(apart.names, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(apart.left_out, (std::vector<std::string>{"C (1000 Hz, 2 samples, starts 0.25 s later)"}));
}

std::string daqmx_index(std::uint64_t values, const std::vector<std::vector<std::uint32_t>>& scalers,
                        const std::vector<std::uint32_t>& widths, bool digital = false) {
  Bytes out;
  out.u32(digital ? 0x1369 : 0x1269).u32(0xFFFFFFFF).u32(1).u64(values).u32(scalers.size());
  for (const std::vector<std::uint32_t>& scaler : scalers) {  // type, buffer, offset, id
    out.u32(scaler[0]).u32(scaler[1]).u32(scaler[2]).number(0, digital ? 1 : 4).u32(scaler[3]);
  }
  out.u32(widths.size());
  for (const std::uint32_t width : widths) out.u32(width);
  return out.get();
}

TEST(Tdms, ReadsRawDataOfDaqmxByItsScales) {
  const Folder folder;
  const std::vector<Property> linear = {text_property("NI_Scaling_Status", "unscaled"),
                                        {.name = "NI_Number_Of_Scales", .type = 7, .number = 2},
                                        text_property("NI_Scale[1]_Scale_Type", "Linear"),
                                        {.name = "NI_Scale[1]_Linear_Slope", .number = 0.5},
                                        {.name = "NI_Scale[1]_Linear_Y_Intercept", .number = 10.0},
                                        {.name = "NI_Scale[1]_Linear_Input_Source", .type = 7, .number = 0}};
  Bytes meta;
  object(meta, "/'g'/'A'", daqmx_index(2, {{3, 0, 0, 0}}, {4, 1}), linear);  // int16 of the first card
  object(meta, "/'g'/'B'", daqmx_index(2, {{2, 0, 2, 0}}, {4, 1}));          // uint16 beside it
  object(meta, "/'g'/'C'", daqmx_index(2, {{1, 1, 0, 0}}, {4, 1}));          // int8 of the second card
  const std::string chunk = std::string("\xFE\xFF\x01\x80\x02\x00\x03\x00", 8) + "\xFF\x05";
  const Record record =
      read_record(folder.file("a.tdms", segment(usual | daqmx | interleaved, 3, meta.get(), chunk + chunk)));
  EXPECT_EQ(record.column("A"), Eigen::Vector4d(9, 11, 9, 11));
  EXPECT_EQ(record.column("B"), Eigen::Vector4d(32769, 3, 32769, 3));
  EXPECT_EQ(record.column("C"), Eigen::Vector4d(-1, 5, -1, 5));
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("raw counts of the converter, for which the file has no scale: B, C"),
            std::string::npos);
  Bytes lines;  // bits 1 and 9 of rows of two bytes
  object(lines, "/'g'/'0'", daqmx_index(2, {{0, 0, 1, 0}}, {2}, true));
  object(lines, "/'g'/'1'", daqmx_index(2, {{0, 0, 9, 0}}, {2}, true));
  const Record digital = read_record(
      folder.file("b.tdms", segment(usual | daqmx | interleaved, 2, lines.get(), std::string("\x02\x00\x01\x03", 4))));
  EXPECT_EQ(digital.column("1"), Eigen::Vector2d(0, 1));
  EXPECT_EQ(digital.columns[0], Eigen::Vector2d(1, 0));
}

TEST(Tdms, ScalesAreChains) {
  const auto number = [](double value) { return TdmsProperty{.number = value}; };
  const auto text = [](const std::string& value) { return TdmsProperty{.text = value}; };
  TdmsProperties properties;
  properties["NI_Scale[0]_Scale_Type"] = text("Polynomial");  // 1 + 2 x + 3 x^2
  properties["NI_Scale[0]_Polynomial_Coefficients_Size"] = number(3);
  for (const int i : {0, 1, 2}) properties[fmt::format("NI_Scale[0]_Polynomial_Coefficients[{}]", i)] = number(i + 1.0);
  properties["NI_Scale[0]_Polynomial_Input_Source"] = number(4294967295.0);
  properties["NI_Scale[1]_Scale_Type"] = text("Linear");
  properties["NI_Scale[1]_Linear_Slope"] = number(-2);
  properties["NI_Scale[1]_Linear_Y_Intercept"] = number(5);
  properties["NI_Scale[1]_Linear_Input_Source"] = number(0);
  properties["NI_Scale[2]_Scale_Type"] = text("Add");
  properties["NI_Scale[2]_Add_Left_Operand_Input_Source"] = number(0);
  properties["NI_Scale[2]_Add_Right_Operand_Input_Source"] = number(1);
  properties["NI_Scale[3]_Scale_Type"] = text("Subtract");
  properties["NI_Scale[3]_Subtract_Left_Operand_Input_Source"] = number(1);
  properties["NI_Scale[3]_Subtract_Right_Operand_Input_Source"] = number(2);
  TdmsScale scale(properties);
  for (const double x : {-2.0, 0.0, 0.5, 7.0}) {
    const double p = 1 + 2 * x + 3 * x * x, line = 5 - 2 * p;
    const std::vector<TdmsRaw> raw = {{.value = x}};
    EXPECT_DOUBLE_EQ(scale(raw), (p + line) - line);
  }
  properties["NI_Number_Of_Scales"] = number(2);
  const std::vector<TdmsRaw> one = {{.value = 1.0}};
  EXPECT_DOUBLE_EQ(TdmsScale(properties)(one), 5 - 2 * 6.0) << "the last of those stated";
  properties["NI_Scaling_Status"] = text("scaled");
  EXPECT_TRUE(TdmsScale(properties).is_none());
  properties["NI_Scaling_Status"] = text("unscaled");
  const auto says = [&](const std::string& name, const TdmsProperty& value) {
    TdmsProperties changed = properties;
    changed[name] = value;
    return rejection([&] { (void)TdmsScale(changed); });
  };
  EXPECT_NE(says("NI_Scale[1]_Linear_Input_Source", number(1)).find("takes scale 1, which is not before it"),
            std::string::npos);
  EXPECT_NE(says("NI_Scale[1]_Scale_Type", text("Thermocouple")).find("is a Thermocouple, which is not read"),
            std::string::npos);
  EXPECT_NE(says("NI_Number_Of_Scales", number(1e9)).find("at most 64"), std::string::npos);
  EXPECT_NE(says("NI_Scale[0]_Polynomial_Coefficients[1]", text("")).find("lacks NI_Scale[0]_Poly"), std::string::npos);
}

TEST(Tdms, SaysWhatIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& content) {
    return rejection([&] { (void)read_record(folder.file("a.tdms", content)); });
  };
  EXPECT_NE(says("no such thing").find("is no TDMS file"), std::string::npos);
  EXPECT_NE(says("TDSh and more").find("It is the index of one: give the .tdms beside it"), std::string::npos);
  EXPECT_NE(says(small_file() + std::string(40, 'x'))
                .find("no segment begins where the one before it ends, in the segment at byte"),
            std::string::npos);
  const auto one = [&](const std::string& index, const std::string& raw, std::uint32_t flags = usual) {
    Bytes meta;
    object(meta, "/'g'/'A'", index);
    return segment(flags, 1, meta.get(), raw);
  };
  EXPECT_NE(says(one(u32_of(as_before), "1")).find("an index as before, and none before"), std::string::npos);
  EXPECT_NE(
      says(one(index_of(0x0B, 1), std::string(16, '1'))).find("is of type 0xB, which is not read. Write it as double"),
      std::string::npos);
  EXPECT_NE(says(one(index_of(0x0A, 0), "12345678")).find("its raw data is of no channel"), std::string::npos);
  EXPECT_NE(says(one(daqmx_index(1, {{3, 0, 3, 0}}, {4}), "1234", usual | daqmx)).find("a scaler outside its buffer"),
            std::string::npos);
  std::string other = small_file();
  other[8] = 1;
  EXPECT_NE(says(other).find("and 4712 and 4713 are read"), std::string::npos);
  // A small file must not ask for much: a thousand channels of the same byte.
  Bytes meta;
  for (int i = 0; i < 1000; ++i) object(meta, fmt::format("/'g'/'{}'", i), daqmx_index(1, {{0, 0, 0, 0}}, {1}));
  EXPECT_NE(
      says(segment(usual | daqmx, 1000, meta.get(), std::string(1'000'000, '1'))).find("more samples than it can hold"),
      std::string::npos);
  EXPECT_NE(says(one(index_of(0x0A, std::uint64_t{1} << 61), "1234567")).find("holds no channel that can be read"),
            std::string::npos);
}

// Property: what is written is read, however it is cut into segments, chunks and orders.
TEST(Tdms, ReadsWhatIsWritten) {
  const Folder folder;
  for (int seed = 0; seed < test::seeds(1000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const std::size_t channels = 1 + random.index(4);
    std::vector<std::vector<double>> written(channels);
    std::string content;
    for (std::uint64_t left = 1 + random.index(4); left > 0; --left) {
      const bool big_endian = random.index(2) == 0, rows = random.index(2) == 0;
      const std::size_t values = 1 + random.index(5), chunks = 1 + random.index(3);
      Bytes meta(big_endian), raw(big_endian);
      for (std::size_t c = 0; c < channels; ++c) {
        object(meta, fmt::format("/'g'/'{}'", c), index_of(c % 2 == 0 ? 0x0A : 0x02, values, big_endian));
      }
      const auto put = [&](std::size_t c) {
        const double value = std::floor(random.uniform(-30000.0, 30000.0));
        written[c].push_back(value);
        if (c % 2 == 0) {
          raw.real(value);
        } else {
          raw.number(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)), 2);
        }
      };
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (std::size_t k = 0; k < channels * values; ++k) put(rows ? k % channels : k / values);
      }
      content += segment(usual | (big_endian ? big : 0) | (rows ? interleaved : 0),
                         static_cast<std::uint32_t>(channels), meta.get(), raw.get());
    }
    const Record record = read_record(folder.file("a.tdms", content));
    ASSERT_EQ(record.columns.size(), channels);
    for (std::size_t c = 0; c < channels; ++c) {
      ASSERT_EQ(std::vector<double>(record.columns[c].begin(), record.columns[c].end()), written[c]) << seed;
    }
  }
}

// Mutated copies of valid files are read or rejected, never more; what comes is finite and of one length.
TEST(Tdms, SurvivesMutations) {
  const Folder folder;
  Bytes meta;
  object(meta, "/'g'/'A'", daqmx_index(2, {{3, 0, 0, 0}}, {4, 1}));
  object(meta, "/'g'/'B'", daqmx_index(2, {{1, 1, 0, 0}}, {4, 1}));
  const std::string files[] = {small_file() + segment(raw_data, 0, "", doubles({1, 2, 3, 4, 5, 6})),
                               small_file(true, true), segment(usual | daqmx, 2, meta.get(), std::string(40, '\3'))};
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = files[random.index(3)];
    for (std::uint64_t i = random.index(5); i > 0; --i) {
      content[random.index(content.size())] = static_cast<char>(random.index(3) == 0 ? 255 : random.index(256));
    }
    if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
    if (random.index(4) == 0) content += content;
    try {
      const Record record = read_record(folder.file("b.tdms", content));
      for (const Eigen::VectorXd& column : record.columns) {
        ASSERT_TRUE(column.allFinite());
        ASSERT_EQ(column.size(), record.columns.front().size());
      }
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace tdms_test
}  // namespace robomill::io
