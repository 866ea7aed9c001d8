#include "robomill/modal/fitting/fit_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::modal::detail {
namespace {

using Eigen::Index;

std::size_t index_of(const std::vector<Dof>& dofs, const Dof& dof) {
  return static_cast<std::size_t>(std::find(dofs.begin(), dofs.end(), dof) - dofs.begin());
}

void add_once(std::vector<Dof>& dofs, const Dof& dof) {
  if (std::find(dofs.begin(), dofs.end(), dof) == dofs.end()) dofs.push_back(dof);
}

// Factors of responses and excitations whose product is each FRF's root mean square as nearly as products can be.
void set_units(Part& part, const FrfSet& set) {
  const auto responses = static_cast<Index>(part.responses.size());
  const auto excitations = static_cast<Index>(part.excitations.size());
  Eigen::VectorXd row = Eigen::VectorXd::Zero(responses);
  Eigen::VectorXd column = Eigen::VectorXd::Zero(excitations);
  const auto average = [&](Eigen::VectorXd& own, const Eigen::VectorXd& other, bool of_rows) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(own.size());
    Eigen::VectorXd count = Eigen::VectorXd::Zero(own.size());
    for (std::size_t f = 0; f < part.frfs.size(); ++f) {
      const FitEntry& entry = part.data.entries[f];
      const Eigen::VectorXcd& h = set.frfs[part.frfs[f]].receptance;
      const double size = std::sqrt(h.squaredNorm() / static_cast<double>(h.size()));
      if (!(size > 0.0)) continue;
      const Index at = of_rows ? entry.response : entry.excitation;
      sum(at) += std::log(size) - other(of_rows ? entry.excitation : entry.response);
      count(at) += 1.0;
    }
    own = sum.cwiseQuotient(count.cwiseMax(1.0));
  };
  for (int round = 0; round < 20; ++round) {
    average(row, column, true);
    average(column, row, false);
  }
  part.response_unit = row.array().exp();
  part.excitation_unit = column.array().exp();
}

}  // namespace

FrfSet cut_band(const FrfSet& set, double low_hz, double high_hz) {
  Index begin = 0;
  const Index n = set.frequency_hz.size();
  while (begin < n && (set.frequency_hz(begin) < low_hz || set.frequency_hz(begin) <= 0.0)) ++begin;
  Index end = n;
  while (end > begin && set.frequency_hz(end - 1) > high_hz) --end;
  if (begin >= end) {
    const bool above = low_hz > set.frequency_hz(n - 1);
    throw InvalidInput(above ? "band_low_hz" : "band_high_hz", above ? low_hz : high_hz, "Hz",
                       "leaves no line of the FRFs, which reach from " + std::to_string(set.frequency_hz(0)) + " to " +
                           std::to_string(set.frequency_hz(n - 1)) + " Hz");
  }
  FrfSet cut;
  cut.frequency_hz = set.frequency_hz.segment(begin, end - begin);
  for (const Frf& frf : set.frfs) {
    Frf part{.name = frf.name, .receptance = frf.receptance.segment(begin, end - begin)};
    if (frf.coherence.size() > 0) part.coherence = frf.coherence.segment(begin, end - begin);
    if (frf.deviation.size() > 0) part.deviation = frf.deviation.segment(begin, end - begin);
    cut.frfs.push_back(part);
  }
  return cut;
}

std::vector<Part> split(const FrfSet& set) {
  std::vector<Part> parts;
  std::vector<bool> taken(set.frfs.size(), false);
  for (std::size_t first = 0; first < set.frfs.size(); ++first) {
    if (taken[first]) continue;
    Part part;
    taken[first] = true;
    part.frfs.push_back(first);
    for (std::size_t done = 0; done < part.frfs.size(); ++done) {
      const FrfName& name = set.frfs[part.frfs[done]].name;
      for (std::size_t f = 0; f < set.frfs.size(); ++f) {
        const FrfName& other = set.frfs[f].name;
        if (taken[f] || (other.response != name.response && other.excitation != name.excitation)) continue;
        taken[f] = true;
        part.frfs.push_back(f);
      }
    }
    std::sort(part.frfs.begin(), part.frfs.end());
    for (const std::size_t f : part.frfs) {
      add_once(part.responses, set.frfs[f].name.response);
      add_once(part.excitations, set.frfs[f].name.excitation);
    }
    part.omega_unit = 2.0 * std::numbers::pi * set.frequency_hz(set.frequency_hz.size() - 1);
    part.data.omega = set.frequency_hz / set.frequency_hz(set.frequency_hz.size() - 1);
    part.data.responses = static_cast<Index>(part.responses.size());
    part.data.excitations = static_cast<Index>(part.excitations.size());
    for (const std::size_t f : part.frfs) {
      part.data.entries.push_back(
          {.response = static_cast<Index>(index_of(part.responses, set.frfs[f].name.response)),
           .excitation = static_cast<Index>(index_of(part.excitations, set.frfs[f].name.excitation)),
           .receptance = {},
           .weight = {}});
    }
    set_units(part, set);
    for (std::size_t f = 0; f < part.frfs.size(); ++f) {
      FitEntry& entry = part.data.entries[f];
      entry.receptance = set.frfs[part.frfs[f]].receptance / part.unit(entry);
    }
    parts.push_back(part);
  }
  return parts;
}

ModalModel empty_model(const FrfSet& set) {
  ModalModel model;
  for (const Frf& frf : set.frfs) {
    add_once(model.excitations, frf.name.excitation);
    add_once(model.responses, frf.name.response);
  }
  return model;
}

void add_to_model(ModalModel& model, const Part& part, const PartFit& fit, bool residuals) {
  const double hz = part.omega_unit / (2.0 * std::numbers::pi);
  for (Index k = 0; k < fit.poles.size(); ++k) {
    Mode mode{.frequency_hz = fit.poles.omega(k) * hz,
              .damping_ratio = fit.poles.zeta(k),
              .left = Eigen::VectorXcd::Zero(static_cast<Index>(model.excitations.size())),
              .right = Eigen::VectorXcd::Zero(static_cast<Index>(model.responses.size()))};
    if (fit.omega_std.size() > 0) {
      mode.frequency_std_hz = fit.omega_std(k) * hz;
      mode.damping_ratio_std = fit.zeta_std(k);
    }
    for (std::size_t j = 0; j < part.excitations.size(); ++j) {
      const auto row = static_cast<Index>(j);
      mode.left(static_cast<Index>(index_of(model.excitations, part.excitations[j]))) =
          fit.poles.left(row, k) * part.excitation_unit(row) * part.omega_unit;
    }
    for (std::size_t i = 0; i < part.responses.size(); ++i) {
      const auto row = static_cast<Index>(i);
      mode.right(static_cast<Index>(index_of(model.responses, part.responses[i]))) =
          fit.at.right(row, k) * part.response_unit(row);
    }
    normalise(mode);
    model.modes.push_back(mode);
  }
  if (!residuals) return;
  for (std::size_t f = 0; f < part.frfs.size(); ++f) {
    const FitEntry& entry = part.data.entries[f];
    const auto index = static_cast<Index>(f);
    model.residuals.push_back({.name = {.response = part.responses[static_cast<std::size_t>(entry.response)],
                                        .excitation = part.excitations[static_cast<std::size_t>(entry.excitation)]},
                               .mass = fit.at.mass(index) * part.omega_unit * part.omega_unit * part.unit(entry),
                               .stiffness = fit.at.stiffness(index) * part.unit(entry)});
  }
}

}  // namespace robomill::modal::detail
