#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/modal/posture/posture_calibration.hpp"

namespace robomill::cell {

/// The calibration of a cell's postures beside the cell: cell.toml -> cell.calibration.json.
class CalibrationDocument {
 public:
  /// @param cell         its file; where there is none nothing is read or written
  /// @param fingerprint  of the calibration's inputs
  /// @throws InvalidInput if this job writes an output there (io::OutputPlaces)
  CalibrationDocument(const std::filesystem::path& cell, std::string fingerprint);

  /// What it holds; nothing where it is missing or of other inputs, or, with a note, where it is broken.
  [[nodiscard]] std::optional<modal::PostureCalibration> read(std::vector<std::string>& notes) const;
  /// Replaces it, whole or not at all. False, with a note, where what is there is no calibration or it cannot be
  /// written; false without one where the cell has no file.
  bool write(const modal::PostureCalibration& calibration, std::vector<std::string>& notes) const;
  [[nodiscard]] std::string name() const { return path_.filename().string(); }

 private:
  std::filesystem::path path_;
  std::string fingerprint_;
};

}  // namespace robomill::cell
