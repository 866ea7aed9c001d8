#pragma once
#include <nlohmann/json.hpp>
#include <string>

/// The page's sections, each from the report in shop units; an empty text where there is nothing to show. With `plots`,
/// they carry the places where the script draws.
namespace robomill::report {

using Json = nlohmann::ordered_json;

// sections_cut.cpp: what to cut and why
[[nodiscard]] std::string recommendation_section(const Json& report);
[[nodiscard]] std::string lobes_section(const Json& report, bool plots);
[[nodiscard]] std::string feed_section(const Json& report, bool plots);
[[nodiscard]] std::string pairs_section(const Json& report, bool plots);
[[nodiscard]] std::string recordings_section(const Json& report, bool plots);

// sections_forces.cpp: over a revolution, along a program, over the spindle's rotation
[[nodiscard]] std::string forces_section(const Json& report, bool plots);

// sections_smooth.cpp: what a machine does with a program, beside its limits
[[nodiscard]] std::string smooth_section(const Json& report, bool plots);

// sections_monitor.cpp: what the chatter monitor heard, and how it was calibrated
[[nodiscard]] std::string monitor_section(const Json& report, bool plots);
[[nodiscard]] std::string calibration_section(const Json& report, bool plots);

// sections_assembly.cpp: tool, joint and holder, and what is predicted of them
[[nodiscard]] std::string assembly_section(const Json& report);

// sections_structure.cpp: what was measured and fitted
[[nodiscard]] std::string frf_section(const Json& report, bool plots);
[[nodiscard]] std::string modes_section(const Json& report, bool plots);
[[nodiscard]] std::string hits_section(const Json& report);
[[nodiscard]] std::string notes_section(const Json& report);

/// A section with a heading and a sentence on what it shows; empty if its body is.
[[nodiscard]] std::string section(const char* id, const char* heading, const char* lead, const std::string& body);
/// The place of a plot: which one the script draws there, what it shows to someone who cannot see it, and its caption.
[[nodiscard]] std::string plot(const char* which, const std::string& shows, const char* caption);

}  // namespace robomill::report
