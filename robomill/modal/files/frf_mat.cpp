#include <fmt/format.h>

#include <algorithm>

#include "robomill/base/error.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/modal/files/frf_parts.hpp"

namespace robomill::modal {
namespace {

/// "H_1x_3x" of 1x:3x with letter H.
std::string mat_name(char letter, const FrfName& name) {
  std::string text = fmt::format("{}_{}", letter, to_string(name));
  std::replace(text.begin(), text.end(), ':', '_');
  return text;
}

Eigen::VectorXd to_vector(const Eigen::MatrixXd& matrix, const std::string& where) {
  if (matrix.rows() != 1 && matrix.cols() != 1) throw InvalidInput(where, "must be a vector");
  return matrix.reshaped();
}

const io::MatVariable* find(const std::vector<io::MatVariable>& variables, const std::string& name) {
  const auto found = std::find_if(variables.begin(), variables.end(), [&](const auto& v) { return v.name == name; });
  return found == variables.end() ? nullptr : &*found;
}

std::string names_of(const std::vector<io::MatVariable>& variables) {
  std::string names;
  for (const io::MatVariable& variable : variables) names += (names.empty() ? "" : ", ") + variable.name;
  return names.empty() ? "It holds no numbers at all" : fmt::format("It has {}", names);
}

}  // namespace

FrfParts read_frf_mat(const std::filesystem::path& path) {
  const std::vector<io::MatVariable> variables = io::read_mat(path);
  const io::MatVariable* frequency = find(variables, "frequency_hz");
  if (frequency == nullptr) throw InvalidInput(path.string(), "has no variable frequency_hz", names_of(variables));
  FrfParts out{.file = path, .frequency_hz = to_vector(frequency->re, path.string() + ": frequency_hz")};
  for (const io::MatVariable& variable : variables) {
    if (!variable.name.starts_with("H_")) continue;
    const std::string where = fmt::format("{}: {}", path.string(), variable.name);
    std::string text = variable.name.substr(2);
    std::replace(text.begin(), text.end(), '_', ':');
    FrfPart part{.name = frf_name_at(where, text),
                 .values = to_vector(variable.re, where).cast<std::complex<double>>()};
    if (variable.im.size() > 0) part.values.imag() = to_vector(variable.im, where);
    if (const io::MatVariable* other = find(variables, mat_name('C', *part.name)))
      part.coherence = to_vector(other->re, where);
    if (const io::MatVariable* other = find(variables, mat_name('S', *part.name)))
      part.deviation = to_vector(other->re, where);
    out.frfs.push_back(std::move(part));
  }
  if (out.frfs.empty()) throw InvalidInput(path.string(), "has no variable such as H_xx", names_of(variables));
  return out;
}

void write_frf_mat(const std::filesystem::path& path, const FrfSet& set) {
  std::vector<io::MatVariable> variables = {{.name = "frequency_hz", .re = set.frequency_hz}};
  for (const Frf& frf : set.frfs) {
    variables.push_back({.name = mat_name('H', frf.name), .re = frf.receptance.real(), .im = frf.receptance.imag()});
    if (frf.coherence.size() > 0) variables.push_back({.name = mat_name('C', frf.name), .re = frf.coherence});
    if (frf.deviation.size() > 0) variables.push_back({.name = mat_name('S', frf.name), .re = frf.deviation});
  }
  io::write_mat(path, variables);
}

}  // namespace robomill::modal
