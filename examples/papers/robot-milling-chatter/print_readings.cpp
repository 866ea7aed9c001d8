// print_readings FOLDER: every reading of the cuts and of table 4-4, and what speaks for it. Writes
//   readings.csv  a row a reading: limits, cuts agreed, rank correlation, peaks
//   scores.csv    a row a reading of the cuts, over all 32 of table 4-4; the chosen one is marked
//   pairs.csv     a row a pair of modes alone: the lowest limit, as fig. 4-11 shows it
//   chart.csv     a row a speed: the limit of all modes and of each pair alone, under the chosen reading
//   cuts.csv      a row a cut of table 4-5, under the chosen reading and data/robot-modes.toml
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "examples/papers/robot-milling-chatter/readings.hpp"
#include "robomill/io/file.hpp"

namespace {

using namespace robomill;
using examples::CutReading;
using examples::ModeTable;

std::string number_or_none(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : "none";
}

std::string words_of(const CutReading& cut) {
  return fmt::format("{},{:.0f},{}", cut.teeth, cut.feed_direction_rad * 180.0 / std::numbers::pi,
                     cut.y_to_the_right ? "right" : "left");
}

std::string words_of(const ModeTable& table) {
  std::string out;
  for (std::size_t k = 0; k < table.size(); ++k) {
    out += fmt::format(",{:g}", examples::double_readings()[k].values[static_cast<std::size_t>(table[k])]);
  }
  return out;
}

std::string names_of_double_readings() {
  std::string out;
  for (const examples::DoubleReading& twice : examples::double_readings()) out += fmt::format(",{}", twice.name);
  return out;
}

/// readings.csv, and the scores over the readings of table 4-4.
std::vector<examples::Score> write_readings(const std::filesystem::path& folder) {
  std::string text = "teeth,feed_direction_deg,y_to_the" + names_of_double_readings();
  for (const double speed : examples::cut_table().speeds_rpm) text += fmt::format(",limit_{:.0f}_rpm_mm", speed);
  text += ",agreed_of_6,rank_correlation,peaks_of_8\n";
  std::vector<examples::Score> scores;
  const std::vector<ModeTable> tables = examples::mode_tables();
  for (const CutReading& cut : examples::cut_readings()) {
    examples::Score& score = scores.emplace_back();
    score.cut = cut;
    for (const ModeTable& table : tables) {
      const examples::Evidence found = examples::evidence_of({.cut = cut, .table = table});
      score.agreed += found.agreed / static_cast<double>(tables.size());
      score.correlation += found.correlation / static_cast<double>(tables.size());
      text += words_of(cut) + words_of(table);
      for (const double limit : found.limit_mm) text += "," + number_or_none(limit);
      text += fmt::format(",{},{:.3f},{}\n", found.agreed, found.correlation, found.peaks);
    }
  }
  io::write_file(folder / "readings.csv", text);
  return scores;
}

void write_scores(const std::filesystem::path& folder, const std::vector<examples::Score>& scores) {
  const std::size_t best = examples::chosen(scores);
  std::string text = "teeth,feed_direction_deg,y_to_the,mean_agreed_of_6,mean_rank_correlation,chosen\n";
  for (std::size_t k = 0; k < scores.size(); ++k) {
    text += fmt::format("{},{:.3f},{:.3f},{}\n", words_of(scores[k].cut), scores[k].agreed, scores[k].correlation,
                        k == best ? "yes" : "no");
  }
  io::write_file(folder / "scores.csv", text);
}

std::string_view stated_result(std::size_t speed, double depth_mm) {
  for (const examples::StatedCut& cut : examples::cut_table().stated) {
    if (cut.speed == speed && cut.depth_mm == depth_mm) return decision::to_string(cut.result);
  }
  return "";
}

void write_cuts(const std::filesystem::path& folder, const CutReading& chosen) {
  std::string text = "spindle_speed_rpm,axial_depth_mm,rotation_hz,tooth_passing_hz,limit_mm,predicted,stated,agrees\n";
  const examples::Evidence found = examples::evidence_of({.cut = chosen, .table = examples::as_data});
  for (std::size_t k = 0; k < found.limit_mm.size(); ++k) {
    const double rotation_hz = examples::cut_table().speeds_rpm[k] / 60.0;
    for (const double depth_mm : examples::cut_table().depths_mm[k]) {
      std::string_view agrees;
      for (const examples::StatedCut& cut : examples::cut_table().stated) {
        if (cut.speed == k && cut.depth_mm == depth_mm)
          agrees = examples::agrees(cut, found.limit_mm[k]) ? "yes" : "no";
      }
      text += fmt::format("{:.0f},{},{:.4f},{:.4f},{},{},{},{}\n", examples::cut_table().speeds_rpm[k], depth_mm,
                          rotation_hz, chosen.teeth * rotation_hz, number_or_none(found.limit_mm[k]),
                          depth_mm < found.limit_mm[k] ? "stable" : "chatter", stated_result(k, depth_mm), agrees);
    }
  }
  io::write_file(folder / "cuts.csv", text);
}

void write_pairs(const std::filesystem::path& folder) {
  std::string text = "teeth,feed_direction_deg,y_to_the,modes" + names_of_double_readings() + ",lowest_mm,at_rpm\n";
  for (const CutReading& cut : examples::cut_readings()) {
    for (const int first : {1, 3, 5, 7}) {
      for (const ModeTable& table : examples::mode_tables()) {
        if (!examples::differs_in(table, first)) continue;
        const examples::PairLimit limit = examples::pair_limit({.cut = cut, .table = table}, first);
        text += fmt::format("{},{}-{}{},{},{:.0f}\n", words_of(cut), first, first + 1, words_of(table),
                            number_or_none(limit.lowest_mm), limit.at_rpm);
      }
    }
  }
  io::write_file(folder / "pairs.csv", text);
}

void write_chart(const std::filesystem::path& folder, const CutReading& chosen) {
  const examples::Reading reading = {.cut = chosen, .table = examples::as_data};
  std::string text = "spindle_speed_rpm,all_mm,modes_1_2_mm,modes_3_4_mm,modes_5_6_mm,modes_7_8_mm\n";
  std::vector<std::vector<double>> curves = {examples::chart_mm(reading, {})};
  for (const int first : {1, 3, 5, 7}) curves.push_back(examples::chart_mm(reading, {first, first + 1}));
  const std::vector<double> speeds_rpm = examples::chart_speeds_rpm();
  for (std::size_t k = 0; k < speeds_rpm.size(); ++k) {
    text += fmt::format("{:.0f}", speeds_rpm[k]);
    for (const std::vector<double>& curve : curves) text += "," + number_or_none(curve[k]);
    text += '\n';
  }
  io::write_file(folder / "chart.csv", text);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: print_readings FOLDER\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    const std::vector<examples::Score> scores = write_readings(folder);
    write_scores(folder, scores);
    const CutReading cut = scores[examples::chosen(scores)].cut;
    write_cuts(folder, cut);
    write_chart(folder, cut);
    write_pairs(folder);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
