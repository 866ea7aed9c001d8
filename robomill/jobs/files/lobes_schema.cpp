#include "robomill/jobs/files/lobes_schema.hpp"

#include "robomill/cell/files/posture_json.hpp"
#include "robomill/stability/files/lobes_schema.hpp"

namespace robomill::jobs {

const io::Schema<LobesJobResult>& lobes_json_table() {
  const io::TableInfo& chart = stability::lobes_table().info();
  static const io::Schema<LobesJobResult> table(
      chart.name, chart.meaning,
      [] {
        std::vector<io::Row<LobesJobResult>> rows =
            io::keys_of<LobesJobResult>(stability::lobes_table().rows(), [](const LobesJobResult& result) {
              return stability::LobesView(result.lobes, result.uncertain, result.surface);
            });
        rows.push_back(io::key(
                           "posture", [](const LobesJobResult& result) { return result.cut.posture.get(); },
                           cell::posture_table(), "that the modes are of, where they are those of a cell")
                           .optional());
        return rows;
      }(),
      io::Use::written, chart.version);
  return table;
}

}  // namespace robomill::jobs
