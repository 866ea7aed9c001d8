#pragma once
#include <complex>
#include <string>
#include <vector>

#include "robomill/modal/modes.hpp"

/// Documents of a job for the sample page, of a robot's modes and invented lobes.
namespace robomill::report {

/// The eight modes of data/robot-modes.toml.
[[nodiscard]] modal::ModalModel sample_model();
/// H of responses and excitations x (0), y (1) [m/N]. @param keep  modes from 1; empty: all
[[nodiscard]] std::complex<double> sample_receptance(const modal::ModalModel& model, int response, int excitation,
                                                     double frequency_hz, const std::vector<int>& keep = {});

/// modes.json, lobes.json.
[[nodiscard]] std::string sample_modes();
[[nodiscard]] std::string sample_lobes();
/// What plan.json says beside its stages' documents: recommended, alternatives, test cuts, feed directions.
/// @param text  of facts, labels, warnings, notes and what limits the cut, where it is not empty
[[nodiscard]] std::string sample_plan(const std::string& text = {});
/// The spectrum of one test cut. @param text  of its file, its reason and a peak, where it is not empty
[[nodiscard]] std::string sample_recordings(const std::string& text = {});

}  // namespace robomill::report
