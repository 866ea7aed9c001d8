#pragma once

// Method: robomill/base/README.md, "Method"

/// Marks what librobomill exports; everything else stays hidden.
#define ROBOMILL_API __attribute__((visibility("default")))
