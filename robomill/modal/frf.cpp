#include "robomill/modal/frf.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace {

constexpr std::array<std::string_view, 6> response_axes = {"x", "y", "z", "rx", "ry", "rz"};
constexpr std::array<std::string_view, 6> excitation_axes = {"x", "y", "z", "mx", "my", "mz"};

[[noreturn]] void reject(std::string_view text) {
  throw InvalidInput(InvalidInput::Parts{.field = "FRF name",
                                         .value = "\"" + std::string(text) + "\"",
                                         .rule = "is no FRF",
                                         .hint = "Names read response then force: xx, xy, 1x:3x, x:my, ry:my"});
}

void require_increasing(const Eigen::VectorXd& frequency_hz) {
  if (frequency_hz.size() == 0) throw InvalidInput("frequency_hz", "is empty");
  for (Eigen::Index i = 0; i < frequency_hz.size(); ++i) {
    const std::string line = "frequency_hz[" + std::to_string(i) + "]";
    require_non_negative(line.c_str(), frequency_hz(i), "Hz");
    if (i > 0 && frequency_hz(i) <= frequency_hz(i - 1)) {
      throw InvalidInput(line, frequency_hz(i), "Hz", "must be above the frequency before it",
                         "Is the file sorted, and does it hold one FRF only?");
    }
  }
}

}  // namespace

std::string to_string(const Dof& dof, bool as_excitation) {
  const std::size_t axis = static_cast<std::size_t>(dof.axis) - 1;
  const std::string_view name = as_excitation ? excitation_axes.at(axis) : response_axes.at(axis);
  return (dof.point == 0 ? "" : std::to_string(dof.point)) + std::string(name);
}

std::string to_string(const FrfName& name) {
  const std::string response = to_string(name.response);
  const std::string excitation = to_string(name.excitation, true);
  const bool brief = response.size() == 1 && excitation.size() == 1;
  return response + (brief ? "" : ":") + excitation;
}

Dof parse_dof(std::string_view text) {
  Dof dof;
  const char* const end = text.data() + text.size();
  const std::from_chars_result number = std::from_chars(text.data(), end, dof.point);
  const char* const rest = number.ec == std::errc() ? number.ptr : text.data();
  const std::string_view axis(rest, static_cast<std::size_t>(end - rest));
  if (dof.point < 0 || number.ec == std::errc::result_out_of_range) reject(text);
  for (std::size_t i = 0; i < response_axes.size(); ++i) {
    if (axis == response_axes.at(i) || axis == excitation_axes.at(i)) {
      dof.axis = static_cast<Axis>(i + 1);
      return dof;
    }
  }
  reject(text);
}

FrfName parse_frf_name(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon != std::string_view::npos) {
    return {.response = parse_dof(text.substr(0, colon)), .excitation = parse_dof(text.substr(colon + 1))};
  }
  if (text.size() != 2) reject(text);
  return {.response = parse_dof(text.substr(0, 1)), .excitation = parse_dof(text.substr(1, 1))};
}

void FrfSet::validate() const {
  require_increasing(frequency_hz);
  if (frfs.empty()) throw InvalidInput("frfs", "holds no FRF");
  std::set<FrfName> seen;
  for (const Frf& frf : frfs) {
    const std::string name = to_string(frf.name);
    if (!seen.insert(frf.name).second) throw InvalidInput(name, "comes twice");
    if (frf.receptance.size() != frequency_hz.size()) {
      throw InvalidInput(name, static_cast<double>(frf.receptance.size()), "lines",
                         "must have one line for each of the " + std::to_string(frequency_hz.size()) + " frequencies");
    }
    if (!frf.receptance.allFinite()) throw InvalidInput(name, "holds a value that is not finite");
    for (const Eigen::VectorXd* extra : {&frf.coherence, &frf.deviation}) {
      if (extra->size() == 0) continue;
      if (extra->size() != frequency_hz.size() || !extra->allFinite() || extra->minCoeff() < 0.0) {
        throw InvalidInput(name, "coherence and deviation need one finite value >= 0 for each frequency");
      }
    }
  }
}

const Frf* FrfSet::find(const FrfName& name) const {
  for (const Frf& frf : frfs) {
    if (frf.name == name) return &frf;
  }
  return nullptr;
}

}  // namespace robomill::modal
