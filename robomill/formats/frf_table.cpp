#include <fmt/format.h>

#include <iterator>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/frf_parts.hpp"
#include "robomill/formats/table.hpp"

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

/// "m_per_n" of xx, "rad_per_n_m" of rx:my.
std::string unit_of(const modal::FrfName& name) {
  const bool rotation = static_cast<int>(name.response.axis) > 3;
  const bool moment = static_cast<int>(name.excitation.axis) > 3;
  return std::string(rotation ? "rad" : "m") + (moment ? "_per_n_m" : "_per_n");
}

/// "xx" of "xx_re_m_per_n" with part "_re".
std::optional<modal::FrfName> named(std::string_view column, std::string_view part) {
  const std::size_t at = column.find(part);
  if (at == std::string_view::npos || at == 0) return {};
  return modal::parse_frf_name(column.substr(0, at));
}

const std::vector<double>* find_column(const Table& table, const std::string& start) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    if (table.names[i].starts_with(start)) return &table.columns[i];
  }
  return nullptr;
}

void read_named(const Table& table, FrfParts& out) {
  const std::vector<double>* frequency = find_column(table, "frequency");
  if (frequency == nullptr) throw InvalidInput(out.file.string(), "has no column frequency_hz");
  out.frequency_hz = to_vector(*frequency);
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::optional<modal::FrfName> name = named(table.names[i], "_re");
    if (!name) continue;
    const std::string text = modal::to_string(*name);
    const std::vector<double>* im = find_column(table, text + "_im");
    if (im == nullptr) throw InvalidInput(out.file.string(), "has no column " + text + "_im_" + unit_of(*name));
    FrfPart part{.name = name, .receptance = to_complex(table.columns[i], *im)};
    if (const std::vector<double>* column = find_column(table, text + "_coherence"))
      part.coherence = to_vector(*column);
    if (const std::vector<double>* column = find_column(table, text + "_deviation"))
      part.deviation = to_vector(*column);
    out.frfs.push_back(std::move(part));
  }
  if (out.frfs.empty()) {
    throw InvalidInput(out.file.string(), "has no column such as xx_re_m_per_n",
                       "Columns are frequency_hz, xx_re_m_per_n, xx_im_m_per_n, yx_re_m_per_n, …");
  }
}

void read_unnamed(const Table& table, FrfParts& out) {
  if (table.columns.size() < 3 || table.columns.size() % 2 == 0) {
    throw InvalidInput(out.file.string(), static_cast<double>(table.columns.size()), "columns",
                       "must be a frequency and pairs of real and imaginary parts",
                       "A file without a header holds three columns: Hz, Re, Im");
  }
  out.frequency_hz = to_vector(table.columns[0]);
  for (std::size_t i = 1; i + 1 < table.columns.size(); i += 2) {
    out.frfs.push_back({.receptance = to_complex(table.columns[i], table.columns[i + 1])});
  }
}

}  // namespace

FrfParts read_frf_table(const std::filesystem::path& path) {
  const Table table = parse_table(read_file(path), path.string());
  FrfParts out{.file = path};
  if (table.names.empty()) {
    read_unnamed(table, out);
  } else {
    read_named(table, out);
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
