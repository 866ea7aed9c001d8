#include "robomill/modal/files/modes_schema.hpp"

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/modal/weak_modes.hpp"

namespace robomill::modal {
namespace {

using io::key;
using io::Row;
using io::Schema;
using io::Use;

template <class Value>
using Named = std::vector<std::pair<std::string, Value>>;

/// A mode of a document.
struct ModeView {
  const ModesView* modes = nullptr;
  std::size_t index = 0;
  [[nodiscard]] const Mode& mode() const { return modes->model->modes[index]; }
  [[nodiscard]] ModalStiffness spring() const { return modal_stiffness(*modes->model, index); }
};

Named<std::complex<double>> by_direction(const Eigen::VectorXcd& vector, const std::vector<Dof>& dofs,
                                         bool as_excitation) {
  Named<std::complex<double>> out;
  for (std::size_t i = 0; i < dofs.size(); ++i)
    out.emplace_back(to_string(dofs[i], as_excitation), vector(static_cast<Eigen::Index>(i)));
  return out;
}

const Schema<Mode>& deviation_table() {
  static const Schema<Mode> table("mode_std", "standard deviations of a mode",
                                  {key("frequency_hz", &Mode::frequency_std_hz, "of the frequency").nullable(),
                                   key("damping_ratio", &Mode::damping_ratio_std, "of the damping ratio").nullable(),
                                   key("residue", &Mode::residue_std_ratio, "of the residue, relative").nullable()},
                                  Use::written);
  return table;
}

const Schema<ModeView>& mode_table() {
  static const Schema<ModeView> table(
      "mode", "a mode",
      {key(
           "frequency_hz", [](const ModeView& at) { return at.mode().frequency_hz; }, "natural frequency"),
       key(
           "damping_ratio", [](const ModeView& at) { return at.mode().damping_ratio; }, "share of critical"),
       key(
           "left", [](const ModeView& at) { return by_direction(at.mode().left, at.modes->model->excitations, true); },
           "vector of the forces by their direction, [re, im] in √(s/kg)"),
       key(
           "right", [](const ModeView& at) { return by_direction(at.mode().right, at.modes->model->responses, false); },
           "vector of the responses by their direction, the same"),
       key(
           "modal_stiffness_n_per_um", [](const ModeView& at) { return at.spring().stiffness_n_per_m * units::um; },
           "where and in the direction in which the mode moves most")
           .in_unit()
           .nullable(),
       key(
           "modal_mass_kg", [](const ModeView& at) { return at.spring().mass_kg; }, "the same")
           .nullable(),
       key(
           "weak", [](const ModeView& at) { return at.mode().weak; },
           "the FRFs hardly show the mode: no warning and no name of a vibration rests on it"),
       key(
           "std", [](const ModeView& at) { return &at.mode(); }, deviation_table(), "standard deviations"),
       where([](const ModeView& at) { return at.modes->fit != nullptr; },
             key(
                 "at_bounds",
                 [](const ModeView& at) {
                   std::vector<std::string> out;
                   for (const FitBound bound : at.modes->fit->bounds_of(static_cast<int>(at.index) + 1))
                     out.emplace_back(to_string(bound));
                   return out;
                 },
                 "options whose bound the mode ended at: the FRFs do not show such a mode"))},
      Use::written);
  return table;
}

const Schema<Residual>& residual_table() {
  static const Schema<Residual> table("residual", "the rest of an FRF",
                                      {key("mass", &Residual::mass, "that of lower modes, [re, im]"),
                                       key("stiffness", &Residual::stiffness, "that of higher modes, [re, im]")},
                                      Use::written);
  return table;
}

const Schema<FitResult>& fit_table() {
  static const Schema<FitResult> table(
      "fit", "how well the modes describe the FRFs",
      {key("relative_error", &FitResult::relative_error, "over the band and all FRFs").nullable(),
       key(
           "relative_error_by_frf",
           [](const FitResult& fit) {
             Named<double> out;
             for (const FrfFitError& error : fit.by_frf) out.emplace_back(to_string(error.name), error.relative);
             return out;
           },
           "of each FRF")
           .nullable(),
       key("mean_relative_error", &FitResult::mean_relative_error, "mean over lines and FRFs").nullable(),
       key(
           "converged", [](const FitResult& fit) { return fit.status == FitResult::Status::converged; },
           "as many modes as asked for, and the search ended by itself"),
       key(
           "usable", [](const FitResult& fit) { return fit.usable(); }, "relative_error < 0.2, or accepted"),
       key(
           "band_hz",
           [](const FitResult& fit) {
             return std::array{fit.band_low_hz, fit.band_high_hz};
           },
           "first and last line used")
           .entries(2),
       key("lines", &FitResult::lines, "how many were used"),
       key("dropped_modes_hz", &FitResult::dropped_hz, "weak modes without which the fit is as good")},
      Use::written);
  return table;
}

const Schema<FitResult>& convergence_table() {
  static const Schema<FitResult> table(
      "convergence", "of the search",
      {key("iterations", &FitResult::iterations, "how many"),
       key("best", &FitResult::best, "the objective after each iteration").exact().nullable()},
      Use::written);
  return table;
}

const Schema<StabilisationPoint>& stabilisation_table() {
  static const Schema<StabilisationPoint> table(
      "stabilisation_point", "a pole of the stabilisation diagram",
      {key("order", &StabilisationPoint::order, "of the model"),
       key("frequency_hz", &StabilisationPoint::frequency_hz, "of the pole"),
       key("damping_ratio", &StabilisationPoint::damping_ratio, "of the pole"),
       key(
           "stable",
           [](const StabilisationPoint& point) {
             return point.frequency_stable && point.damping_stable && point.vector_stable;
           },
           "in frequency, damping and vector")},
      Use::written);
  return table;
}

/// A key of the fit, left out where there was none.
Row<ModesView> of_fit(const Row<FitResult>& row) {
  std::vector<Row<ModesView>> lifted =
      io::keys_of<ModesView>(std::vector{row}, [](const ModesView& view) -> const FitResult& { return *view.fit; });
  return where([](const ModesView& view) { return view.fit != nullptr; }, std::move(lifted.front()));
}

}  // namespace

const Schema<ModesView>& modes_table() {
  const auto whole = [](const FitResult& fit) { return &fit; };
  static const Schema<ModesView> table(
      "modes", "modes of a structure",
      {key(
           "modes",
           [](const ModesView& view) {
             std::vector<ModeView> out;
             for (std::size_t k = 0; k < view.model->modes.size(); ++k) out.push_back({&view, k});
             return out;
           },
           mode_table(), "by rising frequency"),
       key(
           "residuals",
           [](const ModesView& view) {
             Named<Residual> out;
             for (const Residual& residual : view.model->residuals)
               out.emplace_back(to_string(residual.name), residual);
             return out;
           },
           residual_table(), "by the FRF's name"),
       of_fit(key("fit", whole, fit_table(), "of the fit that found them")),
       of_fit(key("convergence", whole, convergence_table(), "of that fit")),
       of_fit(key("stabilisation", &FitResult::stabilisation, stabilisation_table(), "of that fit")),
       of_fit(key("warnings", &FitResult::warnings, "sentences for the user"))},
      Use::written, 1);
  return table;
}

}  // namespace robomill::modal
