#pragma once
#include <string>

#include "robomill/report/report.hpp"

namespace robomill::report {

/// What plan.json says beside its stages' documents, of invented lobes: recommended, alternatives, test cuts, feed
/// directions. @param text  of facts, warnings, notes and what limits the cut, where it is not empty
[[nodiscard]] std::string sample_plan(const Lobes& lobes, const std::string& text = {});
/// The spectrum of one test cut. @param text  of its file, its reason and a peak, where it is not empty
[[nodiscard]] std::string sample_recordings(const std::string& text = {});

}  // namespace robomill::report
