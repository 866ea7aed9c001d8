#pragma once

/// Semantic versioning; while the major version is 0, a new minor version may change interfaces, and the shared
/// library's SOVERSION is major.minor.
#define ROBOMILL_VERSION "0.1.0"
