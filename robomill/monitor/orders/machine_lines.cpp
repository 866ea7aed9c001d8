#include "robomill/monitor/orders/machine_lines.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace robomill::monitor {
namespace {

constexpr std::size_t beside_cells = 2;  // to each side
constexpr double reach = 0.1;            // of the rotation: so far beyond the rows the nearest one counts

std::size_t cell_of(double frequency_hz) {
  return static_cast<std::size_t>(std::max(0.0, frequency_hz) / Machine::cell_hz);
}

double about(const std::vector<double>& cells, std::size_t cell) {
  double sum = 0.0;
  const std::size_t end = std::min(cells.size(), cell + beside_cells + 1);
  for (std::size_t i = cell > beside_cells ? cell - beside_cells : 0; i < end; ++i) sum += cells[i];
  return sum;
}

}  // namespace

MachineLines::Band MachineLines::band(double frequency_hz) noexcept {
  const auto cell = static_cast<double>(cell_of(frequency_hz));
  return {std::max(0.0, cell - beside_cells) * Machine::cell_hz, (cell + beside_cells + 1) * Machine::cell_hz};
}

// What stands in air stands in a cut, too.
double MachineLines::shown(double frequency_hz, double rotation_hz, bool beside) const noexcept {
  if (!known()) return 0.0;
  const std::size_t cell = cell_of(frequency_hz);
  const double air = about(machine_->air.all, cell);
  const auto& rows = machine_->rows;
  if (rows.empty()) return air;
  const auto at = [&](const LearntRow& row) { return about(beside ? row.beside : row.all, cell); };
  if (rotation_hz <= 0.0) {
    if (machine_->air.hops > 0) return air;
    double most = 0.0;
    for (const LearntRow& row : rows) most = std::max(most, at(row));
    return most;
  }
  const auto above = std::ranges::lower_bound(rows, rotation_hz, {}, &LearntRow::rotation_hz);
  const LearntRow& high = above == rows.end() ? rows.back() : *above;
  const LearntRow& low = above == rows.begin() ? rows.front() : *(above - 1);
  if (rotation_hz > high.rotation_hz * (1.0 + reach) || rotation_hz < low.rotation_hz * (1.0 - reach)) return air;
  const double apart = high.rotation_hz - low.rotation_hz;
  const double part = apart > 0.0 ? std::clamp((rotation_hz - low.rotation_hz) / apart, 0.0, 1.0) : 0.0;
  return std::max(air, (1.0 - part) * at(low) + part * at(high));
}

}  // namespace robomill::monitor
