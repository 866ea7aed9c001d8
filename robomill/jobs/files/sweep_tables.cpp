#include "robomill/jobs/files/sweep_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/records/hdf5_table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/jobs/sweep/evaluate.hpp"

namespace robomill::jobs {
namespace {

/// @throws InvalidInput if it is not there
void require_chunk(const DoneStudy& study, const SweepPlan& plan, std::uint64_t i, Chunk& out) {
  if (study.folder.find(plan, i, out) == SweepFolder::Found::there) return;
  throw InvalidInput(study.folder.at("chunks").string(),
                     fmt::format("chunk {} is missing or damaged", plan.first_chunk + i), "Run the study again");
}

/// @param take  of each point, in their order: what the keys are set to, what became of it
void for_each_point(const DoneStudy& study,
                    const std::function<void(const std::vector<std::string>&, const PointOutcome&)>& take) {
  Chunk chunk;
  for (const SweepPlan& plan : study.plans) {
    for (std::uint64_t i = 0; i < plan.chunks(); ++i) {
      require_chunk(study, plan, i, chunk);
      for (std::size_t k = 0; k < chunk.points.size(); ++k) {
        take(study.points.values(plan.first_of(i) + k), chunk.points[k]);
      }
    }
  }
}

/// Of a value that a key is set to: texts without their quotes, but in a column with lists, where all stand as TOML
/// writes them.
std::string cell_text(const std::string& value, bool with_lists) {
  return with_lists ? value : io::toml_unquoted(value);
}

void write_csv(const std::filesystem::path& path, const DoneStudy& study) {
  const SweepPlan& plan = study.plans.front();
  const std::vector<bool> with_lists = study.points.with_lists();
  io::LineFile out(path);
  std::string line;
  for (const std::vector<std::string>* names : {&plan.keys, &plan.collect}) {
    for (const std::string& name : *names) line += io::csv_text(name) + ',';
  }
  out.write(line + "state\n");
  for_each_point(study, [&](const std::vector<std::string>& values, const PointOutcome& point) {
    line.clear();
    for (std::size_t k = 0; k < values.size(); ++k) {
      line += (io::parse_number(values[k]) ? values[k] : io::csv_text(cell_text(values[k], with_lists[k]))) + ',';
    }
    for (const double value : point.values) line += std::isnan(value) ? "," : fmt::format("{},", value);
    line.append(name_in(point_state_names, point.state)) += '\n';
    out.write(line);
  });
  out.close();
}

/// The longest text of each key's values, where one of them is no number; 0: numbers alone.
std::vector<std::size_t> longest_texts(const StudyPoints& points) {
  const std::vector<bool> with_lists = points.with_lists();
  std::vector<std::size_t> out(points.keys().size(), 1);
  std::vector<bool> numbers(out.size(), true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<std::string> values = points.values(i);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (numbers[k]) numbers[k] = io::parse_number(values[k]).has_value();
      out[k] = std::max(out[k], cell_text(values[k], with_lists[k]).size());
    }
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (numbers[k]) out[k] = 0;
  }
  return out;
}

void write_hdf5(const std::filesystem::path& path, const DoneStudy& study) {
  const SweepPlan& plan = study.plans.front();
  using Kind = io::Hdf5Table::Kind;
  io::Hdf5Table table(path);
  table.attribute("document", sweep_plan_table().info().document());
  table.attribute("fingerprint", plan.fingerprint);
  const std::vector<std::size_t> longest = longest_texts(study.points);
  const std::vector<bool> with_lists = study.points.with_lists();
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    table.column(plan.keys[k], io::unit_of_key(plan.keys[k]), longest[k] > 0 ? Kind::text : Kind::real, longest[k]);
  }
  for (const std::string& name : plan.collect) table.column(name, unit_of_collected(name));
  table.column("state", "", Kind::text, 8);
  for_each_point(study, [&](const std::vector<std::string>& values, const PointOutcome& point) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (longest[k] > 0)
        table.put(cell_text(values[k], with_lists[k]));
      else
        table.put(*io::parse_number(values[k]));
    }
    for (const double value : point.values) table.put(value);
    table.put(name_in(point_state_names, point.state));
    table.end_row();
  });
  table.finish().commit();
}

void write_boundary_csv(const std::filesystem::path& path, const SweepPlan& plan, const Eigen::MatrixXd& points) {
  io::LineFile out(path);
  std::string line;
  for (const std::string& name : plan.keys) line += (line.empty() ? "" : ",") + io::csv_text(name);
  out.write(line + "\n");
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    line.clear();
    for (Eigen::Index k = 0; k < points.cols(); ++k) line += fmt::format("{}{}", k == 0 ? "" : ",", points(i, k));
    out.write(line + "\n");
  }
  out.close();
}

void write_boundary_hdf5(const std::filesystem::path& path, const SweepPlan& plan, const Eigen::MatrixXd& points) {
  io::Hdf5Table table(path);
  table.attribute("document", std::string("boundary/1"));
  table.attribute("fingerprint", plan.fingerprint);
  for (const std::string& name : plan.keys) table.column(name, io::unit_of_key(name));
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) table.put(points(i, k));
    table.end_row();
  }
  table.finish().commit();
}

bool is_csv(const std::filesystem::path& path) {
  const std::string ending = io::lowered(path.extension().string());
  if (ending == ".csv") return true;
  if (ending == ".h5" || ending == ".hdf5") return false;
  throw InvalidInput(path.string(), "must end in .h5, .hdf5 or .csv");
}

/// Values as TOML writes them, as numbers where all are; else as they stand in results.csv.
void set_numbers(StudyColumn& column, bool with_lists) {
  const auto is_number = [](const std::string& text) { return io::parse_number(text).has_value(); };
  if (std::ranges::all_of(column.texts, is_number)) {
    for (const std::string& text : column.texts) column.numbers.push_back(*io::parse_number(text));
    column.texts.clear();
  }
  for (std::string& text : column.texts) text = cell_text(text, with_lists);
}

template <class Unit>
std::vector<StudyColumn> columns_named(const std::vector<std::string>& names, const Unit& unit) {
  std::vector<StudyColumn> out;
  out.reserve(names.size());
  for (const std::string& name : names) out.push_back({.name = name, .unit = unit(name)});
  return out;
}

}  // namespace

void write_sweep_table(const std::filesystem::path& path, const DoneStudy& study) {
  is_csv(path) ? write_csv(path, study) : write_hdf5(path, study);
}

void write_boundary_table(const std::filesystem::path& path, const SweepPlan& plan, const Boundary& boundary) {
  is_csv(path) ? write_boundary_csv(path, plan, boundary.points) : write_boundary_hdf5(path, plan, boundary.points);
}

std::vector<std::vector<double>> columns_of(const DoneStudy& study) {
  std::vector<std::vector<double>> out(study.plans.front().collect.size());
  for_each_point(study, [&](const std::vector<std::string>&, const PointOutcome& point) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i].push_back(point.values[i]);
  });
  return out;
}

ShownPoints shown_points_of(const DoneStudy& study, const Boundary* boundary) {
  const SweepPlan& first = study.plans.front();
  ShownPoints out{.points = study.points.size(),
                  .keys = columns_named(first.keys, io::unit_of_key),
                  .values = columns_named(first.collect, unit_of_collected)};
  const std::vector<std::uint64_t> chosen = even_choice(out.points);
  auto next = chosen.begin();
  Chunk chunk;
  for (const SweepPlan& plan : study.plans) {
    for (std::uint64_t i = 0; i < plan.chunks(); ++i) {
      const std::uint64_t begin = plan.first_of(i), end = begin + plan.size_of(i);
      if (next == chosen.end() || *next >= end) continue;
      require_chunk(study, plan, i, chunk);
      for (; next != chosen.end() && *next < end; ++next) {
        const std::vector<std::string> set = study.points.values(*next);
        for (std::size_t k = 0; k < set.size(); ++k) out.keys[k].texts.push_back(shown_text(set[k]));
        const std::vector<double>& values = chunk.points[*next - begin].values;
        for (std::size_t k = 0; k < values.size(); ++k) {
          out.values[k].numbers.push_back(values[k]);
          out.values[k].infinite += std::isinf(values[k]) ? 1 : 0;
        }
      }
    }
  }
  const std::vector<bool> with_lists = study.points.with_lists();
  for (std::size_t k = 0; k < out.keys.size(); ++k) set_numbers(out.keys[k], with_lists[k]);
  if (boundary == nullptr) return out;
  out.boundary_points = static_cast<std::uint64_t>(boundary->points.rows());
  out.boundary_keys = columns_named(first.keys, io::unit_of_key);
  for (const std::uint64_t i : even_choice(out.boundary_points)) {
    for (std::size_t k = 0; k < out.boundary_keys.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(k);
      out.boundary_keys[k].numbers.push_back(boundary->points(row, column));
    }
  }
  return out;
}

}  // namespace robomill::jobs
