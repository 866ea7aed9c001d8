#include "robomill/io/records/numpy/npy_format.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/byte_order.hpp"
#include "robomill/io/records/numpy/python_literal.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t longest_header = std::size_t{1} << 20;
constexpr std::size_t largest_item = std::size_t{1} << 20;
constexpr std::uint64_t most_items = std::uint64_t{1} << 62;
constexpr const char* makes_no_sense = "has a header of NPY that makes no sense";

/// Of half precision.
double half(std::uint16_t bits) {
  const double sign = (bits & 0x8000U) != 0 ? -1.0 : 1.0;
  const int exponent = bits >> 10U & 0x1FU;
  const auto fraction = static_cast<double>(bits & 0x3FFU);
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  if (exponent == 31) return fraction > 0.0 ? std::numeric_limits<double>::quiet_NaN() : sign * HUGE_VAL;
  return sign * std::ldexp(1024.0 + fraction, exponent - 25);
}

template <class Bits, class Number, bool big_endian>
double npy_number(const char* at) {
  return static_cast<double>(std::bit_cast<Number>(
      static_cast<Bits>(number_at(std::string_view(at, sizeof(Bits)), 0, sizeof(Bits), big_endian))));
}

template <bool big_endian>
double npy_half(const char* at) {
  return half(static_cast<std::uint16_t>(number_at(std::string_view(at, 2), 0, 2, big_endian)));
}

template <bool big_endian>
double (*decoder_of(char kind, std::size_t size))(const char*) {
  const bool is_signed = kind == 'i';
  if (kind == 'f') {
    if (size == 2) return npy_half<big_endian>;
    return size == 4 ? npy_number<std::uint32_t, float, big_endian> : npy_number<std::uint64_t, double, big_endian>;
  }
  switch (size) {
    case 1:
      return is_signed ? npy_number<std::uint8_t, std::int8_t, big_endian>
                       : npy_number<std::uint8_t, std::uint8_t, big_endian>;
    case 2:
      return is_signed ? npy_number<std::uint16_t, std::int16_t, big_endian>
                       : npy_number<std::uint16_t, std::uint16_t, big_endian>;
    case 4:
      return is_signed ? npy_number<std::uint32_t, std::int32_t, big_endian>
                       : npy_number<std::uint32_t, std::uint32_t, big_endian>;
    default:
      return is_signed ? npy_number<std::uint64_t, std::int64_t, big_endian>
                       : npy_number<std::uint64_t, std::uint64_t, big_endian>;
  }
}

/// Why a kind is no number; empty: it is one.
std::string fault_of(const NpyType& type) {
  switch (type.kind) {
    case 'b':
    case 'i':
    case 'u':
      return type.size == 1 || type.size == 2 || type.size == 4 || type.size == 8 ? "" : "numbers of unknown width";
    case 'f':
      return type.size == 2 || type.size == 4 || type.size == 8 ? "" : "numbers of extended precision";
    case 'M':
    case 'm':
      return type.size == 8 && type.tick_s > 0.0 ? "" : "dates";
    case 'c':
      return "complex numbers";
    case 'S':
    case 'a':
    case 'U':
      return "text";
    case 'O':
      return "Python objects";
    default:
      return "bytes without a type";
  }
}

/// Seconds of "[us]", behind the type of times.
double tick_of(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 6> known = {
      {{"[s]", 1.0}, {"[ms]", 1e-3}, {"[us]", 1e-6}, {"[ns]", 1e-9}, {"[ps]", 1e-12}, {"[m]", 60.0}}};
  for (const auto& [name, s] : known) {
    if (unit == name) return s;
  }
  return 0.0;
}

std::optional<NpyType> type_of(std::string_view text) {
  NpyType out;
  if (!text.empty() && std::string_view("<>|=").find(text.front()) != std::string_view::npos) {
    out.big_endian = text.front() == '>';
    text.remove_prefix(1);
  }
  if (text.empty()) return std::nullopt;
  out.kind = text.front();
  text.remove_prefix(1);
  const std::from_chars_result read = std::from_chars(text.data(), text.data() + text.size(), out.size);
  if (out.kind == 'O' && text.empty()) {
    out.size = 8;
  } else if (read.ec != std::errc() || out.size > largest_item) {
    return std::nullopt;
  } else {
    text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  }
  if (out.kind == 'U') out.size *= 4;
  if (out.kind == 'M' || out.kind == 'm') {
    out.tick_s = tick_of(text);
  } else if (!text.empty()) {
    return std::nullopt;
  }
  out.fault = fault_of(out);
  return out;
}

/// The fields of a structured type; false where they make no sense.
bool add_fields(const PythonValue& list, NpyHeader& header) {
  for (const PythonValue& item : list.items) {
    const bool is_field = item.kind == PythonValue::Kind::list && (item.items.size() == 2 || item.items.size() == 3);
    if (!is_field || header.item_bytes > largest_item) return false;
    NpyField field{.offset = header.item_bytes};
    const PythonValue& name = item.items[0];
    field.name = name.kind == PythonValue::Kind::list && name.items.size() == 2 ? name.items[1].text : name.text;
    if (item.items.size() == 3) {
      for (const PythonValue& side : item.items[2].items) {
        if (side.kind != PythonValue::Kind::whole || side.number < 0 || side.number > 4096) return false;
        field.count *= static_cast<std::size_t>(side.number);
        if (field.count > largest_item) return false;
      }
    }
    const PythonValue& type = item.items[1];
    if (type.kind == PythonValue::Kind::list) {
      NpyHeader within;
      if (!add_fields(type, within)) return false;
      field.type = {.kind = 'V', .size = within.item_bytes, .fault = "fields within a field"};
    } else if (const std::optional<NpyType> read = type_of(type.text)) {
      field.type = *read;
    } else {
      return false;
    }
    header.item_bytes += field.count * field.type.size;
    header.fields.push_back(std::move(field));
  }
  return header.item_bytes > 0 && header.item_bytes <= largest_item;
}

bool take_description(const PythonValue& said, NpyHeader& header) {
  const PythonValue* type = said.get("descr");
  const PythonValue* order = said.get("fortran_order");
  const PythonValue* shape = said.get("shape");
  if (type == nullptr || order == nullptr || shape == nullptr || shape->kind != PythonValue::Kind::list) return false;
  header.fortran_order = order->number != 0;
  for (const PythonValue& side : shape->items) {
    if (side.kind != PythonValue::Kind::whole || side.number < 0) return false;
    header.shape.push_back(static_cast<std::uint64_t>(side.number));
    if (side.number > 0 && header.items > most_items / header.shape.back()) return false;
    header.items *= header.shape.back();
  }
  if (type->kind == PythonValue::Kind::list) {
    header.is_structured = true;
    return add_fields(*type, header);
  }
  const std::optional<NpyType> plain = type_of(type->text);
  if (!plain) return false;
  header.item_bytes = plain->size;
  header.fields.push_back({.type = *plain});
  return true;
}

}  // namespace

double (*NpyType::decoder() const)(const char*) {
  return big_endian ? decoder_of<true>(kind, size) : decoder_of<false>(kind, size);
}

NpyHeader read_npy_header(ByteSource& bytes, const std::string& where) {
  std::array<char, 8> begin = {};
  const std::size_t there = bytes.read(begin);
  if (there < begin.size() || std::string_view(begin.data(), npy_magic.size()) != npy_magic) {
    throw InvalidInput(where, "is no NPY file: it does not begin as one", "Was it saved by numpy.save?");
  }
  const int version = static_cast<unsigned char>(begin[6]);
  if (version < 1 || version > 3) {
    throw InvalidInput(where, fmt::format("is of version {} of NPY, and 1 to 3 are read", version));
  }
  std::array<char, 4> width = {};
  const std::size_t wide = version == 1 ? 2 : 4;
  const bool has_width = bytes.read(std::span(width).first(wide)) == wide;
  const auto length = static_cast<std::size_t>(number_at(std::string_view(width.data(), width.size()), 0, wide, false));
  if (!has_width || length > longest_header || length > bytes.size()) {
    throw InvalidInput(where, "ends within its header", "Was it cut off?");
  }
  std::string text(length, '\0');
  if (bytes.read(text) < length) throw InvalidInput(where, "ends within its header", "Was it cut off?");
  const std::optional<PythonValue> said = parse_python(text);
  NpyHeader header{.begin = begin.size() + wide + length};
  if (!said || !take_description(*said, header)) throw InvalidInput(where, makes_no_sense);
  return header;
}

}  // namespace robomill::io
