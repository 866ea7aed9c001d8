#include "robomill/jobs/init.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/cutting/files/cut_schema.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/jobs/init/hits_document.hpp"
#include "robomill/jobs/init/questions.hpp"
#include "robomill/jobs/init/template_lines.hpp"

namespace robomill::jobs {
namespace {

/// A text of TOML without its quotes.
std::string unquoted(std::string text) {
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'')) return text.substr(1, text.size() - 2);
  return text;
}

InvalidInput rejected(std::string_view answer, std::string rule, std::string hint = {}) {
  return InvalidInput(fmt::format("\"{}\"", answer), std::move(rule), std::move(hint));
}

/// One of some words, or the begin of one: "cl" of "climb".
template <std::size_t n>
std::string_view one_of_words(std::string_view answer,
                              const std::pair<std::string_view, std::string_view> (&words)[n]) {
  const std::string word = io::lowered(answer);
  std::string_view found;
  bool one = true;
  std::string known;
  for (const auto& [spelling, meaning] : words) {
    if (spelling == word) return meaning;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", spelling);
    if (!spelling.starts_with(word)) continue;
    one = one && (found.empty() || found == meaning);
    found = meaning;
  }
  if (found.empty() || !one) throw rejected(answer, fmt::format("must be one of {}", known));
  return found;
}

/// Names in lines that a terminal holds, indented.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t width = 76;
  std::string text = " ";
  std::size_t begin = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (text.size() - begin + names[i].size() > width) {
      begin = text.size() + 1;
      text += "\n ";
    }
    text += fmt::format(" {}{}", names[i], i + 1 == names.size() ? "" : ",");
  }
  return text;
}

/// Of which a cut can be computed.
std::vector<std::string> usable_materials() {
  std::vector<std::string> names;
  for (const cutting::Material& material : cutting::materials()) {
    if (!material.coefficients.empty()) names.push_back(material.name);
  }
  return names;
}

std::vector<std::string> arm_names() {
  std::vector<std::string> names;
  for (const cell::KnownArm& arm : cell::known_arms()) names.push_back(arm.name);
  return names;
}

constexpr const char* usual_radial_ratio = "0.3";

constexpr std::pair<std::string_view, std::string_view> length_unit_words[] = {
    {"mm", "mm"}, {"inch", "in"}, {"inches", "in"}, {"zoll", "in"}};
constexpr std::pair<std::string_view, std::string_view> direction_words[] = {
    {"climb", "down"}, {"down", "down"}, {"conventional", "up"}, {"up", "up"}, {"slot", "slot"}};
constexpr std::pair<std::string_view, std::string_view> unmeasured_words[] = {
    {"like", "like"}, {"same", "like"}, {"equal", "like"}, {"rigid", "rigid"}};
constexpr std::pair<std::string_view, std::string_view> voltage_words[] = {
    {"v", "V"}, {"volts", "V"}, {"mv", "mV"}, {"millivolts", "mV"}, {"si", "SI"}};

/// "origin_mm" of "origin_mm[2]"; empty of what is no entry of a list.
std::string list_of(const std::string& key) {
  return key.ends_with(']') && key.find('.') != std::string::npos ? key.substr(0, key.rfind('[')) : std::string();
}

}  // namespace

struct Interview::State {
  InitFiles& files;
  std::vector<Question> questions;
  std::size_t at = 0;
  std::string length_unit = "mm";
  std::map<std::string_view, std::string> answers;  ///< by the id of the question: as files have it, without quotes
  /// Entries of lists that the documents do not have: they count together or not at all.
  std::map<std::pair<Template, std::string>, std::map<std::string, std::string>> lists;

  State(Template kind, InitFiles& documents) : files(documents), questions(questions_of(kind)) { skip(); }

  [[nodiscard]] const Question& question() const { return questions[at]; }
  [[nodiscard]] double number(std::string_view id, double otherwise) const {
    const auto found = answers.find(id);
    return found != answers.end() ? io::parse_number(found->second).value_or(otherwise) : otherwise;
  }
  [[nodiscard]] std::string usual(const Question& asked) const;
  [[nodiscard]] std::string prompt() const;
  [[nodiscard]] std::string recommended_feeds() const;
  [[nodiscard]] std::string value_of(const Question& asked, std::string_view answer) const;
  [[nodiscard]] double checked(const Question& asked, std::string_view answer, double value) const;
  [[nodiscard]] bool applies(const Question& asked) const;
  void skip();
  void put(const Question& asked, const std::string& value, bool given);
  void set(Template document, const std::string& key, const std::string& value, bool given = true);
  void require_radial(const std::string& material);
  void take_voltages_back();
  void take(std::string_view text);
  void put_lists();
  void finish();
};

/// The default, as value_of() would take it: what the first document has, else that of the question.
std::string Interview::State::usual(const Question& asked) const {
  if (asked.kind == Answer::length_unit) return length_unit;
  for (const Target& target : asked.targets) {
    const NewFile* file = files.document(target.document);
    if (file == nullptr || target.key == nullptr) continue;
    if (const auto value = io::setting_of(file->text, target.key)) return unquoted(*value);
  }
  return std::string(asked.otherwise);
}

/// What sources recommend for the material and the diameter that were answered.
std::string Interview::State::recommended_feeds() const {
  const auto material = answers.find("material");
  const double diameter_mm = number("diameter", 0.0);
  std::string out;
  if (material == answers.end() || !(diameter_mm > 0.0)) return out;
  for (const cutting::CuttingConditions& entry : cutting::material(material->second).conditions) {
    const std::optional<double> feed_m = entry.feed_at(diameter_mm * units::mm);
    if (!feed_m) continue;
    out += fmt::format("{}{:.3g} mm [{}]", out.empty() ? "; recommended: " : ", ", *feed_m / units::mm, entry.source);
  }
  return out;
}

std::string Interview::State::prompt() const {
  const Question& asked = question();
  std::string text(asked.text);
  if (asked.kind == Answer::material) text += ", one of\n" + listed(usable_materials());
  if (asked.kind == Answer::robot) text += ", one of\n" + listed(arm_names());
  if (asked.id == "feed") text += recommended_feeds();
  std::string shown = usual(asked);
  if (shown.empty()) shown = "not known";
  if (asked.kind == Answer::quantity && shown != "not known") shown += fmt::format(" {}", io::unit_of(asked.quantity));
  if (asked.kind == Answer::quantity && shown == "not known") text += fmt::format(" ({})", io::unit_of(asked.quantity));
  return fmt::format("{} [{}]: ", text, shown);
}

double Interview::State::checked(const Question& asked, std::string_view answer, double value) const {
  const std::string_view unit = io::unit_of(asked.quantity);
  const auto outside = [&](double low, double high) {
    return rejected(
        answer, fmt::format("must lie between {} and {} {}", io::quantity_text(low), io::quantity_text(high), unit));
  };
  if (!(value >= asked.low && value <= asked.high)) throw outside(asked.low, asked.high);
  if (asked.id == "highest speed" && !(value > number("lowest speed", 0.0))) {
    throw rejected(answer, fmt::format("must be above the lowest speed, {} rpm", answers.at("lowest speed")));
  }
  if (asked.id == "radial depth" && value > number("diameter", value)) {
    throw rejected(answer, fmt::format("must be at most the cutter's diameter, {} mm", answers.at("diameter")));
  }
  return value;
}

/// As files have it, without quotes.
std::string Interview::State::value_of(const Question& asked, std::string_view answer) const {
  switch (asked.kind) {
    case Answer::length_unit:
      return std::string(one_of_words(answer, length_unit_words));
    case Answer::direction:
      return std::string(one_of_words(answer, direction_words));
    case Answer::voltage:
      return std::string(one_of_words(answer, voltage_words));
    case Answer::unmeasured:
      return std::string(one_of_words(answer, unmeasured_words));
    case Answer::robot:
      static_cast<void>(cell_document(std::string(answer), files.example));
      return std::string(answer);
    case Answer::material: {
      const cutting::Material& material = cutting::material(answer);
      if (!material.coefficients.empty()) return material.name;
      throw rejected(answer, "is a material of which no force coefficients are known here");
    }
    case Answer::count: {
      const double value = io::parse_quantity(answer, Quantity::number);
      if (value != std::floor(value)) throw rejected(answer, "must be a whole number");
      return io::quantity_text(checked(asked, answer, value));
    }
    case Answer::quantity:
      break;
  }
  const std::string_view plain =
      asked.quantity == Quantity::length ? std::string_view(length_unit) : std::string_view();
  return io::quantity_text(checked(asked, answer, io::parse_quantity(answer, asked.quantity, plain)));
}

bool Interview::State::applies(const Question& asked) const {
  const auto answered = [this](const char* id, const char* value) {
    const auto found = answers.find(id);
    return found != answers.end() && found->second == value;
  };
  const bool here = asked.targets.empty() || std::ranges::any_of(asked.targets, [this](const Target& target) {
                      return files.document(target.document) != nullptr;
                    });
  if (!here) return false;
  if (asked.kind == Answer::unmeasured && (files.unmeasured == 0 || files.example)) return false;
  if ((asked.id == "hammer" || asked.id == "accelerometer") && answered("voltage", "SI")) return false;
  if (asked.id == "accelerometer" &&
      io::setting_of(files.document(Template::hits)->text, "acquisition.response") != "\"acceleration\"") {
    return false;
  }
  return asked.id != "radial depth" || !answered("direction", "slot");
}

void Interview::State::skip() {
  while (at < questions.size() && !applies(question())) ++at;
}

void Interview::State::set(Template document, const std::string& key, const std::string& value, bool given) {
  NewFile* const file = files.document(document);
  if (file == nullptr || key.empty()) return;
  const std::string list = list_of(key);
  if (!list.empty() && !io::setting_of(file->text, list)) {
    lists[{document, list}][key] = value;
    return;
  }
  file->text = io::with_setting(file->text, {.key = key, .value = value});
  if (given) file->text = io::without_sample_mark(std::move(file->text), key);
}

/// Of a material whose source states the tangential coefficient alone the other one has to be said.
void Interview::State::require_radial(const std::string& material) {
  const cutting::Material& known = cutting::material(material);
  const std::optional<std::size_t> set_of = cutting::best_set(known, cutting::CutterKind::flat_end);
  if (!set_of || known.coefficients[*set_of].has_radial()) return;
  for (const Template document : {Template::lobes, Template::forces}) {
    NewFile* const file = files.document(document);
    if (file == nullptr) continue;
    file->text = with_remark(file->text, "coefficients.radial_ratio", usual_radial_ratio,
                             "of radial to tangential: assumed, the source does not state it. 0.16 to 0.6");
  }
}

/// Sensitivities that were guessed from columns in volts. Those of columns in g or kN say what a 1 is, and stay.
void Interview::State::take_voltages_back() {
  NewFile* const file = files.document(Template::hits);
  if (file == nullptr || !io::setting_of(file->text, "acquisition.voltage_unit")) return;
  for (const char* key : {"voltage_unit", "response_voltage_unit", "force_mv_per_n", "response_mv_per_g",
                          "response_mv_per_m_per_s2", "response_mv_per_m_per_s", "response_mv_per_m"}) {
    file->text = commented_out(std::move(file->text), key);
  }
}

/// @param given  by who was asked; else it is the default that the document has
void Interview::State::put(const Question& asked, const std::string& value, bool given) {
  if (asked.kind == Answer::robot) {
    // With its own workpiece and tool, which are asked for next.
    NewFile* const file = files.document(Template::cell);
    if (file != nullptr && given) file->text = cell_document(value, files.example);
    return;
  }
  if (asked.kind == Answer::unmeasured) {
    const bool like = value == "like";
    return set(Template::job, like ? "job.equal_directions" : "job.rigid_directions",
               like ? "true" : fmt::format("[\"{}\"]", files.unmeasured));
  }
  if (asked.kind == Answer::voltage && value == "SI") return take_voltages_back();
  if (asked.kind == Answer::material) require_radial(value);
  const bool bare = asked.kind == Answer::quantity || asked.kind == Answer::count;
  for (const Target& target : asked.targets) {
    if (target.key != nullptr) set(target.document, target.key, bare ? value : io::toml_quoted(value), given);
  }
}

void Interview::State::take(std::string_view text) {
  const Question& asked = question();
  text = io::trimmed(text);
  std::string value = usual(asked);
  if (!text.empty()) {
    value = value_of(asked, text);
  } else if (!value.empty() && asked.kind == Answer::quantity) {
    // A default may not go with the answers before: a radial depth above the diameter.
    value = io::quantity_text(checked(asked, value, io::parse_quantity(value, asked.quantity)));
  }
  if (asked.kind == Answer::length_unit) length_unit = value;
  if (!value.empty()) {
    put(asked, value, !text.empty());
    answers[asked.id] = value;
  }
  ++at;
  skip();
  if (at == questions.size()) finish();
}

/// A list of which every entry was answered.
void Interview::State::put_lists() {
  for (const auto& [place, entries] : lists) {
    const auto& [document, list] = place;
    std::size_t asked_for = 0;
    for (const Question& question : questions) {
      for (const Target& target : question.targets) {
        const std::string key = target.key != nullptr ? target.key : "";
        if (target.document == document && list_of(key) == list) ++asked_for;
      }
    }
    if (entries.size() < asked_for) continue;
    std::string text;
    for (const auto& [key, value] : entries) text += (text.empty() ? "[" : ", ") + value;
    set(document, list, text + "]");
  }
}

/// What several answers make together.
void Interview::State::finish() {
  put_lists();
  const bool range = answers.contains("lowest speed") && answers.contains("highest speed");
  if (range && (answers.contains("torque") || answers.contains("power"))) {
    const double low = number("lowest speed", 0.0), high = number("highest speed", 0.0);
    const auto power_kw = [](double torque_n_m, double rpm) { return torque_n_m * rpm * units::rpm / units::kw; };
    // Of which one is not known, it does not limit.
    const double kw = number("power", power_kw(number("torque", 0.0), high));
    const double torque = number("torque", kw / power_kw(1.0, low));
    const auto point = [&](double rpm) {
      return fmt::format("{{ speed_rpm = {}, torque_n_m = {}, power_kw = {} }}", io::quantity_text(rpm),
                         io::quantity_text(torque), io::quantity_text(kw));
    };
    set(Template::job, "spindle.curve", fmt::format("[{}, {}]", point(low), point(high)));
  }
  if (answers.contains("direction") && answers["direction"] == "slot" && answers.contains("diameter")) {
    for (const Template document : {Template::lobes, Template::forces}) {
      set(document, cutting::radial_depth_of_cut, answers["diameter"]);
    }
  }
}

Interview::Interview(Template kind, InitFiles& files) : state_(std::make_unique<State>(kind, files)) {}
Interview::~Interview() = default;

std::optional<std::string> Interview::question() const {
  if (state_->at == state_->questions.size()) return std::nullopt;
  return state_->prompt();
}

void Interview::answer(std::string_view text) {
  state_->take(text);
}

}  // namespace robomill::jobs
