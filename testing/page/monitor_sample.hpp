#pragma once
#include <string>

namespace robomill::page {

/// Two channels of a tooth passing with a line that grows, as a recorder saw them.
/// @param text  of names, facts, notes and an event on the stream, where it is not empty
[[nodiscard]] std::string sample_monitor(const std::string& text = {});
/// calibration.json of three recordings. @param name  of the first
[[nodiscard]] std::string sample_calibration(const std::string& name = "hole-001.wav");

}  // namespace robomill::page
