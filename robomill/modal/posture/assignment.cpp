#include "robomill/modal/posture/assignment.hpp"

#include <cstddef>
#include <limits>

namespace robomill::modal::detail {
namespace {

/// Rows one by one, each along the cheapest path that frees a column for it. Row and column 0 are none.
/// @param cost  rows <= columns
/// @return of each column its row, from 1; 0: none
std::vector<Eigen::Index> rows_of_columns(const Eigen::MatrixXd& cost) {
  const Eigen::Index rows = cost.rows(), columns = cost.cols();
  const auto room = static_cast<std::size_t>(columns + 1);
  const auto at = [](Eigen::Index k) { return static_cast<std::size_t>(k); };
  std::vector<double> of_row(at(rows) + 1, 0.0), of_column(room, 0.0);
  std::vector<Eigen::Index> row(room, 0), before(room, 0);
  for (Eigen::Index start = 1; start <= rows; ++start) {
    row[0] = start;
    Eigen::Index column = 0;
    std::vector<double> least(room, std::numeric_limits<double>::infinity());
    std::vector<char> done(room, 0);
    do {
      done[at(column)] = 1;
      double step = std::numeric_limits<double>::infinity();
      Eigen::Index next = 0;
      for (Eigen::Index j = 1; j <= columns; ++j) {
        if (done[at(j)] != 0) continue;
        const Eigen::Index i = row[at(column)];
        const double reduced = cost(i - 1, j - 1) - of_row[at(i)] - of_column[at(j)];
        if (reduced < least[at(j)]) {
          least[at(j)] = reduced;
          before[at(j)] = column;
        }
        if (least[at(j)] < step) {
          step = least[at(j)];
          next = j;
        }
      }
      for (Eigen::Index j = 0; j <= columns; ++j) {
        if (done[at(j)] != 0) {
          of_row[at(row[at(j)])] += step;
          of_column[at(j)] -= step;
        } else {
          least[at(j)] -= step;
        }
      }
      column = next;
    } while (row[at(column)] != 0);
    while (column != 0) {
      row[at(column)] = row[at(before[at(column)])];
      column = before[at(column)];
    }
  }
  return row;
}

}  // namespace

std::vector<Eigen::Index> assign(const Eigen::MatrixXd& cost) {
  std::vector<Eigen::Index> out(static_cast<std::size_t>(cost.rows()), -1);
  const bool wide = cost.rows() <= cost.cols();
  const std::vector<Eigen::Index> partner = rows_of_columns(wide ? cost : Eigen::MatrixXd(cost.transpose()));
  for (std::size_t j = 1; j < partner.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j) - 1, row = partner[j] - 1;
    if (row < 0) continue;
    if (wide) {
      out[static_cast<std::size_t>(row)] = column;
    } else {
      out[static_cast<std::size_t>(column)] = row;
    }
  }
  return out;
}

}  // namespace robomill::modal::detail
