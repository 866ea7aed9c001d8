#pragma once
#include <string>

/// Documents of one cut for the sample page, of invented numbers.
namespace robomill::page {

/// lobes.json over radial depth and speed, with two points that were asked for.
[[nodiscard]] std::string sample_sweep();
/// lobes.json of three methods and one that rejects the cut. @param text  of its reason, where it is not empty
[[nodiscard]] std::string sample_comparison(const std::string& text = {});
[[nodiscard]] std::string sample_postures();
/// explain.json of a cut with chatter of mode 8.
[[nodiscard]] std::string sample_explanation();
/// simulation.json of the same cut, and what is recorded of it for the page.
[[nodiscard]] std::string sample_simulation();
[[nodiscard]] std::string sample_vibration();

}  // namespace robomill::page
