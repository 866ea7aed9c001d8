#include "robomill/serve/lobes/live_lobes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/planned_cut.hpp"
#include "robomill/serve/files/lobes_fields.hpp"
#include "robomill/serve/files/toml_literal.hpp"

namespace robomill::serve {
namespace {

using stability::LobesOptions;
using stability::Method;

constexpr std::size_t most_settings = 64, most_points = 16;
constexpr int limit_speeds = 100;
constexpr int picture_steps = 150;  // of the depths' range: a limit lies between two of them

std::vector<stability::OperatingPoint> points_of(const io::JsonNode& root) {
  std::vector<stability::OperatingPoint> points;
  if (!root.has("at")) return points;
  const io::JsonNode list = root.at("at");
  if (list.size() > most_points) throw list.reject(fmt::format("must have {} points at most", most_points));
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Eigen::VectorXd pair = list.at(i).numbers();
    if (pair.size() != 2) throw list.at(i).reject("must be [spindle speed in rpm, depth in mm]");
    points.push_back({pair(0) * units::rpm, pair(1) * units::mm});
  }
  return points;
}

/// Of radii. In the plane more digits cost next to nothing, and at fewer an island may be seen where none is.
double picture_tolerance(const stability::LobesProblem& problem) {
  return problem.in_three_directions() ? 1e-4 : 1e-6;
}

/// What a picture needs of the file's options; what it does without is added to the notes.
LobesOptions picture_options(const jobs::LobesFile& cut, bool chart, std::vector<std::string>& notes) {
  LobesOptions options = cut.options;
  options.tolerance = std::max(options.tolerance, picture_tolerance(cut.problem));
  options.limit_step_m = (options.axial_depth_m[1] - options.axial_depth_m[0]) / picture_steps;
  options.output = chart ? stability::Output::boundary : stability::Output::limits;
  if (options.method == Method::multi_frequency) {
    if (!cut.problem.has_measured()) {
      options.method = Method::collocation;  // they agree where both have converged
    } else if (!chart) {
      options.method = Method::zeroth_order;
      notes.emplace_back("While a slider moves the limit is that of the zeroth order, which knows no flips.");
    }
  }
  const bool spatial = cut.problem.in_three_directions();
  if (chart) {
    const bool slow = options.method == Method::multi_frequency;
    const std::array<int, 2> most = slow ? std::array{60, 60} : spatial ? std::array{80, 33} : std::array{120, 61};
    options.grid = {std::min(options.grid[0], most[0]), std::min(options.grid[1], most[1])};
  } else {
    options.grid = {limit_speeds, std::clamp(options.grid[1], 25, spatial ? 41 : 200)};
  }
  return options;
}

/// Of the file, or of what its modes know of themselves; with as many samples as there is time for. None: 0 samples.
stability::Uncertainty band_of(const jobs::LobesFile& cut) {
  stability::Uncertainty band = cut.uncertainty;
  const auto knows = [](const modal::Mode& mode) {
    return std::isfinite(mode.frequency_std_hz) || std::isfinite(mode.damping_ratio_std) ||
           std::isfinite(mode.residue_std_ratio);
  };
  const stability::LobesProblem& problem = cut.problem;
  const bool known = std::ranges::any_of(problem.dynamics.modes, knows) ||
                     std::ranges::any_of(problem.workpiece_dynamics.modes, knows);
  if (problem.has_measured() || (band.samples == 0 && !known)) return {};
  const double modes = static_cast<double>(problem.dynamics.modes.size() + problem.workpiece_dynamics.modes.size());
  const bool by_depth = problem.in_three_directions() || problem.milling.tool.helix_rad != 0.0;
  const double work = (by_depth ? 3.0 : 1.0) * std::max(1.0, modes / 8.0);  // beside a straight tooth and eight modes
  const int most = std::max(20, static_cast<int>(60.0 / work));
  band.samples = band.samples == 0 ? most : std::min(band.samples, most);
  band.grid = {std::min(band.grid[0], work > 3.0 ? 20 : 40), std::min(band.grid[1], 25)};
  return band;
}

void compute_chart(jobs::LobesJobResult& result, const LobesOptions& options, std::vector<std::string>& notes,
                   Progress& progress) {
  const jobs::LobesFile& cut = result.cut;
  result.lobes = stability::compute_lobes(cut.problem, options, progress);
  if (const stability::Uncertainty band = band_of(cut); band.samples > 0) {
    LobesOptions rough = options;
    rough.limit_step_m *= 3.0;
    result.uncertain = stability::uncertain_limits(cut.problem, rough, band, progress);
    if (!cut.band_note.empty()) notes.push_back(cut.band_note);
    notes.push_back(fmt::format("The band is that of {} samples.", band.samples));
  }
  if (cut.surface_grid[0] > 0) notes.emplace_back("The surface error is not drawn here: robomill lobes computes it.");
}

void compute(jobs::LobesJobResult& result, const LiveLobesRequest& request, std::vector<std::string>& notes,
             Progress& progress) {
  jobs::LobesFile& cut = result.cut;
  cut.options.points = request.points;
  if (cut.sweep != stability::SweptParameter::axial_depth) {
    stability::SweepOptions sweep = jobs::sweep_options(cut);
    const std::array<int, 2> most = request.chart ? std::array{60, 40} : std::array{25, 21};
    sweep.grid = {std::min(sweep.grid[0], most[0]), std::min(sweep.grid[1], most[1])};
    sweep.tolerance = std::max(sweep.tolerance, picture_tolerance(cut.problem));
    result.sweep = stability::compute_sweep(cut.problem, sweep, progress);
    return;
  }
  const LobesOptions options = picture_options(cut, request.chart, notes);
  if (request.chart) return compute_chart(result, options, notes, progress);
  result.lobes = stability::compute_lobes(cut.problem, options, progress);
}

io::Json modes_json(const stability::LobesProblem& problem) {
  io::Json list = io::Json::array();
  const std::vector<int>& keep = problem.keep_modes;
  for (std::size_t i = 0; i < problem.dynamics.modes.size(); ++i) {
    const modal::Mode& mode = problem.dynamics.modes[i];
    const int number = static_cast<int>(i) + 1;
    list.push_back({{"number", number},
                    {"frequency_hz", io::number(mode.frequency_hz)},
                    {"damping_ratio", io::number(mode.damping_ratio)},
                    {"kept", keep.empty() || std::ranges::find(keep, number) != keep.end()}});
  }
  return list;
}

}  // namespace

LiveLobesRequest read_live_lobes_request(std::string_view body) {
  const io::Json json = io::parse_json(body, "request");
  const io::JsonNode root(json, "request");
  root.require_object();
  LiveLobesRequest out;
  out.file = root.at("file").text();
  if (root.has("set")) {
    const io::JsonNode set = root.at("set");
    set.require_object();
    if (set.json().size() > most_settings) throw set.reject(fmt::format("must have {} keys at most", most_settings));
    for (const auto& [key, value] : set.json().items()) {
      out.settings.push_back({key, toml_literal(io::JsonNode(value, "request", "set." + key))});
    }
  }
  if (root.has("answer")) {
    const std::string answer = root.at("answer").text();
    if (answer != "limit" && answer != "chart") throw root.at("answer").reject("must be \"limit\" or \"chart\"");
    out.chart = answer == "chart";
  }
  out.points = points_of(root);
  out.order = read_client_order(root);
  return out;
}

std::string LiveLobes::answer(const LiveLobesRequest& request, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const io::TomlSource source(request.file, {}, request.settings);
  jobs::LobesJobResult result;
  jobs::LobesFile& cut = result.cut;
  cut = jobs::read_lobes(source);
  jobs::require_modes_in_three_directions(cut);
  // Seconds of a posture or a fit are not thrown away: the next request needs them too.
  const std::vector<std::filesystem::path> planned_by = jobs::jobs_of_cut(request.file);
  if (planned_by.size() > 1) cut.notes.push_back(jobs::several_jobs_text(planned_by, request.file));
  if (planned_by.size() == 1) {
    dynamics_.load_plan(cut, planned_by.front(), Progress::none());
  } else {
    dynamics_.load(cut, Progress::none());
  }
  progress.check();
  cut.validate();
  std::vector<std::string> notes = cut.notes;
  for (const Assumption& one : cut.assumed) {
    if (one.what == io::sample_left)
      notes.push_back(fmt::format("Assumed: {} = {}, a sample value.", one.key, one.taken));
  }
  cut.document->locate([&] { compute(result, request, notes, progress); });
  const std::string document = jobs::lobes_document(result);
  const io::Json fields = lobes_fields(source, cut);
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - begin;
  return fmt::format(
      R"({{"sequence": {}, "lobes": {}, "modes": {}, "fields": {}, "notes": {}, "milliseconds": {:.1f}}})",
      request.order.sequence, document, io::plain_text(modes_json(cut.problem)), io::plain_text(fields),
      io::dump(io::Json(notes)), spent.count());
}

}  // namespace robomill::serve
