#pragma once
#include <string>

namespace robomill::page {

/// A made-up cell, as check.json: the workpiece stands too far away.
/// @param text  in place of every text; empty: their own
[[nodiscard]] std::string sample_cell(const std::string& text = {});

}  // namespace robomill::page
