#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// What FrfFile::assumed says of FRFs that all stand at one numbered point: they have lost the number.
constexpr std::string_view taken_as_tip = "the tool's tip";

/// FRFs as files hold them, and what a reader of the result must know: data sets skipped, lines left out, units
/// converted.
struct FrfFile {
  FrfSet set;
  std::vector<std::string> notes = {};
  std::vector<Assumption> assumed = {};  ///< of units, names and points that no file states
  /// 1/τ of an exponential window whose damping is still in the FRFs (.json only); 0 where there is none.
  double added_decay_per_s = 0.0;
};

/// Reads FRFs from .uff (.unv .uf), .csv, .txt (.dat .asc), .mat and .json; what each holds stands in
/// docs/formats.md. Several files are put together on the axis of the first; axes are the same where no frequency
/// differs by more than 1e-5 of itself.
///
/// Accelerances and mobilities become receptances, A / (iω)² and V / (iω), where the file says that it holds them; a
/// line at 0 Hz, which has no such integral, is left out of the set.
/// @param as  names for all FRFs in the order of the files, or for those that the files leave unnamed (columns without
///            header, universal files without directions); one unnamed FRF alone is xx
/// @throws InvalidInput with file, and line or JSON path, if a file is missing, empty or of unknown ending, a value is
///     not finite, frequencies do not increase, axes differ (naming both files), a name comes twice, or `as` does not
///     fit
[[nodiscard]] ROBOMILL_API FrfFile read_frfs(const std::vector<std::filesystem::path>& paths,
                                             const std::vector<std::string>& as = {});

struct FrfWriteOptions {
  bool binary_uff = false;  ///< .uff as data set 58b instead of 58
};

/// Writes FRFs with coherence and deviation, where known, as the ending says: .uff (.unv .uf), .csv, .txt, .mat, .json.
/// The file appears whole or not at all.
/// @throws InvalidInput if the set is not valid, the ending is unknown or the place cannot be written
ROBOMILL_API void write_frfs(const std::filesystem::path& path, const FrfSet& set, const FrfWriteOptions& options = {});
/// The same of FRFs from hits: .json carries verdicts and grades too.
ROBOMILL_API void write_frfs(const std::filesystem::path& path, const FrfResult& result,
                             const FrfWriteOptions& options = {});

/// tip.uff as bytes, as data set 58 or 58b.
[[nodiscard]] ROBOMILL_API std::string frf_uff(const FrfSet& set, bool binary = false);
/// tip.json as text. @throws InvalidInput if the set is not valid
[[nodiscard]] ROBOMILL_API std::string frf_json(const FrfSet& set);
/// tip.json with verdicts, grades and notes.
[[nodiscard]] ROBOMILL_API std::string frf_json(const FrfResult& result);
/// What to know of FRFs that were predicted.
struct FrfDoubts {
  std::vector<double> suspect_hz = {};     ///< lines where the measured holder would create energy
  std::vector<double> unreliable_hz = {};  ///< lines where an error of the holder's measurement became a large one
  std::vector<std::string> notes = {};     ///< sentences for the user
  std::vector<Assumption> assumed = {};
};
/// tip.json with these.
[[nodiscard]] ROBOMILL_API std::string frf_json(const FrfSet& set, const FrfDoubts& doubts);

}  // namespace robomill::modal
