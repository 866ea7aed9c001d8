#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/prediction.hpp"
#include "robomill/modal/frf.hpp"

// Method: robomill/jobs/README.md, "From an assembly (`predict.hpp`)"

namespace robomill::jobs {

/// The tip of an assembly as predicted, and how far a measurement of it is away.
struct TipPrediction {
  coupling::AssemblyFile file;
  coupling::TipResult tip;                ///< of a tool that is to cut: without its accelerometer
  bool round = false;                     ///< yy is xx, and there is nothing between x and y
  std::optional<modal::FrfSet> measured;  ///< of what was measured the FRFs that were predicted too, within the range
  /// Of each measured FRF, ‖predicted - measured‖ / ‖measured‖ over its lines, the accelerometer on the tip.
  std::vector<modal::FrfFitError> error;
  std::vector<coupling::TipPeak> peaks;  ///< of the tip; of what is compared where something is
  std::vector<std::string> notes;
  /// The measured holder's receptances, with their deviation where they were found from a measurement: whoever couples
  /// to them sees which lines are bad. Empty without a measured holder.
  modal::FrfSet holder = {};
};

/// What a prediction is for.
enum class TipUse {
  frfs,    ///< the FRFs of the assembly as it is described
  cutting  ///< a cut: a tool that hangs free is rejected, and an accelerometer is on the tip for the comparison alone
};

/// @param measured  FRFs to compare with; empty: none
/// @param joint     joint.json, in place of the assembly's joint; empty: the assembly's own
/// @throws InvalidInput naming the file, as read_assembly, tip_frfs and read_frfs, or if nothing measured can be
///     compared
/// @throws Interrupted when progress asks to stop
[[nodiscard]] ROBOMILL_API TipPrediction predict_tip(const io::TomlSource& assembly,
                                                     const std::filesystem::path& measured = {},
                                                     const coupling::TipOptions& options = {},
                                                     Progress& progress = Progress::none(),
                                                     const std::filesystem::path& joint = {},
                                                     TipUse use = TipUse::frfs);

/// tip.json with the lines that are not to be trusted, and why.
[[nodiscard]] ROBOMILL_API std::string tip_json(const TipPrediction& prediction);

}  // namespace robomill::jobs
