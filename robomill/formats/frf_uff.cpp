#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/frf_parts.hpp"
#include "robomill/formats/si.hpp"
#include "robomill/formats/uff.hpp"

namespace robomill::formats {
namespace {

constexpr int type_frf = 4;
constexpr int type_coherence = 6;
constexpr int axis_displacement = 8;
constexpr int axis_force = 13;
constexpr int axis_frequency = 18;

modal::Dof to_dof(int node, int direction) {
  return {.point = std::max(node, 0), .axis = static_cast<modal::Axis>(std::abs(direction))};
}

std::optional<modal::FrfName> name_of(const UffFunction& function) {
  const auto known = [](int direction) { return direction != 0 && std::abs(direction) <= 6; };
  if (!known(function.response_direction) || !known(function.reference_direction)) return {};
  return modal::FrfName{.response = to_dof(function.response_node, function.response_direction),
                        .excitation = to_dof(function.reference_node, function.reference_direction)};
}

std::string title(const UffFunction& function, const std::filesystem::path& path) {
  const std::optional<modal::FrfName> name = name_of(function);
  return fmt::format("{}:{}{}", path.filename().string(), function.line,
                     name ? " (" + modal::to_string(*name) + ")" : "");
}

/// Displacement per force in SI; drops the line at 0 Hz where it has to integrate.
void to_receptance(const UffFunction& function, const std::string& title, Eigen::VectorXd& frequency_hz,
                   Eigen::VectorXcd& values, std::vector<std::string>& notes) {
  const SiFactor response = si_factor(function.numerator, function.length_factor, function.force_factor);
  const SiFactor force = si_factor(function.denominator, function.length_factor, function.force_factor);
  for (const SiFactor* factor : {&response, &force}) {
    if (!factor->note.empty()) notes.push_back(title + ": " + factor->note);
  }
  const double sign = (function.response_direction < 0 ? -1.0 : 1.0) * (function.reference_direction < 0 ? -1.0 : 1.0);
  values *= sign * response.factor / force.factor;
  if (response.quantity == Quantity::unknown || response.quantity == Quantity::force) {
    notes.push_back(title + ": does not say what it holds; taken as a receptance in m/N");
    return;
  }
  const int derivatives = static_cast<int>(response.quantity);
  if (derivatives == 0) return;
  notes.push_back(title + (derivatives == 2 ? ": accelerance, divided by (iω)²" : ": mobility, divided by iω"));
  const Eigen::Index first = frequency_hz(0) == 0.0 ? 1 : 0;
  frequency_hz = frequency_hz.tail(frequency_hz.size() - first).eval();
  values = values.tail(values.size() - first).eval();
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const std::complex<double> derivative(0.0, 2.0 * std::numbers::pi * frequency_hz(i));
    values(i) /= derivatives == 2 ? derivative * derivative : derivative;
  }
}

/// Leaves out the first lines that `values` has and the axis has not.
Eigen::VectorXd tail_of(const Eigen::VectorXd& values, Eigen::Index lines) {
  return values.size() >= lines ? Eigen::VectorXd(values.tail(lines)) : Eigen::VectorXd();
}

UffFunction describe(const modal::FrfName& name, int type, const modal::FrfSet& set) {
  UffFunction out;
  out.type = type;
  out.id[0] = modal::to_string(name);
  out.response_node = name.response.point;
  out.response_direction = static_cast<int>(name.response.axis);
  out.reference_node = name.excitation.point;
  out.reference_direction = static_cast<int>(name.excitation.axis);
  out.abscissa = set.frequency_hz;
  out.abscissa_axis = {.type = axis_frequency, .label = "Frequency", .unit = "Hz"};
  return out;
}

}  // namespace

FrfParts read_frf_uff(const std::filesystem::path& path) {
  const UffFile file = parse_uff(read_file(path), path.string());
  FrfParts out{.file = path, .frequency_hz = {}, .frfs = {}, .notes = file.notes};
  for (const UffFunction& function : file.functions) {
    if (function.type != type_frf || function.values.size() == 0) {
      if (function.type != type_coherence)
        out.notes.push_back(title(function, path) + ": no frequency response function, skipped");
      continue;
    }
    Eigen::VectorXd frequency_hz = function.abscissa;
    FrfPart part{.name = name_of(function), .receptance = function.values};
    to_receptance(function, title(function, path), frequency_hz, part.receptance, out.notes);
    if (out.frfs.empty()) {
      out.frequency_hz = frequency_hz;
    } else if (frequency_hz.size() != out.frequency_hz.size() ||
               (frequency_hz - out.frequency_hz).cwiseAbs().maxCoeff() >
                   1e-5 * out.frequency_hz.cwiseAbs().maxCoeff()) {
      throw InvalidInput(title(function, path), "has other frequencies than the FRF before it");
    }
    out.frfs.push_back(std::move(part));
  }
  if (out.frfs.empty()) {
    throw InvalidInput(path.string(), "holds no frequency response function (data set 58, type 4)",
                       "Time responses become FRFs with robomill frf");
  }
  for (const UffFunction& function : file.functions) {
    if (function.type != type_coherence) continue;
    for (FrfPart& part : out.frfs) {
      if (part.name && part.name == name_of(function)) {
        part.coherence = tail_of(function.values.real(), out.frequency_hz.size());
      }
    }
  }
  return out;
}

std::string frf_uff(const modal::FrfSet& set, bool binary) {
  std::vector<UffFunction> functions;
  for (const modal::Frf& frf : set.frfs) {
    UffFunction function = describe(frf.name, type_frf, set);
    function.is_complex = true;
    function.values = frf.receptance;
    function.numerator = {.type = axis_displacement, .label = "Displacement", .unit = "m"};
    function.denominator = {.type = axis_force, .label = "Force", .unit = "N"};
    functions.push_back(std::move(function));
    if (frf.coherence.size() == 0) continue;
    UffFunction coherence = describe(frf.name, type_coherence, set);
    coherence.values = frf.coherence.cast<std::complex<double>>();
    functions.push_back(std::move(coherence));
  }
  return format_uff(functions, binary);
}

}  // namespace robomill::formats
