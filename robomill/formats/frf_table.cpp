#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/frf_parts.hpp"
#include "robomill/formats/si.hpp"
#include "robomill/formats/table.hpp"
#include "robomill/formats/text.hpp"

namespace robomill::formats {
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

bool is_angular(const modal::Dof& dof) {
  return static_cast<int>(dof.axis) > 3;
}

/// "m_per_n" of xx, "rad_per_n_m" of rx:my.
std::string unit_of(const modal::FrfName& name) {
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
  for (const std::string_view known : {"re", "im", "coherence", "deviation"}) {
    if (column.part == known) return column;
  }
  return std::nullopt;
}

/// "m_per_s2_per_n" as parse_unit knows it; nothing said is SI.
SiFactor factor_of(const Column& column, const modal::FrfName& name, const std::string& where) {
  if (column.unit.empty()) return {.quantity = Quantity::displacement};
  struct Excitation {
    std::string_view suffix;
    bool moment;
    double si;
  };
  static constexpr std::array<Excitation, 3> excitations = {
      {{"_per_n", false, 1.0}, {"_per_n_m", true, 1.0}, {"_per_n_mm", true, 1e-3}}};
  const auto below = std::find_if(excitations.begin(), excitations.end(),
                                  [&](const Excitation& e) { return column.unit.ends_with(e.suffix); });
  SiFactor factor;
  std::string numerator;
  if (below != excitations.end()) {
    numerator = column.unit.substr(0, column.unit.size() - below->suffix.size());
    if (const std::size_t per = numerator.find("_per_"); per != std::string::npos) {
      numerator = fmt::format("{}/{}", numerator.substr(0, per), numerator.substr(per + 5));
    }
    factor = parse_unit(numerator);
  }
  if (factor.quantity == Quantity::unknown || factor.quantity == Quantity::force) {
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
  const std::string word = lowered(name);
  for (const char* known : {"frequency_hz", "frequency", "freq_hz", "freq", "f_hz", "f", "hz", "frequency (hz)",
                            "frequency [hz]", "freq (hz)", "freq [hz]", "f (hz)", "f [hz]"}) {
    if (word == known) return true;
  }
  return false;
}

class NamedColumns {
 public:
  NamedColumns(const Table& table, FrfParts& out) : table_(table), out_(out), where_(out.file.string()) {}

  void read() {
    const auto frequency = std::find_if(table_.names.begin(), table_.names.end(), is_frequency);
    if (frequency == table_.names.end()) throw InvalidInput(where_, "has no column frequency_hz");
    out_.frequency_hz = to_vector(table_.columns[static_cast<std::size_t>(frequency - table_.names.begin())]);
    for (const std::string& text : table_.names) {
      const std::optional<Column> column = take_apart(text);
      if (column && column->part == "re") out_.frfs.push_back(read_frf(*column));
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

  FrfPart read_frf(const Column& re) const {
    FrfPart part{.name = frf_name_at(where_, re.name)};
    Column im;
    const std::vector<double>* real = find(re, "re", im);
    const std::vector<double>* imaginary = find(re, "im", im);
    const char* joint = re.unit.empty() ? "" : "_";
    if (imaginary == nullptr)
      throw InvalidInput(where_, fmt::format("has no column {}_im{}{}", re.name, joint, re.unit));
    if (im.unit != re.unit) throw InvalidInput(where_, fmt::format("{}_re and {}_im differ in unit", re.name, re.name));
    const SiFactor factor = factor_of(re, *part.name, where_);
    part.derivatives = static_cast<int>(factor.quantity);
    part.values = factor.factor * to_complex(*real, *imaginary);
    Column extra;
    if (const std::vector<double>* coherence = find(re, "coherence", extra)) part.coherence = to_vector(*coherence);
    if (const std::vector<double>* deviation = find(re, "deviation", extra)) {
      if (extra.unit != re.unit)
        throw InvalidInput(where_, fmt::format("{}_re and {}_deviation differ in unit", re.name, re.name));
      part.deviation = factor.factor * to_vector(*deviation);
    }
    return part;
  }

  const Table& table_;
  FrfParts& out_;
  std::string where_;
};

void read_unnamed(const Table& table, FrfParts& out) {
  if (table.columns.size() < 3 || table.columns.size() % 2 == 0) {
    throw InvalidInput(out.file.string(), static_cast<double>(table.columns.size()), "columns",
                       "must be a frequency and pairs of real and imaginary parts",
                       "A file without a header holds three columns: Hz, Re, Im");
  }
  out.frequency_hz = to_vector(table.columns[0]);
  for (std::size_t i = 1; i + 1 < table.columns.size(); i += 2) {
    out.frfs.push_back({.values = to_complex(table.columns[i], table.columns[i + 1])});
  }
}

}  // namespace

FrfParts read_frf_table(const std::filesystem::path& path) {
  const Table table = parse_table(read_file(path), path.string());
  FrfParts out{.file = path};
  const auto is_frf = [](const std::string& name) {
    const std::optional<Column> column = take_apart(name);
    return column && column->part == "re";
  };
  if (std::any_of(table.names.begin(), table.names.end(), is_frf)) {
    NamedColumns(table, out).read();
  } else if (table.names.empty() || table.columns.size() == 3) {
    // A header of words of its own, "Frequency, Real, Imaginary", names no FRF.
    read_unnamed(table, out);
  } else {
    throw InvalidInput(path.string(), "has no column such as xx_re_m_per_n",
                       "Columns are frequency_hz, xx_re_m_per_n, xx_im_m_per_n, yx_re_m_per_n, …");
  }
  return out;
}

std::string frf_table(const modal::FrfSet& set, char separator) {
  std::string out = "frequency_hz";
  for (const modal::Frf& frf : set.frfs) {
    const std::string name = modal::to_string(frf.name);
    const std::string unit = unit_of(frf.name);
    out += fmt::format("{0}{1}_re_{2}{0}{1}_im_{2}", separator, name, unit);
    if (frf.coherence.size() > 0) out += fmt::format("{}{}_coherence", separator, name);
    if (frf.deviation.size() > 0) out += fmt::format("{}{}_deviation_{}", separator, name, unit);
  }
  out += '\n';
  for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
    fmt::format_to(std::back_inserter(out), "{:.15g}", set.frequency_hz(i));
    for (const modal::Frf& frf : set.frfs) {
      fmt::format_to(std::back_inserter(out), "{0}{1}{0}{2}", separator, frf.receptance(i).real(),
                     frf.receptance(i).imag());
      if (frf.coherence.size() > 0) fmt::format_to(std::back_inserter(out), "{}{}", separator, frf.coherence(i));
      if (frf.deviation.size() > 0) fmt::format_to(std::back_inserter(out), "{}{}", separator, frf.deviation(i));
    }
    out += '\n';
  }
  return out;
}

}  // namespace robomill::formats
