#pragma once
#include <array>

#include "robomill/base/units.hpp"
#include "robomill/coupling/assembly.hpp"

namespace robomill::formats {

/// A number of a segment as files have it.
struct SegmentField {
  const char* key;
  const char* member;
  double factor;
  double coupling::Segment::*value;
};

inline constexpr std::array<SegmentField, 9> segment_fields = {{
    {"length_mm", "length_m", units::mm, &coupling::Segment::length_m},
    {"diameter_mm", "diameter_m", units::mm, &coupling::Segment::diameter_m},
    {"inner_diameter_mm", "inner_diameter_m", units::mm, &coupling::Segment::inner_diameter_m},
    {"youngs_modulus_gpa", "youngs_modulus_pa", units::gpa, &coupling::Segment::youngs_modulus_pa},
    {"density_kg_per_m3", "density_kg_per_m3", 1.0, &coupling::Segment::density_kg_per_m3},
    {"mass_kg", "mass_kg", 1.0, &coupling::Segment::mass_kg},
    {"poissons_ratio", "poissons_ratio", 1.0, &coupling::Segment::poissons_ratio},
    {"loss_factor", "loss_factor", 1.0, &coupling::Segment::loss_factor},
    {"flute_diameter_ratio", "flute_diameter_ratio", 1.0, &coupling::Segment::flute_diameter_ratio},
}};

}  // namespace robomill::formats
