#pragma once
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"

/// Documents of values that were found from measurements, for the sample page; the numbers are invented.
namespace robomill::page {

/// coefficients.json of twelve slots at two speeds. @param text  of a note, where it is not empty
[[nodiscard]] std::string sample_coefficients(const std::string& text = {});
/// stiffness.json of six joints, of which the loads do not turn the last. @param text  of the reason, where not empty
[[nodiscard]] std::string sample_stiffness(const std::string& text = {});
/// joint.json. @param text  of a note, where it is not empty
[[nodiscard]] std::string sample_joint(const std::string& text = {});
/// Four tools in one holder, one of which fails. @param text  of names and reasons, where it is not empty
[[nodiscard]] std::string sample_tools(const std::string& text = {});
/// What was assumed. @param text  of what and how, where it is not empty
[[nodiscard]] std::vector<Assumption> sample_assumed(const std::string& text = {});

}  // namespace robomill::page
