#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <complex>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/modal/files/frf_check.hpp"
#include "robomill/modal/files/frf_parts.hpp"

namespace robomill::modal {
namespace {

Eigen::VectorXd to_vector(const std::vector<double>& column) {
  return Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
}

Eigen::VectorXcd to_complex(const std::vector<double>& re, const std::vector<double>& im) {
  Eigen::VectorXcd out(static_cast<Eigen::Index>(re.size()));
  out.real() = to_vector(re);
  out.imag() = to_vector(im);
  return out;
}

Eigen::VectorXcd from_polar(const std::vector<double>& size, const std::vector<double>& angle, double radian) {
  Eigen::VectorXcd out(static_cast<Eigen::Index>(size.size()));
  for (std::size_t i = 0; i < size.size(); ++i) {
    out(static_cast<Eigen::Index>(i)) = size[i] * std::exp(std::complex<double>(0.0, radian * angle[i]));
  }
  return out;
}

bool is_angular(const Dof& dof) {
  return static_cast<int>(dof.axis) > 3;
}

/// "m_per_n" of xx, "rad_per_n_m" of rx:my.
std::string unit_of(const FrfName& name) {
  return fmt::format("{}_per_n{}", is_angular(name.response) ? "rad" : "m", is_angular(name.excitation) ? "_m" : "");
}

/// "xx_re_m_per_n" in its parts; nothing where a column is no such.
struct Column {
  std::string_view name, part, unit;
};
std::optional<Column> take_apart(std::string_view text) {
  const std::size_t first = text.find('_');
  if (first == std::string_view::npos || first == 0) return std::nullopt;
  const std::string_view rest = text.substr(first + 1);
  const std::size_t second = std::min(rest.find('_'), rest.size());
  const Column column{text.substr(0, first), rest.substr(0, second), rest.substr(std::min(second + 1, rest.size()))};
  for (const std::string_view known : {"re", "im", "magnitude", "phase", "coherence", "deviation"}) {
    if (column.part == known) return column;
  }
  return std::nullopt;
}

/// "m_per_s2_per_n" as parse_unit knows it; nothing said is SI.
io::SiFactor factor_of(const Column& column, const FrfName& name, const std::string& where) {
  if (column.unit.empty()) return {.quantity = io::Quantity::displacement};
  struct Excitation {
    std::string_view suffix;
    bool moment;
    double si;
  };
  static constexpr std::array<Excitation, 3> excitations = {
      {{"_per_n", false, 1.0}, {"_per_n_m", true, 1.0}, {"_per_n_mm", true, 1e-3}}};
  const auto below = std::find_if(excitations.begin(), excitations.end(),
                                  [&](const Excitation& e) { return column.unit.ends_with(e.suffix); });
  io::SiFactor factor;
  std::string numerator;
  if (below != excitations.end()) {
    numerator = column.unit.substr(0, column.unit.size() - below->suffix.size());
    if (const std::size_t per = numerator.find("_per_"); per != std::string::npos) {
      numerator = fmt::format("{}/{}", numerator.substr(0, per), numerator.substr(per + 5));
    }
    factor = io::parse_unit(numerator);
  }
  if (factor.quantity == io::Quantity::unknown || factor.quantity == io::Quantity::force) {
    throw InvalidInput(
        where, fmt::format("column {}_{}_{} has a unit that is not known here", column.name, column.part, column.unit),
        "Receptances are m_per_n, rad_per_n, m_per_n_m or rad_per_n_m; accelerances m_per_s2_per_n");
  }
  const bool angle = numerator.find("rad") != std::string::npos;
  if (angle != is_angular(name.response) || below->moment != is_angular(name.excitation)) {
    throw InvalidInput(
        where,
        fmt::format("column {}_{}_{} has a unit that does not fit its name", column.name, column.part, column.unit),
        fmt::format("{} is {}", column.name, unit_of(name)));
  }
  factor.factor /= below->si;
  return factor;
}

bool is_frequency(std::string_view name) {
  const std::string word = io::lowered(name);
  for (const char* known : {"frequency_hz", "frequency", "freq_hz", "freq", "f_hz", "f", "hz", "frequency (hz)",
                            "frequency [hz]", "freq (hz)", "freq [hz]", "f (hz)", "f [hz]"}) {
    if (word == known) return true;
  }
  return false;
}

bool is_time(std::string_view name) {
  const std::string word = io::lowered(name);
  return word.starts_with("time") || word == "t" || word == "t_s" || word == "t (s)" || word == "t [s]" ||
         word == "seconds";
}

class NamedColumns {
 public:
  NamedColumns(const io::Table& table, FrfParts& out) : table_(table), out_(out), where_(out.file.string()) {}

  void read() {
    const auto frequency = std::find_if(table_.names.begin(), table_.names.end(), is_frequency);
    if (frequency == table_.names.end()) throw InvalidInput(where_, "has no column frequency_hz");
    out_.frequency_hz = to_vector(table_.columns[static_cast<std::size_t>(frequency - table_.names.begin())]);
    for (const std::string& text : table_.names) {
      const std::optional<Column> column = take_apart(text);
      if (column && (column->part == "re" || column->part == "magnitude")) out_.frfs.push_back(read_frf(*column));
    }
    for (const std::string& text : table_.names) {
      if (!take_apart(text) && !is_frequency(text))
        out_.notes.push_back(fmt::format("{}: column {} is left out", where_, text));
    }
  }

 private:
  [[nodiscard]] const std::vector<double>* find(const Column& like, std::string_view part, Column& found) const {
    for (std::size_t i = 0; i < table_.names.size(); ++i) {
      const std::optional<Column> column = take_apart(table_.names[i]);
      if (!column || column->name != like.name || column->part != part) continue;
      found = *column;
      return &table_.columns[i];
    }
    return nullptr;
  }

  [[nodiscard]] Eigen::VectorXcd cartesian(const Column& re, const std::vector<double>& real) const {
    Column im;
    const std::vector<double>* imaginary = find(re, "im", im);
    const char* joint = re.unit.empty() ? "" : "_";
    if (imaginary == nullptr)
      throw InvalidInput(where_, fmt::format("has no column {}_im{}{}", re.name, joint, re.unit));
    if (im.unit != re.unit) throw InvalidInput(where_, fmt::format("{}_re and {}_im differ in unit", re.name, re.name));
    return to_complex(real, *imaginary);
  }

  [[nodiscard]] Eigen::VectorXcd polar(const Column& magnitude, const std::vector<double>& size) const {
    Column phase;
    const std::vector<double>* angle = find(magnitude, "phase", phase);
    if (angle == nullptr || (phase.unit != "deg" && phase.unit != "rad")) {
      throw InvalidInput(where_, fmt::format("has no column {0}_phase_deg or {0}_phase_rad", magnitude.name),
                         "A magnitude needs its phase");
    }
    return from_polar(size, *angle, phase.unit == "deg" ? units::deg : 1.0);
  }

  /// @param first  the column of real parts or of magnitudes
  FrfPart read_frf(const Column& first) const {
    FrfPart part{.name = frf_name_at(where_, first.name)};
    Column extra;
    const std::vector<double>& values = *find(first, first.part, extra);
    const io::SiFactor factor = factor_of(first, *part.name, where_);
    part.derivatives = static_cast<int>(factor.quantity);
    part.stated = !first.unit.empty();
    part.values = factor.factor * (first.part == "re" ? cartesian(first, values) : polar(first, values));
    if (const std::vector<double>* coherence = find(first, "coherence", extra)) part.coherence = to_vector(*coherence);
    if (const std::vector<double>* deviation = find(first, "deviation", extra)) {
      if (extra.unit != first.unit)
        throw InvalidInput(where_, fmt::format("{0}_{1} and {0}_deviation differ in unit", first.name, first.part));
      part.deviation = factor.factor * to_vector(*deviation);
    }
    return part;
  }

  const io::Table& table_;
  FrfParts& out_;
  std::string where_;
};

/// What a column's name in words says: "Magnitude (m/N)", "phase_deg", "Imag".
struct Words {
  enum class Content { nothing, real, imaginary, magnitude, phase };
  Content content = Content::nothing;
  std::string unit = {};
};
/// What one word of a name says; nothing for words such as "receptance" and "of".
Words::Content content_of(std::string_view word) {
  using Known = std::pair<std::string_view, Words::Content>;
  static constexpr std::array<Known, 8> beginnings = {{{"real", Words::Content::real},
                                                       {"imag", Words::Content::imaginary},
                                                       {"mag", Words::Content::magnitude},
                                                       {"amp", Words::Content::magnitude},
                                                       {"abs", Words::Content::magnitude},
                                                       {"phase", Words::Content::phase},
                                                       {"ang", Words::Content::phase},
                                                       {"arg", Words::Content::phase}}};
  if (word == "re") return Words::Content::real;
  if (word == "im") return Words::Content::imaginary;
  const auto known = std::find_if(beginnings.begin(), beginnings.end(),
                                  [&](const Known& beginning) { return word.starts_with(beginning.first); });
  return known == beginnings.end() ? Words::Content::nothing : known->second;
}

Words in_words(std::string_view name) {
  const std::string text = io::lowered(io::trimmed(name));
  Words out;
  const std::size_t open = text.find_first_of("([");
  for (std::size_t at = 0; at < std::min(open, text.size()) && out.content == Words::Content::nothing;) {
    std::size_t end = at;
    while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end])) != 0) ++end;
    out.content = content_of(std::string_view(text).substr(at, end - at));
    at = end + 1;
  }
  if (open != std::string::npos) {
    out.unit = text.substr(open + 1, text.find_last_of(")]") - open - 1);
  } else if (const std::size_t bar = text.find('_'); bar != std::string::npos) {
    out.unit = text.substr(bar + 1);
    for (std::size_t per = 0; (per = out.unit.find("_per_")) != std::string::npos;) out.unit.replace(per, 5, "/");
  }
  return out;
}

/// Radians in one unit of a phase.
double phase_unit(const Words& phase, const std::string& where) {
  if (phase.unit == "deg" || phase.unit == "°" || phase.unit == "\xB0" || phase.unit.starts_with("degree")) {
    return units::deg;
  }
  if (phase.unit == "rad" || phase.unit.starts_with("radian")) return 1.0;
  throw InvalidInput(where, "does not say whether its phase is in degrees or radians",
                     "Name the column \"Phase (deg)\" or \"Phase (rad)\"");
}

/// Hz in one unit of the first column; nothing said is Hz.
double hz_in(const std::string& unit, const std::string& where) {
  if (unit == "khz") return 1e3;
  if (unit == "rad/s") return 1.0 / units::revolution;
  if (unit == "hz" || !io::is_unit(unit)) return 1.0;
  throw InvalidInput(where, fmt::format("has its first column in {}, which is no frequency", unit),
                     "The first column is the frequency in Hz");
}

/// The unit of a row as the names of columns state it: "m/s^2/N" is "m_per_s2_per_n".
std::string as_key(std::string_view unit) {
  std::string out;
  for (const char letter : io::lowered(unit)) {
    const auto byte = static_cast<unsigned char>(letter);
    if (letter == '/') out += "_per_";
    if (byte == 0xB2) out += '2';
    if (byte == 0xB5 || byte == 0xBC) out += 'u';  // of the signs for micro
    if (byte < 0x80 && std::isalnum(byte) != 0) out += letter;
  }
  return out;
}

/// Names with what a row of units below them says: "Real" is "Real (m/N)", "xx_re" is "xx_re_m_per_n".
void name_units(io::Table& table) {
  for (std::size_t i = 0; i < table.units.size(); ++i) {
    std::string& name = table.names[i];
    const std::string& unit = table.units[i];
    const std::optional<Column> column = take_apart(name);
    const bool states_one = !io::unit_of_column(name).empty() || (column && !column->unit.empty());
    if (unit.empty() || unit == "-" || states_one) continue;
    name += column ? "_" + as_key(unit) : " (" + unit + ")";
  }
}

/// Three columns under a header in words, "Frequency (Hz), Magnitude (m/N), Phase (deg)"; it names no FRF.
FrfPart read_in_words(const io::Table& table, const std::string& where) {
  using Content = Words::Content;
  Words first = in_words(table.names[1]), second = in_words(table.names[2]);
  const std::vector<double>*a = &table.columns[1], *b = &table.columns[2];
  if (first.content == Content::imaginary || first.content == Content::phase) {
    std::swap(first, second);
    std::swap(a, b);
  }
  const bool polar = first.content == Content::magnitude && second.content == Content::phase;
  const bool known = polar || (first.content == Content::real && second.content == Content::imaginary);
  if (!known && (first.content != Content::nothing || second.content != Content::nothing)) {
    throw InvalidInput(where, fmt::format("has columns {} and {}", table.names[1], table.names[2]),
                       "An FRF is real and imaginary part, or magnitude and phase");
  }
  FrfPart part{.values = polar ? from_polar(*a, *b, phase_unit(second, where)) : to_complex(*a, *b)};
  part.stated = known && !first.unit.empty();
  if (!part.stated) return part;
  const io::SiFactor factor = io::parse_unit(first.unit);
  if (!factor.is_ratio || factor.quantity == io::Quantity::force) {
    throw InvalidInput(where, fmt::format("has values in \"{}\", a unit that is not known here", first.unit),
                       "Receptances are in m/N, mm/N or um/N, accelerances in m/s^2/N; no dB");
  }
  part.values *= factor.factor;
  part.derivatives = static_cast<int>(factor.quantity);
  return part;
}

std::vector<FrfPart> read_unnamed(const io::Table& table, const std::string& where) {
  if (table.columns.size() < 3 || table.columns.size() % 2 == 0) {
    throw InvalidInput(where, static_cast<double>(table.columns.size()), "columns",
                       "must be a frequency and pairs of real and imaginary parts",
                       "A file without a header holds three columns: Hz, Re, Im");
  }
  std::vector<FrfPart> frfs;
  for (std::size_t i = 1; i + 1 < table.columns.size(); i += 2) {
    frfs.push_back({.values = to_complex(table.columns[i], table.columns[i + 1]), .stated = false});
  }
  return frfs;
}

}  // namespace

FrfParts read_frf_table(const std::filesystem::path& path) {
  FrfParts out{.file = path};
  io::Table table = io::parse_table(io::read_file(path), path.string(), out.notes);
  name_units(table);
  const std::string where = path.string();
  if (std::any_of(table.names.begin(), table.names.end(), is_time) &&
      std::none_of(table.names.begin(), table.names.end(), is_frequency)) {
    throw InvalidInput(where, "has a column of times and none of frequencies",
                       "Hits become FRFs with robomill frf hits.toml, where [[hits]] names the file and its columns");
  }
  const auto is_frf = [](const std::string& name) {
    const std::optional<Column> column = take_apart(name);
    return column && (column->part == "re" || column->part == "magnitude");
  };
  if (std::any_of(table.names.begin(), table.names.end(), is_frf)) {
    NamedColumns(table, out).read();
  } else if (table.names.empty() || table.columns.size() == 3) {
    out.frequency_hz = to_vector(table.columns[0]);
    if (!table.names.empty()) out.frequency_hz *= hz_in(io::lowered(io::unit_of_column(table.names[0])), where);
    require_frequencies(out.frequency_hz, where);
    if (table.names.empty()) {
      out.frfs = read_unnamed(table, where);
    } else {
      out.frfs.push_back(read_in_words(table, where));
    }
  } else {
    throw InvalidInput(where, "has no column such as xx_re_m_per_n",
                       "Columns are frequency_hz, xx_re_m_per_n, xx_im_m_per_n, yx_re_m_per_n, …");
  }
  if (std::any_of(out.frfs.begin(), out.frfs.end(), [](const FrfPart& frf) { return !frf.stated; })) {
    out.assumed.push_back({.what = table.names.empty() ? "Columns of FRFs without a header" : "Unit of FRFs",
                           .taken = table.names.empty() ? "Hz, real and imaginary part in m/N" : "m/N",
                           .key = "names of its columns, as xx_re_um_per_n",
                           .file = path.filename().string()});
  }
  return out;
}

std::string frf_table(const FrfSet& set, char separator) {
  std::string out = "frequency_hz";
  for (const Frf& frf : set.frfs) {
    const std::string name = to_string(frf.name);
    const std::string unit = unit_of(frf.name);
    out += fmt::format("{0}{1}_re_{2}{0}{1}_im_{2}", separator, name, unit);
    if (frf.coherence.size() > 0) out += fmt::format("{}{}_coherence", separator, name);
    if (frf.deviation.size() > 0) out += fmt::format("{}{}_deviation_{}", separator, name, unit);
  }
  out += '\n';
  for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
    io::append(out, "{:.15g}", set.frequency_hz(i));
    for (const Frf& frf : set.frfs) {
      io::append(out, "{0}{1}{0}{2}", separator, frf.receptance(i).real(), frf.receptance(i).imag());
      if (frf.coherence.size() > 0) io::append(out, "{}{}", separator, frf.coherence(i));
      if (frf.deviation.size() > 0) io::append(out, "{}{}", separator, frf.deviation(i));
    }
    out += '\n';
  }
  return out;
}

}  // namespace robomill::modal
