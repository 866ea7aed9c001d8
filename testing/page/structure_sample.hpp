#pragma once
#include <complex>
#include <string>
#include <vector>

#include "robomill/modal/modes.hpp"

/// Documents of a robot's structure, and of a tool in a holder that has nothing to do with it, for the sample page.
namespace robomill::page {

/// The eight modes of data/robot-modes.toml.
[[nodiscard]] modal::ModalModel sample_model();
/// H of responses and excitations x (0), y (1) [m/N]. @param keep  modes from 1; empty: all
[[nodiscard]] std::complex<double> sample_receptance(const modal::ModalModel& model, int response, int excitation,
                                                     double frequency_hz, const std::vector<int>& keep = {});

/// modes.json
[[nodiscard]] std::string sample_modes();
/// tip.json with hits and grades; the modes' FRFs; FRFs measured beside them.
/// @param text  of a hit, its reason, a fault and a remedy, where it is not empty
[[nodiscard]] std::string sample_frf(const std::string& text = {});
[[nodiscard]] std::string sample_fitted();
[[nodiscard]] std::string sample_measured();
/// plan.json's assembly. @param text  of its notes and the holder's file, where it is not empty
[[nodiscard]] std::string sample_assembly(const std::string& text = {});

}  // namespace robomill::page
