#pragma once
#include <string>

/// Documents of a job for the sample page, of a robot's modes and invented lobes.
namespace robomill::page {

/// lobes.json
[[nodiscard]] std::string sample_lobes();
/// What plan.json says beside its stages' documents: recommended, alternatives, test cuts, feed directions, the
/// decision on a program.
/// @param text  of facts, labels, warnings, notes and what limits the cut, where it is not empty
[[nodiscard]] std::string sample_plan(const std::string& text = {});
/// The spectrum of one test cut. @param text  of its file, its reason and a peak, where it is not empty
[[nodiscard]] std::string sample_recordings(const std::string& text = {});

}  // namespace robomill::page
