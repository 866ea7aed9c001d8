#include "robomill/jobs/sweep/evaluate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/settings_use.hpp"
#include "robomill/jobs/dynamics_cache.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"

namespace robomill::jobs {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// A value that is collected.
struct Wanted {
  enum class Kind { limit, chatter_frequency, spectral_radius, path };
  Kind kind = Kind::path;
  stability::OperatingPoint point = {};  ///< of the first three
  std::vector<std::string> path = {};
};

constexpr Name<Wanted::Kind> at_names[] = {{"limit", Wanted::Kind::limit},
                                           {"chatter_frequency", Wanted::Kind::chatter_frequency},
                                           {"abs_mu", Wanted::Kind::spectral_radius}};

std::vector<std::string> parts_of(std::string_view text, char separator) {
  std::vector<std::string> out;
  for (std::size_t end = 0; end != std::string_view::npos; text.remove_prefix(std::min(end + 1, text.size()))) {
    end = text.find(separator);
    out.emplace_back(text.substr(0, end));
  }
  return out;
}

/// @throws InvalidInput naming collect
Wanted wanted_of(const std::string& text, bool of_lobes) {
  const auto reject = [&](std::string rule, std::string hint = {}) {
    return InvalidInput("collect", fmt::format("\"{}\" {}", text, rule), std::move(hint));
  };
  const std::size_t at = text.find('@');
  if (at == std::string::npos) {
    std::vector<std::string> path = parts_of(text, '.');
    if (std::ranges::any_of(path, [](const std::string& part) { return part.empty(); })) {
      throw reject("is no path of a document", "As \"recommended.removal_rate_mm3_per_s\"");
    }
    return {.path = std::move(path)};
  }
  const std::optional<Wanted::Kind> kind = value_in(at_names, text.substr(0, at));
  if (!kind) throw reject("is not known", "Before @ stands " + one_of(at_names));
  if (!of_lobes) throw reject("is of the job lobes alone");
  const std::vector<std::string> numbers = parts_of(std::string_view(text).substr(at + 1), ',');
  const bool has_depth = *kind == Wanted::Kind::spectral_radius;
  std::vector<double> values;
  values.reserve(numbers.size());
  for (const std::string& number : numbers) values.push_back(io::parse_number(number).value_or(-1.0));
  if (values.size() != (has_depth ? 2U : 1U) || !(values[0] > 0.0) || (has_depth && !(values[1] >= 0.0))) {
    throw reject(has_depth ? "must be abs_mu@RPM,MM" : "must have one speed in rpm behind @");
  }
  return {.kind = *kind,
          .point = {.spindle_speed_rad_per_s = values[0] * units::rpm,
                    .axial_depth_m = has_depth ? values[1] * units::mm : 0.0}};
}

/// A number of a document; NaN where it is null or not there.
double number_at(const io::Json& document, const std::vector<std::string>& path) {
  const io::Json* at = &document;
  for (const std::string& part : path) {
    if (at->is_object() && at->contains(part)) {
      at = &(*at)[part];
      continue;
    }
    std::size_t place = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), place);
    if (!at->is_array() || error != std::errc() || end != part.data() + part.size() || place >= at->size())
      return nothing;
    at = &(*at)[place];
  }
  if (at->is_boolean()) return at->get<bool>() ? 1.0 : 0.0;
  return at->is_number() ? at->get<double>() : nothing;
}

double depth_mm(const stability::Limit& limit) {
  return limit.status == stability::Limit::Status::found ? limit.axial_depth_m / units::mm
                                                         : std::numeric_limits<double>::infinity();
}

double frequency_hz(const stability::Limit& limit) {
  return limit.status == stability::Limit::Status::found ? limit.chatter_frequency_hz : nothing;
}

/// The structures of the points' documents, of several threads.
class Structures {
 public:
  void load(LobesFile& cut, Progress& progress) {
    const bool in_files = !cut.modes.empty() || !cut.frf.empty() || !cut.cell.empty() || !cut.workpiece_modes.empty() ||
                          !cut.workpiece_frf.empty();
    if (!cut.job.empty() || !in_files) return load_dynamics(cut, progress);
    const std::lock_guard lock(loading_);
    cache_.load(cut, progress);
  }

 private:
  std::mutex loading_;
  DynamicsCache cache_;
};

/// Speeds and depths of a cut, without its chart.
PointOutcome lobes_at(const std::vector<Wanted>& wanted, const io::TomlSource& source, Structures& structures,
                      Progress& progress) {
  LobesFile cut = read_lobes(source);
  require_modes_in_three_directions(cut);
  structures.load(cut, progress);
  cut.validate();
  PointOutcome out;
  std::map<double, stability::Limit> limits;  // by speed: two values may be of one
  with_words_of(cut, [&] {
    for (const Wanted& one : wanted) {
      const double speed = one.point.spindle_speed_rad_per_s;
      if (one.kind == Wanted::Kind::spectral_radius) {
        out.values.push_back(stability::evaluate_point(cut.problem, cut.options, one.point).spectral_radius);
        continue;
      }
      if (!limits.contains(speed)) limits[speed] = stability::limit_depths(cut.problem, cut.options, {speed}).front();
      out.values.push_back(one.kind == Wanted::Kind::limit ? depth_mm(limits[speed]) : frequency_hz(limits[speed]));
    }
  });
  return out;
}

}  // namespace

std::string unit_of_collected(const std::string& name) {
  const std::optional<Wanted::Kind> kind = value_in(at_names, name.substr(0, name.find('@')));
  if (kind == Wanted::Kind::limit) return "mm";
  if (kind == Wanted::Kind::chatter_frequency) return "Hz";
  if (kind) return "1";
  std::string unit;
  for (const std::string& part : parts_of(name, '.')) {
    if (!io::parse_number(part)) unit = io::unit_of_key(part);
  }
  return unit;
}

struct Evaluator::Parts {
  const Verb& verb;
  std::filesystem::path study, base;
  io::Json options = io::Json::object();
  std::vector<Wanted> wanted = {};
  std::vector<Wanted> at_points = {};  ///< of these what needs no document
  std::unique_ptr<Structures> structures = std::make_unique<Structures>();

  [[nodiscard]] PointOutcome values_at(const std::vector<io::TomlSetting>& settings, Progress& progress) const;
};

PointOutcome Evaluator::Parts::values_at(const std::vector<io::TomlSetting>& settings, Progress& progress) const {
  PointOutcome out;
  if (!at_points.empty()) out = lobes_at(at_points, io::TomlSource(base, {}, settings), *structures, progress);
  if (at_points.size() == wanted.size()) return out;
  const VerbJob job = {.verb = verb,
                       .inputs = {base},
                       .options = options,
                       .root = study.parent_path(),
                       .wants_json = true,
                       .settings = settings};
  const Outcome outcome = verb.run(job, progress);
  const io::Json document = io::parsed(outcome.json);
  std::vector<double> values;
  std::size_t next = 0;
  for (const Wanted& one : wanted) {
    values.push_back(one.kind == Wanted::Kind::path ? number_at(document, one.path) : out.values[next++]);
  }
  out.values = std::move(values);
  if (!outcome.shortfall.empty()) {
    out.state = PointState::short_of;
    out.reason = printable(outcome.shortfall);
  }
  return out;
}

namespace {

const Verb& verb_of(const Study& study) {
  std::string known;
  for (const Verb& verb : verbs()) {
    if (!verb.varies) continue;
    if (verb.name == study.job) return verb;
    known += (known.empty() ? "" : ", ") + std::string(verb.name);
  }
  throw InvalidInput("job", "\"" + study.job + "\" is no job that can be varied", "These can: " + known);
}

/// @throws InvalidInput naming the option
io::Json options_for(const Verb& verb, const Study& study) {
  const io::Json given = study.options.empty() ? io::Json::object() : io::parsed_or_discarded(study.options);
  io::Json out = checked_options(verb, AskedBy::request, study.base, given);
  for (const VerbOption& option : verb.options) {
    if (!out.contains(option.name) || (option.takes != Takes::new_file && option.takes != Takes::new_folder)) continue;
    throw InvalidInput(fmt::format("options.{}", option.name), "writes a file, which a study does not",
                       "Collect numbers of its document");
  }
  return out;
}

}  // namespace

Evaluator::Evaluator(const Study& study)
    : parts_(std::make_unique<Parts>(Parts{.verb = verb_of(study), .study = study.file, .base = study.base})) {
  parts_->options = options_for(parts_->verb, study);
  for (const std::string& text : study.collect) {
    parts_->wanted.push_back(wanted_of(text, study.job == "lobes"));
    if (parts_->wanted.back().kind != Wanted::Kind::path) parts_->at_points.push_back(parts_->wanted.back());
  }
}

Evaluator::~Evaluator() = default;

PointOutcome Evaluator::at(const std::vector<io::TomlSetting>& settings, Progress& progress) const {
  try {
    const io::SettingsUse use;
    PointOutcome out = parts_->values_at(settings, progress);
    for (const io::TomlSetting& setting : settings) {
      if (use.has(setting.key)) continue;
      throw InvalidInput(parts_->base.string(),
                         fmt::format("{} does not read {} in it", parts_->verb.name, setting.key),
                         "Is it of another file, that this one names?");
    }
    return out;
  } catch (const InvalidInput& error) {
    return {.state = PointState::rejected,
            .values = std::vector<double>(parts_->wanted.size(), nothing),
            .reason = printable(error.what())};
  }
}

}  // namespace robomill::jobs
