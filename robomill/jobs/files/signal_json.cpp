#include "robomill/jobs/files/signal_json.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/process/files/measured_schema.hpp"

namespace robomill::jobs {
namespace {

using cutting::MillingCoefficients;
using io::key;
using io::Row;
using io::Schema;
using io::Use;
using Result = SignalCoefficientsResult;

/// The polynomials of a set in κ, in the file's units.
const Schema<MillingCoefficients>& polynomials_table() {
  using Set = MillingCoefficients;
  static const Schema<Set> table(
      "coefficient_polynomials", "polynomials in the axial position angle (rad), highest power first",
      [] {
        std::vector<Row<Set>> rows;
        const auto add = [&rows](const char* name, std::vector<double> Set::*values, const char* meaning) {
          const auto value = [values](const Set& set) {
            return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>((set.*values).data(),
                                                                     static_cast<Eigen::Index>((set.*values).size())));
          };
          rows.push_back(key(name, value, meaning).nullable());
        };
        add("tangential_n_per_mm2", &Set::tangential_n_per_m2, "of cutting");
        add("radial_n_per_mm2", &Set::radial_n_per_m2, "of cutting");
        add("axial_n_per_mm2", &Set::axial_n_per_m2, "of cutting");
        add("tangential_edge_n_per_mm", &Set::tangential_edge_n_per_m, "of the edge");
        add("radial_edge_n_per_mm", &Set::radial_edge_n_per_m, "of the edge");
        add("axial_edge_n_per_mm", &Set::axial_edge_n_per_m, "of the edge");
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<Result>& signal_table() {
  static const Schema<Result> table(
      "signal_coefficients", "cutting force coefficients, from the force record of one cut",
      {key(
           "coefficients", [](const Result& r) { return &r.fit.coefficients; }, polynomials_table(), "found"),
       key(
           "std", [](const Result& r) { return &r.fit.deviations; }, polynomials_table(),
           "standard deviations, residuals taken as independent; null: not determined"),
       key(
           "identifiable", [](const Result& r) { return r.fit.identifiable; }, "the record determines every one"),
       key(
           "r_squared", [](const Result& r) { return r.fit.r_squared; }, "share of each component's variance explained")
           .entries(3)
           .nullable(),
       key(
           "noise_n", [](const Result& r) { return r.fit.noise_n; },
           "standard deviation of the mean revolution about the fit"),
       key(
           "condition", [](const Result& r) { return r.fit.condition; }, "of the fit"),
       key(
           "measured", [](const Result& r) { return r.forces.measured ? &*r.forces.measured : nullptr; },
           process::measured_table(), "beside the forces of these coefficients; null: they give none")
           .nullable(),
       key(
           "notes",
           [](const Result& r) {
             std::vector<std::string> notes = r.fit.notes;
             if (!r.rejected.empty()) notes.push_back("Not to be used: " + r.rejected);
             for (const std::vector<std::string>* more : {&r.forces.warnings, &r.forces.notes}) {
               notes.insert(notes.end(), more->begin(), more->end());
             }
             return notes;
           },
           "sentences for the user"),
       key(
           "assumed", [](const Result& r) { return r.assumed; }, io::assumption_table(),
           "what the input did not give")},
      Use::written, 1);
  return table;
}

}  // namespace

const io::TableInfo& signal_coefficients_document() {
  return signal_table().info();
}

std::string signal_coefficients_json(const SignalCoefficientsResult& result) {
  return io::dump(signal_table().write(result));
}

std::string signal_coefficients_toml(const SignalCoefficientsResult& result) {
  const cutting::SignalFit& fit = result.fit;
  std::string out = result.rejected.empty() ? "" : "# Not to be used: " + printable(result.rejected) + "\n\n";
  out += cutting::coefficients_toml(fit.coefficients);
  io::append(out, "\n# Standard deviations, residuals taken as independent, in the order and units above:\n");
  const auto add = [&out](const char* name, const std::vector<double>& deviations, double unit) {
    io::append(out, "# {}", name);
    for (const double deviation : deviations) {
      if (std::isfinite(deviation)) {
        io::append(out, " {:.3g}", deviation / unit);
      } else {
        io::append(out, " not determined");
      }
    }
    out += '\n';
  };
  add("tangential", fit.deviations.tangential_n_per_m2, units::n_per_mm2);
  add("radial", fit.deviations.radial_n_per_m2, units::n_per_mm2);
  add("axial", fit.deviations.axial_n_per_m2, units::n_per_mm2);
  add("tangential_edge", fit.deviations.tangential_edge_n_per_m, units::n_per_mm);
  add("radial_edge", fit.deviations.radial_edge_n_per_m, units::n_per_mm);
  add("axial_edge", fit.deviations.axial_edge_n_per_m, units::n_per_mm);
  return out;
}

}  // namespace robomill::jobs
