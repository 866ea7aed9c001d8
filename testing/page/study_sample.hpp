#pragma once
#include <string>

/// Documents of a study for the sample page, of invented numbers.
namespace robomill::page {

/// statistics.json with all of its parts. @param text  of a key's value and of a value's name, where it is not empty
[[nodiscard]] std::string sample_statistics(const std::string& text = {});
/// Points of the study, and of its boundary. @param text  of a name and a category, where it is not empty
[[nodiscard]] std::string sample_study_points(const std::string& text = {});

}  // namespace robomill::page
