#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/coupling/files/assembly_json.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

using io::key;
using io::Schema;
using io::Use;

const Schema<coupling::TipPeak>& tip_peak_table() {
  using coupling::TipPeak;
  static const Schema<TipPeak> table(
      "tip_peak", "a peak of a predicted FRF",
      {key(
           "frf", [](const TipPeak& peak) { return modal::to_string(peak.name); }, "which"),
       key("frequency_hz", &TipPeak::frequency_hz, "where"),
       key("receptance_m_per_n", &TipPeak::receptance_m_per_n, "magnitude"),
       key("measured_frequency_hz", &TipPeak::measured_frequency_hz, "of the measured peak nearest to it").nullable()},
      Use::written);
  return table;
}

const Schema<coupling::AssemblyFile>& holder_table() {
  using coupling::AssemblyFile;
  const auto drawn = [](const AssemblyFile& file) { return file.assembly.holder.receptances.frfs.empty(); };
  static const Schema<AssemblyFile> table(
      "assembly_holder", "the holder: its segments, or its measured receptances",
      {where([](const AssemblyFile& file) { return file.assembly.holder.free; },
             key(
                 "free", [](const AssemblyFile& file) { return file.assembly.holder.free; }, "nothing holds the tool")),
       where(drawn, key(
                        "segments", [](const AssemblyFile& file) { return file.assembly.holder.segments; },
                        coupling::segment_table(), "from the joint on")),
       where([drawn](const AssemblyFile& file) { return !drawn(file); },
             key(
                 "receptances", [](const AssemblyFile& file) { return file.receptances.filename().string(); },
                 "name of their file"))},
      Use::written);
  return table;
}

/// By the FRF's name.
io::Row<TipPrediction> error_key() {
  auto row = key(
      "relative_error",
      [](const TipPrediction& tip) {
        std::vector<std::pair<std::string, double>> out;
        for (const modal::FrfFitError& one : tip.error) out.emplace_back(modal::to_string(one.name), one.relative);
        return tip.measured ? std::optional(out) : std::nullopt;
      },
      "of each measured FRF; none: nothing was measured");
  row.key.named = true;
  return row.nullable().null_list();
}

}  // namespace

std::string tip_json(const TipPrediction& prediction) {
  modal::FrfDoubts doubts{.suspect_hz = prediction.tip.suspect_hz};
  const auto note = [&](const std::vector<std::string>& notes) {
    doubts.notes.insert(doubts.notes.end(), notes.begin(), notes.end());
  };
  if (const std::optional<coupling::HolderResult>& holder = prediction.file.holder) {
    doubts.unreliable_hz = holder->unreliable_hz;
    note(holder->notes);
  }
  note(prediction.file.notes);
  note(prediction.tip.notes);
  doubts.assumed = prediction.file.assumed;
  return modal::frf_json(prediction.tip.frfs, doubts);
}

const Schema<TipPrediction>& assembly_table() {
  using Tip = TipPrediction;
  static const Schema<Tip> table(
      "assembly", "a tool in its holder, as its tip was predicted",
      {key(
           "file", [](const Tip& tip) { return tip.file.path.filename().string(); }, "name of assembly.toml"),
       key(
           "tool", [](const Tip& tip) { return tip.file.assembly.tool; }, coupling::segment_table(), "from the tip on"),
       key(
           "joint", [](const Tip& tip) { return tip.file.assembly.joint; }, coupling::assembly_joint_table(),
           "none: rigid")
           .nullable(),
       key(
           "holder", [](const Tip& tip) { return &tip.file; }, holder_table(), "behind the joint"),
       where([](const Tip& tip) { return tip.file.assembly.accelerometer.mass_kg > 0.0; },
             key(
                 "accelerometer_mass_kg", [](const Tip& tip) { return tip.file.assembly.accelerometer.mass_kg; },
                 "glued to the tip")),
       where([](const Tip& tip) { return tip.file.assembly.accelerometer.mass_kg > 0.0; },
             key(
                 "accelerometer_offset_mm", [](const Tip& tip) { return tip.file.assembly.accelerometer.offset_m; },
                 "of its centre of mass, beyond the tip")),
       key("peaks", &Tip::peaks, tip_peak_table(), "the first of each FRF"), error_key(),
       key(
           "suspect_hz", [](const Tip& tip) { return tip.tip.suspect_hz; },
           "lines where the measured holder would create energy"),
       key(
           "unreliable_hz",
           [](const Tip& tip) { return tip.file.holder ? tip.file.holder->unreliable_hz : std::vector<double>(); },
           "lines where an error of the holder's measurement becomes a large one"),
       key("notes", &Tip::notes, "sentences for the user")},
      Use::written, 1);
  return table;
}

}  // namespace robomill::jobs
