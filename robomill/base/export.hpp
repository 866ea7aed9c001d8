#pragma once

// Method: robomill/base/README.md, "Method"

/// Marks what librobomill exports: what public headers declare, and what the program `robomill` calls. Everything else
/// stays hidden.
#define ROBOMILL_API __attribute__((visibility("default")))
