#include "robomill/modal/impact/hits_mass.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// The FRFs as one matrix a line: a row each sensor, a column each force; forces at sensors come first.
struct Grid {
  std::vector<Dof> sensors;  // those that were hit come first, as in forces
  std::vector<Dof> forces;
  Index hit_sensors = 0;
  std::vector<std::vector<Frf*>> at;  // [sensor][force], nullptr where it was not measured
};

bool contains(const std::vector<Dof>& dofs, const Dof& dof) {
  return std::find(dofs.begin(), dofs.end(), dof) != dofs.end();
}

Grid arrange(std::vector<Frf>& frfs, const std::vector<Dof>& sensors) {
  std::vector<Dof> forces;
  for (const Frf& frf : frfs) {
    if (!contains(forces, frf.name.excitation)) forces.push_back(frf.name.excitation);
  }
  Grid grid;
  for (const Dof& dof : sensors) {
    if (contains(forces, dof)) grid.sensors.push_back(dof);
  }
  grid.forces = grid.sensors;
  grid.hit_sensors = static_cast<Index>(grid.sensors.size());
  for (const Dof& dof : sensors) {
    if (!contains(grid.sensors, dof)) grid.sensors.push_back(dof);
  }
  for (const Dof& dof : forces) {
    if (!contains(grid.forces, dof)) grid.forces.push_back(dof);
  }
  for (const Dof& response : grid.sensors) {
    std::vector<Frf*> row;
    for (const Dof& force : grid.forces) {
      const auto found = std::find_if(frfs.begin(), frfs.end(), [&](const Frf& frf) {
        return frf.name.response == response && frf.name.excitation == force;
      });
      row.push_back(found == frfs.end() ? nullptr : &*found);
    }
    grid.at.push_back(row);
  }
  return grid;
}

// G = G_m + m s² G_m,:K (I - m s² G_m,KK)^-1 G_m,K: and, to first order, what it makes of the deviations.
void correct_line(const Grid& grid, Index line, Complex mass_s2) {
  const Index rows = static_cast<Index>(grid.sensors.size());
  const Index columns = static_cast<Index>(grid.forces.size());
  const Index k = grid.hit_sensors;
  Eigen::MatrixXcd measured(rows, columns);
  Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(rows, columns);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) {
      const Frf& frf = *grid.at[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      measured(i, j) = frf.receptance(line);
      if (frf.deviation.size() > 0) variance(i, j) = frf.deviation(line) * frf.deviation(line);
    }
  }
  const Eigen::MatrixXcd unloaded = Eigen::MatrixXcd::Identity(k, k) - mass_s2 * measured.topLeftCorner(k, k);
  const Eigen::MatrixXcd back = linear_algebra::inverse(unloaded);
  const Eigen::MatrixXcd hit = measured.leftCols(k) * back;
  Eigen::MatrixXcd clean = measured;
  clean += mass_s2 * hit * measured.topRows(k);

  // dG = (I + m s² G_DK E) dG_m (I + Eᵀ m s² (I - m s² G_m,KK)^-1 G_m,K:), E picking the rows of K.
  Eigen::MatrixXcd left = Eigen::MatrixXcd::Identity(rows, rows);
  left.leftCols(k) += mass_s2 * hit;
  Eigen::MatrixXcd right = Eigen::MatrixXcd::Identity(columns, columns);
  right.topRows(k) += mass_s2 * back * measured.topRows(k);
  const Eigen::MatrixXd clean_variance = left.cwiseAbs2() * variance * right.cwiseAbs2();
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) {
      Frf& frf = *grid.at[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      frf.receptance(line) = clean(i, j);
      if (frf.deviation.size() > 0) frf.deviation(line) = std::sqrt(clean_variance(i, j));
    }
  }
}

}  // namespace

std::vector<Dof> remove_mass(std::vector<Frf>& frfs, const std::vector<Dof>& sensors, const Eigen::VectorXcd& line_s,
                             double mass_kg) {
  const Grid grid = arrange(frfs, sensors);
  if (grid.hit_sensors > 0) {
    for (Index line = 0; line < line_s.size(); ++line) correct_line(grid, line, mass_kg * line_s(line) * line_s(line));
  }
  return {grid.sensors.begin() + grid.hit_sensors, grid.sensors.end()};
}

}  // namespace robomill::modal
