#pragma once
// Cells, forces files and programs that tests of whole programs share.
#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>

#include "robomill/io/file.hpp"

namespace robomill::test_support {

/// cell.toml of examples/force-along-program: an arm before a workpiece; the axes of W are those of B.
/// @param source                 the root of the sources
/// @param stiffness_n_m_per_rad  of every joint; 0: the example's own
inline std::string arm_cell(const std::filesystem::path& source, double stiffness_n_m_per_rad = 0.0) {
  std::string cell = io::read_file(source / "examples/force-along-program/cell.toml");
  if (!(stiffness_n_m_per_rad > 0.0)) return cell;
  const std::size_t begin = cell.find("joint_stiffness_n_m_per_rad");
  const std::size_t end = cell.find('\n', begin);
  cell.replace(begin, end - begin,
               fmt::format("joint_stiffness_n_m_per_rad = [{0}, {0}, {0}, {0}, {0}, {0}]", stiffness_n_m_per_rad));
  return cell;
}

/// A cutter in a box of material.
struct CutFile {
  std::string kind = "ball-end";
  double diameter_mm = 6.0;
  int teeth = 2;
  double helix_deg = 30.0;
  double tangential_n_per_mm2 = 900.0, radial_n_per_mm2 = 350.0, axial_n_per_mm2 = 150.0;
  double tangential_edge_n_per_mm = 0.0, radial_edge_n_per_mm = 0.0;
  std::array<double, 3> min_mm = {-20.0, -8.0, -8.0}, max_mm = {20.0, 8.0, 0.0};
  double dexel_mm = 0.2;
};

/// forces.toml of a program.
inline std::string forces_file(const CutFile& cut = {}) {
  return fmt::format(R"([tool]
kind = "{}"
diameter_mm = {}
teeth = {}
helix_deg = {}
[coefficients]
tangential_n_per_mm2 = {}
radial_n_per_mm2 = {}
axial_n_per_mm2 = {}
tangential_edge_n_per_mm = {}
radial_edge_n_per_mm = {}
[stock]
kind = "box"
min_mm = [{}, {}, {}]
max_mm = [{}, {}, {}]
dexel_mm = {}
)",
                     cut.kind, cut.diameter_mm, cut.teeth, cut.helix_deg, cut.tangential_n_per_mm2,
                     cut.radial_n_per_mm2, cut.axial_n_per_mm2, cut.tangential_edge_n_per_mm, cut.radial_edge_n_per_mm,
                     cut.min_mm[0], cut.min_mm[1], cut.min_mm[2], cut.max_mm[0], cut.max_mm[1], cut.max_mm[2],
                     cut.dexel_mm);
}

}  // namespace robomill::test_support
