#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/uff.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

/// Walks over lines that end with \n, \r\n, \r or \r\r\n, mixed as they come.
class Lines {
 public:
  explicit Lines(std::string_view data) : data_(data) {}

  [[nodiscard]] bool at_end() const { return position_ >= data_.size(); }
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] std::string_view rest() const { return data_.substr(position_); }

  std::string_view next() {
    const std::size_t begin = position_;
    const std::size_t stop = std::min(data_.find_first_of("\r\n", begin), data_.size());
    position_ = stop;
    std::size_t returns = 0;
    while (position_ + returns < data_.size() && data_[position_ + returns] == '\r') ++returns;
    bare_return_ = returns > 0 && (position_ + returns >= data_.size() || data_[position_ + returns] != '\n');
    position_ = std::min(position_ + (bare_return_ ? 1 : returns + 1), data_.size());
    ++number_;
    return data_.substr(begin, stop - begin);
  }
  /// The last line before binary data, whose first byte may look like a line's end.
  std::string_view next_before_binary() {
    const std::size_t begin = position_;
    const bool bare_return = bare_return_;
    const std::size_t stop = std::min(data_.find_first_of("\r\n", begin), data_.size());
    const bool pair = data_.substr(stop).starts_with("\r\n") && !bare_return;
    position_ = std::min(stop + (pair ? 2 : 1), data_.size());
    ++number_;
    return data_.substr(begin, stop - begin);
  }
  [[nodiscard]] std::string_view peek() const {
    Lines copy = *this;
    return copy.next();
  }
  void skip_bytes(std::size_t count) { position_ = std::min(position_ + count, data_.size()); }

 private:
  std::string_view data_;
  std::size_t position_ = 0, number_ = 0;
  bool bare_return_ = false;
};

bool is_delimiter(std::string_view line) {
  return trimmed(line) == "-1";
}

std::optional<int> parse_int(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  int number = 0;
  const std::from_chars_result read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<std::string_view> tokens(std::string_view line) {
  std::vector<std::string_view> found;
  while (!(line = trimmed(line)).empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    found.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return found;
}

/// Also Fortran's three-digit exponents, which go without a letter: 1.25000-101.
std::optional<double> parse_fortran(std::string_view text) {
  if (const std::optional<double> number = parse_number(text)) return number;
  if (text.size() < 6) return std::nullopt;
  const std::size_t sign = text.size() - 4;
  if ((text[sign] != '+' && text[sign] != '-') || text[sign - 1] > '9' || text[sign - 1] < '.') return std::nullopt;
  return parse_number(std::string(text.substr(0, sign)) + "e" + std::string(text.substr(sign)));
}

/// Every character beyond ASCII becomes one '?', so that columns counted in characters are columns counted in bytes.
std::string one_byte_a_character(std::string_view line) {
  std::string text;
  for (const char letter : line) {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte >= 0x80 && byte < 0xC0 && !text.empty() && text.back() == '?') continue;
    text += byte < 0x80 ? letter : '?';
  }
  return text;
}

std::string_view columns(std::string_view line, std::size_t begin, std::size_t width) {
  return begin < line.size() ? line.substr(begin, width) : std::string_view();
}

/// What the numbers of one data set 58 look like.
struct Layout {
  int data_type = 0;  ///< 2 real single, 4 real double, 5 complex single, 6 complex double
  bool even = true;
  std::size_t count = 0;
  double first = 0.0, step = 0.0;

  [[nodiscard]] bool is_complex() const { return data_type >= 5; }
  [[nodiscard]] bool is_double() const { return data_type == 4 || data_type == 6; }
  [[nodiscard]] std::size_t ordinates() const { return is_complex() ? 2 : 1; }
  [[nodiscard]] std::size_t per_point() const { return ordinates() + (even ? 0 : 1); }
};

/// The header line of a 58b.
struct Binary {
  int byte_order = 1, float_format = 2, lines = 11;
  std::size_t bytes = 0;
};

class Reader {
 public:
  Reader(std::string_view content, const std::string& where, const UffTake& take)
      : lines_(content), where_(where), take_(take) {}

  std::vector<std::string> read() {
    while (!lines_.at_end()) {
      const std::string_view line = lines_.next();
      if (is_delimiter(line)) {
        // "-1" ends one data set and begins the next; what follows shows which it is.
        if (lines_.at_end() || is_delimiter(lines_.peek())) continue;
        read_data_set();
      } else if (!trimmed(line).empty() && !began_) {
        throw error("does not begin a universal data set", "A universal file begins with a line of -1");
      }
    }
    if (!began_) throw InvalidInput(where_, "holds no universal data set");
    std::sort(skipped_.begin(), skipped_.end());
    for (const auto& [number, count] : skipped_) {
      note(fmt::format("skipped {} of data set {}", count, number));
    }
    return std::move(notes_);
  }

 private:
  [[nodiscard]] InvalidInput error(std::string rule, std::string hint = {}, std::string_view value = {}) const {
    return InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", where_, lines_.number()),
                                            .value = value.empty() ? "" : fmt::format("\"{}\"", value),
                                            .rule = std::move(rule),
                                            .hint = std::move(hint)});
  }
  void note(const std::string& text) { notes_.push_back(where_ + ": " + text); }

  void read_data_set() {
    const std::string_view header = lines_.next();
    const std::string_view number_text = trimmed(header).substr(0, trimmed(header).find_first_of(" \tbB"));
    const std::optional<int> number = parse_int(number_text);
    if (!number || *number < 0) {
      if (!began_) throw error("is no number of a universal data set", {}, trimmed(header).substr(0, 40));
      return;
    }
    began_ = true;
    if (*number == 58) {
      const std::string_view after = trimmed(header).substr(number_text.size());
      const bool binary = !after.empty() && (after.front() == 'b' || after.front() == 'B');
      read_function(binary ? read_binary_header(after.substr(1)) : std::nullopt);
    } else if (*number == 164) {
      read_units();
    } else {
      skip(std::to_string(*number));
    }
  }

  /// On to the "-1" that ends the data set.
  void skip(const std::string& number) {
    const auto known = std::find_if(skipped_.begin(), skipped_.end(), [&](const auto& s) { return s.first == number; });
    if (known != skipped_.end()) {
      ++known->second;
    } else {
      skipped_.emplace_back(number, 1);
    }
    while (!lines_.at_end() && !is_delimiter(lines_.peek())) lines_.next();
  }

  std::optional<Binary> read_binary_header(std::string_view fields) const {
    const std::vector<std::string_view> found = tokens(fields);
    Binary binary;
    const auto field = [&](std::size_t i, int otherwise) {
      return i < found.size() ? parse_int(found[i]).value_or(otherwise) : otherwise;
    };
    binary.byte_order = field(0, 1);
    binary.float_format = field(1, 2);
    binary.lines = field(2, 11);
    binary.bytes = static_cast<std::size_t>(std::max(field(3, 0), 0));
    return binary;
  }

  /// Factors that turn the file's units into SI: file / factor = SI.
  void read_units() {
    std::vector<std::string_view> header, factors;
    if (!lines_.at_end() && !is_delimiter(lines_.peek())) header = tokens(lines_.next());
    if (!lines_.at_end() && !is_delimiter(lines_.peek())) factors = tokens(lines_.next());
    std::array<double, 2> values{};
    for (std::size_t i = 0; i < 2; ++i) {
      const std::optional<double> value = i < factors.size() ? parse_fortran(factors[i]) : std::nullopt;
      if (!value || !std::isfinite(*value) || *value <= 0.0) {
        note(fmt::format("the unit factors in line {} cannot be read and are left out", lines_.number()));
        return;
      }
      values[i] = *value;
    }
    length_factor_ = values[0];
    force_factor_ = values[1];
    has_units_ = true;
  }

  void read_function(const std::optional<Binary>& binary) {
    if (binary && binary->float_format != 2) {
      note(fmt::format("the data set in line {} has floating-point format {}; only IEEE 754 (2) is read",
                       lines_.number(), binary->float_format));
      return;
    }
    UffFunction function;
    function.line = lines_.number();
    function.length_factor = length_factor_;
    function.force_factor = force_factor_;
    function.has_units = has_units_;
    for (std::string& id : function.id) id = std::string(trimmed(header_line()));
    read_degrees_of_freedom(function);
    const Layout layout = read_layout();
    function.is_complex = layout.is_complex();
    read_axis(function.abscissa_axis);
    read_axis(function.numerator);
    read_axis(function.denominator);
    const int extra = binary ? std::clamp(binary->lines - 11, 0, 1000) : 0;
    for (int i = 0; i < extra; ++i) header_line();
    if (lines_.at_end()) throw error("the file ends before its data");
    binary ? lines_.next_before_binary() : lines_.next();
    const std::vector<double> numbers = binary ? read_binary(layout, *binary) : read_text(layout);
    take(numbers, layout, function);
    if (!lines_.at_end() && !trimmed(lines_.peek()).empty() && !is_delimiter(lines_.peek())) {
      note(fmt::format("line {} belongs to no data set and is left out", lines_.number() + 1));
    }
    take_(std::move(function));
  }

  std::string_view header_line() {
    if (lines_.at_end()) throw error("the file ends within a header");
    return lines_.next();
  }

  void read_degrees_of_freedom(UffFunction& function) {
    const std::string line = one_byte_a_character(header_line());
    const std::array<std::pair<std::size_t, std::size_t>, 5> places = {{{0, 5}, {41, 10}, {51, 4}, {66, 10}, {76, 4}}};
    std::array<std::optional<int>, 5> fields;
    for (std::size_t i = 0; i < 5; ++i) fields[i] = parse_int(columns(line, places[i].first, places[i].second));
    if (!std::all_of(fields.begin(), fields.end(), [](const auto& f) { return f.has_value(); })) {
      // Not in its columns: names without blanks leave ten words, no names at all eight.
      const std::vector<std::string_view> words = tokens(line);
      const bool named = words.size() == 10;
      if (!named && words.size() != 8) throw error("are no degrees of freedom (record 6)", {}, line.substr(0, 80));
      const std::array<std::size_t, 5> at =
          named ? std::array<std::size_t, 5>{0, 5, 6, 8, 9} : std::array<std::size_t, 5>{0, 4, 5, 6, 7};
      for (std::size_t i = 0; i < 5; ++i) fields[i] = parse_int(words[at[i]]);
    }
    const std::array<int*, 5> members = {&function.type, &function.response_node, &function.response_direction,
                                         &function.reference_node, &function.reference_direction};
    for (std::size_t i = 0; i < 5; ++i) {
      if (!fields[i]) throw error("are no degrees of freedom (record 6)", {}, line.substr(0, 80));
      *members[i] = *fields[i];
    }
  }

  Layout read_layout() {
    const std::string line = one_byte_a_character(header_line());
    std::vector<std::string_view> fields = tokens(line);
    const bool words = fields.size() >= 5 && parse_int(fields[0]) && parse_int(fields[1]) && parse_int(fields[2]);
    if (!words) {
      fields.clear();
      for (const auto& [begin, width] : {std::pair{0, 10}, {10, 10}, {20, 10}, {30, 13}, {43, 13}}) {
        fields.push_back(trimmed(columns(line, static_cast<std::size_t>(begin), static_cast<std::size_t>(width))));
      }
    }
    const std::optional<int> type = parse_int(fields[0]), count = parse_int(fields[1]), even = parse_int(fields[2]);
    if (!type || !count || !even || *count < 0) throw error("is no data form (record 7)", {}, line.substr(0, 80));
    if (*type != 2 && *type != 4 && *type != 5 && *type != 6) {
      throw error("is no ordinate data type; must be 2, 4, 5 or 6", {}, fields[0]);
    }
    if (*count == 0) throw error("the function has no values");
    Layout layout{.data_type = *type, .even = *even != 0, .count = static_cast<std::size_t>(*count)};
    if (layout.even) {
      const std::optional<double> first = parse_fortran(fields[3]), step = parse_fortran(fields[4]);
      if (!first || !step || !std::isfinite(*first) || !std::isfinite(*step)) {
        throw error("is no abscissa (record 7)", {}, line.substr(0, 80));
      }
      layout.first = *first;
      layout.step = *step;
    }
    return layout;
  }

  void read_axis(UffAxis& axis) {
    const std::string_view line = header_line();
    std::array<std::optional<int>, 3> numbers = {parse_int(columns(line, 0, 10)), parse_int(columns(line, 10, 5)),
                                                 parse_int(columns(line, 15, 5))};
    std::string_view labels = columns(line, 25, std::string_view::npos);
    if (!numbers[0] || !numbers[1] || !numbers[2]) {
      const std::vector<std::string_view> words = tokens(line);
      for (std::size_t i = 0; i < 3; ++i) numbers[i] = i < words.size() ? parse_int(words[i]) : std::nullopt;
      if (words.size() > 4) labels = line.substr(static_cast<std::size_t>(words[4].data() - line.data()));
    }
    axis.type = numbers[0].value_or(0);
    axis.length_exponent = numbers[1].value_or(0);
    axis.force_exponent = numbers[2].value_or(0);
    // Labels are 20 characters each, of one byte or more.
    const std::size_t split = byte_of_character(labels, 21);
    axis.label = std::string(trimmed(labels.substr(0, split)));
    axis.unit = std::string(trimmed(labels.substr(split)));
  }

  static std::size_t byte_of_character(std::string_view text, std::size_t character) {
    std::size_t byte = 0;
    for (std::size_t seen = 0; byte < text.size(); ++byte) {
      const auto code = static_cast<unsigned char>(text[byte]);
      const bool continued =
          code >= 0x80 && code < 0xC0 && byte > 0 && static_cast<unsigned char>(text[byte - 1]) >= 0xC0;
      if (!continued && seen++ == character) break;
    }
    return byte;
  }

  std::vector<double> read_text(const Layout& layout) {
    const std::size_t wanted = layout.count * layout.per_point();
    std::vector<double> numbers;
    numbers.reserve(std::min(wanted, lines_.rest().size() / 2 + 1));
    bool ended = false;
    while (numbers.size() < wanted && !lines_.at_end()) {
      if ((ended = is_delimiter(lines_.peek()))) break;
      append_line(lines_.next(), layout, numbers);
    }
    if (numbers.size() < wanted) {
      const std::size_t points = numbers.size() / layout.per_point();
      if (!ended || points == 0) throw error("the file ends within the data");
      note(fmt::format("the data set that ends in line {} says {} values and holds {}", lines_.number(), layout.count,
                       points));
      numbers.resize(points * layout.per_point());
    }
    numbers.resize(std::min(numbers.size(), wanted));
    return numbers;
  }

  void append_line(std::string_view line, const Layout& layout, std::vector<double>& numbers) const {
    const std::size_t before = numbers.size();
    const auto append = [&](const std::vector<std::string_view>& fields) {
      for (const std::string_view field : fields) {
        const std::optional<double> number = parse_fortran(field);
        if (!number) {
          numbers.resize(before);
          return false;
        }
        numbers.push_back(*number);
      }
      return true;
    };
    if (append(tokens(line)) || append(fixed_width(line, layout)) || append(split_at_signs(line))) return;
    throw error("is no line of numbers", {}, trimmed(line).substr(0, 60));
  }

  static std::vector<std::string_view> fixed_width(std::string_view line, const Layout& layout) {
    std::vector<std::string_view> fields;
    for (std::size_t i = 0, begin = 0; begin < line.size(); ++i) {
      const bool abscissa = !layout.even && i % layout.per_point() == 0;
      const std::size_t width = layout.is_double() && !abscissa ? 20 : 13;
      const std::string_view field = trimmed(line.substr(begin, width));
      if (!field.empty()) fields.push_back(field);
      begin += width;
    }
    return fields;
  }

  static std::vector<std::string_view> split_at_signs(std::string_view line) {
    std::vector<std::string_view> fields;
    for (const std::string_view token : tokens(line)) {
      std::size_t begin = 0;
      for (std::size_t i = 1; i < token.size(); ++i) {
        const bool sign = token[i] == '-' || token[i] == '+';
        if (!sign || std::string_view("eEdD").find(token[i - 1]) != std::string_view::npos) continue;
        fields.push_back(token.substr(begin, i - begin));
        begin = i;
      }
      fields.push_back(token.substr(begin));
    }
    return fields;
  }

  /// Whether the data could end here: the next thing is the closing "-1" or the end of the file.
  [[nodiscard]] bool ends_after(std::size_t bytes) const {
    const std::string_view rest = lines_.rest();
    if (bytes > rest.size()) return false;
    const std::string_view after = trimmed(rest.substr(bytes, 90));
    return after.empty() || (after.starts_with("-1") && (after.size() == 2 || after[2] <= ' '));
  }

  std::vector<double> read_binary(const Layout& layout, const Binary& binary) {
    const std::size_t width = layout.is_double() ? 8 : 4;
    const std::size_t same = layout.count * layout.per_point() * width;
    const std::size_t single_abscissa = layout.count * (layout.ordinates() * width + 4);
    // Writers differ in the precision of an uneven abscissa, and in what they count as bytes; the closing -1 decides.
    const bool mixed = !layout.even && layout.is_double() && !ends_after(same) &&
                       (ends_after(single_abscissa) || binary.bytes == single_abscissa);
    const std::size_t bytes = mixed ? single_abscissa : same;
    if (lines_.rest().size() < bytes) {
      throw error(fmt::format("the file ends within the data: {} of {} bytes", lines_.rest().size(), bytes));
    }
    if (binary.bytes != 0 && binary.bytes != bytes && ends_after(bytes)) {
      note(fmt::format("the data set that ends in line {} says {} bytes and holds {}", lines_.number(), binary.bytes,
                       bytes));
    } else if (!ends_after(bytes)) {
      note(fmt::format("no -1 follows the binary data after line {}", lines_.number()));
    }
    std::vector<double> numbers(layout.count * layout.per_point());
    const char* from = lines_.rest().data();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const bool narrow = width == 4 || (mixed && i % layout.per_point() == 0);
      numbers[i] = narrow ? decode<float, std::uint32_t>(from, binary.byte_order == 2)
                          : decode<double, std::uint64_t>(from, binary.byte_order == 2);
      from += narrow ? 4 : 8;
    }
    lines_.skip_bytes(bytes);
    return numbers;
  }

  template <class Float, class Bits>
  static double decode(const char* from, bool big_endian) {
    Bits bits = 0;
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
      const std::size_t place = big_endian ? sizeof(Bits) - 1 - i : i;
      bits |= static_cast<Bits>(static_cast<Bits>(static_cast<unsigned char>(from[i])) << (8 * place));
    }
    return static_cast<double>(std::bit_cast<Float>(bits));
  }

  void take(const std::vector<double>& numbers, const Layout& layout, UffFunction& function) const {
    const std::size_t stride = layout.per_point();
    const auto points = static_cast<Eigen::Index>(numbers.size() / stride);
    function.abscissa.resize(points);
    function.values.resize(points);
    for (Eigen::Index i = 0; i < points; ++i) {
      const double* point = numbers.data() + static_cast<std::size_t>(i) * stride;
      function.abscissa(i) = layout.even ? layout.first + static_cast<double>(i) * layout.step : *point++;
      function.values(i) = {point[0], layout.is_complex() ? point[1] : 0.0};
      const bool finite = std::isfinite(function.abscissa(i)) && std::isfinite(function.values(i).real()) &&
                          std::isfinite(function.values(i).imag());
      if (!finite) throw error(fmt::format("value {} of the function above is no finite number", i + 1));
    }
  }

  Lines lines_;
  const std::string& where_;
  const UffTake& take_;
  std::vector<std::string> notes_;
  std::vector<std::pair<std::string, int>> skipped_;
  bool began_ = false;
  double length_factor_ = 1.0, force_factor_ = 1.0;
  bool has_units_ = false;
};

}  // namespace

std::vector<std::string> read_uff(std::string_view content, const std::string& where, const UffTake& take) {
  return Reader(content, where, take).read();
}

UffFile parse_uff(std::string_view content, const std::string& where) {
  UffFile out;
  out.notes =
      read_uff(content, where, [&out](UffFunction&& function) { out.functions.push_back(std::move(function)); });
  return out;
}

}  // namespace robomill::io
