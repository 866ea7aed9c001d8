#pragma once
/// Marks what librobomill exports; everything else stays hidden.
#define ROBOMILL_API __attribute__((visibility("default")))
