#include "robomill/jobs/predict.hpp"

#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

/// Of a holder's measurement, as a share of itself: what its notes speak of too.
constexpr double measurement_error = 0.01;

/// An error about the assembly names its file.
coupling::TipResult couple(const coupling::AssemblyFile& file, const coupling::TipOptions& options) {
  try {
    return coupling::tip_frfs(file.assembly, file.frequency_hz, options);
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

void compare(TipPrediction& prediction, const std::filesystem::path& path) {
  const modal::FrfFile file = modal::read_frfs({path});
  prediction.notes.insert(prediction.notes.end(), file.notes.begin(), file.notes.end());
  add_assumed(prediction.file.assumed, file.assumed);
  if (file.added_decay_per_s > 0.0) {
    prediction.notes.emplace_back(
        "The measured FRFs hold the damping of an exponential window: their peaks are lower than the tool's.");
  }
  coupling::TipComparison found =
      coupling::compare_tip(prediction.file.assembly, prediction.tip, file.set, path.string());
  prediction.error = std::move(found.error);
  prediction.measured = std::move(found.measured);
}

}  // namespace

TipPrediction predict_tip(const std::filesystem::path& assembly, const std::filesystem::path& measured,
                          const coupling::TipOptions& options, Progress& progress, const std::filesystem::path& joint) {
  TipPrediction out;
  out.file = coupling::read_assembly(assembly, {.joint = joint});
  progress.check();
  out.tip = couple(out.file, options);
  out.holder = holder_with_deviation(out.file);
  out.round = coupling::is_round(out.tip.frfs);
  for (const auto* notes : {&out.file.notes, &out.tip.notes})
    out.notes.insert(out.notes.end(), notes->begin(), notes->end());
  if (out.file.holder) out.notes.insert(out.notes.end(), out.file.holder->notes.begin(), out.file.holder->notes.end());
  if (!measured.empty()) compare(out, measured);
  out.peaks = coupling::tip_peaks(out.tip.frfs, out.measured ? &*out.measured : nullptr);
  return out;
}

}  // namespace robomill::jobs
