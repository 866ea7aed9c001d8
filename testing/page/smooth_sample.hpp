#pragma once
#include <string>

/// Documents of a zigzag run by three methods, for the sample page. Nothing in them is a prediction.
namespace robomill::page {

/// smooth.json
/// @param text  of names, notes and what was left out, where it is not empty
[[nodiscard]] std::string sample_smooth(const std::string& text = {});
/// The motions of the same methods.
[[nodiscard]] std::string sample_motion();

}  // namespace robomill::page
