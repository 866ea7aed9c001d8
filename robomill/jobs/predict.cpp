#include "robomill/jobs/predict.hpp"

#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

/// Of a holder's measurement, as a share of itself: what its notes speak of too.
constexpr double measurement_error = 0.01;

/// An error about the assembly names its file.
coupling::TipResult couple(const coupling::AssemblyFile& file, const coupling::Assembly& assembly,
                           const coupling::TipOptions& options) {
  try {
    return coupling::tip_frfs(assembly, file.frequency_hz, options);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.where.empty()) parts.where = file.path.string();
    throw InvalidInput(std::move(parts));
  }
}

modal::FrfSet holder_with_deviation(const coupling::AssemblyFile& file) {
  modal::FrfSet out = file.assembly.holder.receptances;
  if (!file.holder) return out;  // as it was measured
  // Where the receptance itself vanishes the amplification has no bound.
  const Eigen::ArrayXd amplification =
      file.holder->amplification.array().isFinite().select(file.holder->amplification.array(), 1e6).min(1e6);
  for (modal::Frf& frf : out.frfs) {
    frf.deviation = measurement_error * amplification * frf.receptance.array().abs();
  }
  return out;
}

/// @param assembly, tip  as they were when they were measured
void compare(TipPrediction& prediction, const coupling::Assembly& assembly, const coupling::TipResult& tip,
             const std::filesystem::path& path) {
  const modal::FrfFile file = modal::read_frfs({path});
  prediction.notes.insert(prediction.notes.end(), file.notes.begin(), file.notes.end());
  add_assumed(prediction.file.assumed, file.assumed);
  if (file.added_decay_per_s > 0.0) {
    prediction.notes.emplace_back(
        "The measured FRFs hold the damping of an exponential window: their peaks are lower than the tool's.");
  }
  coupling::TipComparison found = coupling::compare_tip(assembly, tip, file.set, path.string());
  prediction.error = std::move(found.error);
  prediction.measured = std::move(found.measured);
}

}  // namespace

TipPrediction predict_tip(const io::TomlSource& assembly, const std::filesystem::path& measured,
                          const coupling::TipOptions& options, Progress& progress, const std::filesystem::path& joint,
                          TipUse use) {
  TipPrediction out;
  out.file = coupling::read_assembly(assembly, {.joint = joint, .cuts = use == TipUse::cutting});
  progress.check();
  out.tip = couple(out.file, out.file.assembly, options);
  out.holder = holder_with_deviation(out.file);
  out.round = coupling::is_round(out.tip.frfs);
  for (const auto* notes : {&out.file.notes, &out.tip.notes})
    out.notes.insert(out.notes.end(), notes->begin(), notes->end());
  if (out.file.holder) out.notes.insert(out.notes.end(), out.file.holder->notes.begin(), out.file.holder->notes.end());
  coupling::Assembly as_measured = out.file.assembly;
  coupling::TipResult loaded;
  const bool was_loaded = out.file.removed_accelerometer.mass_kg > 0.0 && !measured.empty();
  if (was_loaded) {
    as_measured.accelerometer = out.file.removed_accelerometer;
    loaded = couple(out.file, as_measured, options);
    out.file.cutting_note +=
        " It is on the tip where it is compared with what was measured (error and peaks), which is taken to hold its "
        "mass: FRFs of hits with acquisition.accelerometer_mass_kg do not.";
  }
  if (!out.file.cutting_note.empty()) out.notes.push_back(out.file.cutting_note);
  const coupling::TipResult& compared = was_loaded ? loaded : out.tip;
  if (!measured.empty()) compare(out, as_measured, compared, measured);
  out.peaks = coupling::tip_peaks(compared.frfs, out.measured ? &*out.measured : nullptr);
  return out;
}

}  // namespace robomill::jobs
