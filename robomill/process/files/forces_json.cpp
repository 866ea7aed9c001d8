#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

#include "robomill/base/units.hpp"
#include "robomill/io/json_text.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/process/files/forces_schema.hpp"

namespace robomill::process {
namespace {

/// An empty cell of a component that was not measured.
void add_measured_cells(std::string& text, const Eigen::Matrix3Xd& force_n, Eigen::Index column) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    text += ',';
    if (std::isfinite(force_n(axis, column))) io::append(text, "{:.9g}", force_n(axis, column));
  }
}

std::string revolution_csv(const RevolutionForces& revolution, double sign, const MeasuredRevolution* measured) {
  const cutting::CuttingForce& force = revolution.deflected.force;
  const bool vibrating = revolution.vibrating_force_n.cols() > 0;
  std::string text = "rotation_deg,fx_n,fy_n,fz_n,torque_n_m";
  if (vibrating) text += ",vibrating_fx_n,vibrating_fy_n,vibrating_fz_n";
  if (measured != nullptr) text += ",measured_fx_n,measured_fy_n,measured_fz_n";
  text += '\n';
  for (Eigen::Index i = 0; i < force.rotation_rad.size(); ++i) {
    const Eigen::Vector3d f = sign * force.force_n.col(i);
    io::append(text, "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", force.rotation_rad(i) / units::deg, f.x(), f.y(), f.z(),
               force.torque_n_m(i));
    if (vibrating) {
      const Eigen::Vector3d v = sign * revolution.vibrating_force_n.col(i);
      io::append(text, ",{:.9g},{:.9g},{:.9g}", v.x(), v.y(), v.z());
    }
    if (measured != nullptr) add_measured_cells(text, measured->force.force_n, i);
    text += '\n';
  }
  return text;
}

/// Collects pieces of a text and hands them on.
class Pieces {
 public:
  explicit Pieces(const TakeText& take) : take_(take) {}
  void add(std::string_view piece) {
    text_ += piece;
    if (text_.size() > enough) flush();
  }
  void flush() {
    take_(text_);
    text_.clear();
  }

 private:
  static constexpr std::size_t enough = std::size_t{1} << 16;
  const TakeText& take_;
  std::string text_;
};

void program_csv(const ForcesResult& result, Pieces& pieces, Progress& progress) {
  io::Columns<ForcesLine>::CsvRows rows(forces_columns());
  std::string row;
  each_line(result, [&](const ForcesLine& line) {
    progress.advance();
    row.clear();
    rows.add(row, line);
    pieces.add(row);
  });
  row.clear();
  rows.end(row);
  pieces.add(row);
}

/// As forces_table() writes it, none of whose keys is left out for its value.
void program_json(const ForcesResult& result, Pieces& pieces, Progress& progress) {
  const io::Schema<ForcesResult>& table = forces_table();
  io::JsonText text([&](std::string_view piece) { pieces.add(piece); });
  text.add("document", table.info().document());
  for (const io::Row<ForcesResult>& row : table.rows()) {
    if (row.key.name == blocks_key) {
      text.begin_list(blocks_key);
      each_line(result, [&](const ForcesLine& line) {
        progress.advance();
        text.add_entry(line_table().write(line));
      });
      text.end_list();
    } else if (const io::Json value = table.value(row, result); !value.is_discarded()) {
      text.add(row.key.name, value);
    }
  }
  text.end();
}

}  // namespace

void write_forces_csv(const ForcesResult& result, const TakeText& take, Progress& progress) {
  if (!result.program) {
    const double sign = result.cut.on_workpiece ? -1.0 : 1.0;
    return take(revolution_csv(*result.revolution, sign, result.measured ? &*result.measured : nullptr));
  }
  progress.start("forces.csv", result.program->blocks.size());
  Pieces pieces(take);
  program_csv(result, pieces, progress);
  pieces.flush();
}

void write_forces_json(const ForcesResult& result, const TakeText& take, Progress& progress) {
  if (!result.program) return take(io::dump(forces_table().write(result)));
  progress.start("forces.json", result.program->blocks.size());
  Pieces pieces(take);
  program_json(result, pieces, progress);
  pieces.flush();
}

std::string forces_csv(const ForcesResult& result) {
  std::string out;
  write_forces_csv(result, [&](std::string_view piece) { out += piece; });
  return out;
}

std::string forces_json(const ForcesResult& result) {
  std::string out;
  write_forces_json(result, [&](std::string_view piece) { out += piece; });
  return out;
}

}  // namespace robomill::process
