#include "robomill/io/toml/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "robomill/io/key_unit.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/assembly.hpp"
#include "robomill/io/toml/lines.hpp"
#include "robomill/io/toml/settings_use.hpp"
#include "robomill/io/toml/synonyms.hpp"
#include "robomill/io/toml/tables.hpp"
#include "robomill/io/toml/tree.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

/// One reading call: what stands in the file and what it became.
struct Row {
  std::string key, member;
  double factor = 1.0;
  bool present = false;
  std::vector<double> si;  ///< values as the caller got them; without the key, what the caller had before
};

std::optional<double> finite_number(const toml::node& node) {
  std::optional<double> number;
  if (const toml::value<std::int64_t>* whole = node.as_integer()) number = static_cast<double>(whole->get());
  if (const toml::value<double>* real = node.as_floating_point()) number = real->get();
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<int> whole_number(const toml::node& node) {
  const std::optional<double> number = finite_number(node);
  if (!number || *number != std::floor(*number) || std::abs(*number) > std::numeric_limits<int>::max()) {
    return std::nullopt;
  }
  return static_cast<int>(*number);
}

/// "pitch_rad[2]" is an entry of "pitch_rad": how much of field names the row's member, 0 if none of it does.
std::size_t match(std::string_view field, const std::string& member) {
  if (member.empty()) return 0;
  if (member.back() != ']') field = field.substr(0, field.back() == ']' ? field.rfind('[') : field.size());
  const bool whole = field == member;
  const bool tail =
      field.size() > member.size() && field.ends_with(member) && field[field.size() - member.size() - 1] == '.';
  return whole || tail ? member.size() : 0;
}

}  // namespace

struct TomlFile::State {
  std::filesystem::path path;
  std::vector<TomlText> texts;
  std::vector<std::string> set_keys;  ///< by the source
  toml::table root;
  AskedKeys asked;
  std::vector<Row> rows;

  const toml::node* ask(std::string_view key) {
    asked.add(key);
    return find_node(root, key);
  }
  /// The file that a node stands in: the document, or one that it includes.
  [[nodiscard]] std::filesystem::path file_of(const toml::node* node) const {
    const bool named = node != nullptr && node->source().path;
    return named ? std::filesystem::path(*node->source().path) : path;
  }
  [[nodiscard]] std::string where(const toml::node* node) const {
    const std::string file = file_of(node).string();
    const bool in_text = node != nullptr && node->source().begin.line > 0;  // and not set
    return in_text ? fmt::format("{}:{}", file, node->source().begin.line) : file;
  }
  void set(const TomlSetting& setting);
  [[nodiscard]] std::string suggestion(std::string_view key) const;
  [[nodiscard]] InvalidInput unknown(const std::string& key) const;
  [[nodiscard]] std::string written_for(std::string_view key) const;
  void point_at_comment(std::string_view key, InvalidInput::Parts& parts) const;
  void check_known(const toml::node& node, const std::string& path_here) const;
  void compare(const toml::node& node, const std::string& key, std::vector<std::string>& out) const;
  [[nodiscard]] const Row* row_of(const InvalidInput::Parts& parts) const;
};

void TomlFile::State::set(const TomlSetting& setting) {
  const auto rejected = [&](std::string rule) {
    return InvalidInput(InvalidInput::Parts{.where = path.string(),
                                            .field = shown_key(setting.key),
                                            .value = setting.value.substr(0, 60),
                                            .rule = std::move(rule)});
  };
  const std::string line = "value = " + setting.value;
  toml::table one;
  try {
    require_short_keys(setting.key, path.string());
    require_short_keys(line, path.string());
    one = toml::parse(line);
  } catch (const toml::parse_error&) {
    throw rejected("is no value of TOML");
  }
  if (one.size() != 1) throw rejected("is no value of TOML");
  if (!put(root, setting.key, *one.get("value"))) throw rejected("is no key of this document that can be set");
  set_keys.push_back(setting.key);
}

TomlFile::TomlFile(const TomlSource& source) : state_(std::make_unique<State>()) {
  state_->path = source.path;
  TomlAssembly assembly = assemble(source);
  state_->texts = std::move(assembly.texts);
  state_->root = std::move(assembly.root);
  for (const TomlSetting& setting : source.settings) state_->set(setting);
}

TomlFile::~TomlFile() {
  SettingsUse* const use = SettingsUse::current();
  if (use == nullptr) return;
  for (const std::string& key : state_->set_keys) {
    if (state_->asked.covers(key)) use->add(key);
  }
}

bool TomlFile::number(std::string_view key, std::string_view member, double factor, double& out) {
  const toml::node* node = state_->ask(key);
  if (node != nullptr) {
    const std::optional<double> number = finite_number(*node);
    if (!number) throw reject(key, "must be a finite number");
    out = *number * factor;
  }
  state_->rows.push_back({std::string(key), std::string(member), factor, node != nullptr, {out}});
  return node != nullptr;
}

bool TomlFile::numbers(std::string_view key, std::string_view member, double factor, std::vector<double>& out) {
  const toml::node* node = state_->ask(key);
  if (node != nullptr) {
    std::vector<double> values;
    const auto take = [&](const toml::node& entry) {
      const std::optional<double> number = finite_number(entry);
      if (!number) {
        throw reject(
            key, node->is_array() ? "must be a list of finite numbers" : "must be a finite number, or a list of them");
      }
      values.push_back(*number * factor);
    };
    if (const toml::array* array = node->as_array()) {
      for (const toml::node& entry : *array) take(entry);
    } else {
      take(*node);
    }
    out = std::move(values);
  }
  state_->rows.push_back({std::string(key), std::string(member), factor, node != nullptr, out});
  return node != nullptr;
}

bool TomlFile::integer(std::string_view key, std::string_view member, int& out) {
  const toml::node* node = state_->ask(key);
  if (node != nullptr) {
    const std::optional<int> number = whole_number(*node);
    if (!number) throw reject(key, "must be a whole number");
    out = *number;
  }
  state_->rows.push_back({std::string(key), std::string(member), 1.0, node != nullptr, {static_cast<double>(out)}});
  return node != nullptr;
}

bool TomlFile::integers(std::string_view key, std::string_view member, std::vector<int>& out) {
  const toml::node* node = state_->ask(key);
  if (node != nullptr) {
    std::vector<int> values;
    const toml::array* array = node->as_array();
    if (array == nullptr) throw reject(key, "must be a list of whole numbers");
    for (const toml::node& entry : *array) {
      const std::optional<int> number = whole_number(entry);
      if (!number) throw reject(key, "must be a list of whole numbers");
      values.push_back(*number);
    }
    out = std::move(values);
  }
  std::vector<double> si(out.begin(), out.end());
  state_->rows.push_back({std::string(key), std::string(member), 1.0, node != nullptr, std::move(si)});
  return node != nullptr;
}

bool TomlFile::boolean(std::string_view key, bool& out) {
  const toml::node* node = state_->ask(key);
  if (node == nullptr) return false;
  const auto* flag = node->as_boolean();
  if (flag == nullptr) throw reject(key, "must be true or false");
  out = flag->get();
  return true;
}

bool TomlFile::text(std::string_view key, std::string& out) {
  const toml::node* node = state_->ask(key);
  if (node == nullptr) return false;
  const auto* value = node->as_string();
  if (value == nullptr) throw reject(key, "must be text in quotes");
  out = value->get();
  return true;
}

bool TomlFile::texts(std::string_view key, std::vector<std::string>& out) {
  const toml::node* node = state_->ask(key);
  if (node == nullptr) return false;
  std::vector<std::string> values;
  const auto take = [&](const toml::node& entry) {
    const auto* value = entry.as_string();
    if (value == nullptr) throw reject(key, "must be a list of texts in quotes");
    values.push_back(value->get());
  };
  if (const toml::array* array = node->as_array()) {
    for (const toml::node& entry : *array) take(entry);
  } else {
    take(*node);
  }
  out = std::move(values);
  return true;
}

bool TomlFile::paths(std::string_view key, std::vector<std::filesystem::path>& out) {
  std::vector<std::string> names;
  if (!texts(key, names)) return false;
  out.clear();
  const std::filesystem::path folder = file_of(key).parent_path();
  for (const std::string& name : names) out.push_back(folder / name);
  return true;
}

bool TomlFile::literals(std::string_view key, std::vector<std::string>& out) {
  const toml::node* node = state_->ask(key);
  if (node == nullptr) return false;
  std::vector<std::string> values;
  const auto take = [&](const toml::node& entry, std::string place) {
    std::optional<std::string> text = literal_of(entry, place);
    if (!text) throw reject(place, "must be a finite number, a text, true or false, or a list of them");
    values.push_back(*std::move(text));
  };
  if (const toml::array* array = node->as_array()) {
    for (std::size_t i = 0; i < array->size(); ++i) take((*array)[i], fmt::format("{}[{}]", key, i));
  } else {
    take(*node, std::string(key));
  }
  out = std::move(values);
  return true;
}

bool TomlFile::path(std::string_view key, std::filesystem::path& out) {
  std::string name;
  if (!text(key, name)) return false;
  if (name.empty()) throw reject(key, "must name a file");
  out = file_of(key).parent_path() / name;
  return true;
}

std::filesystem::path TomlFile::file_of(std::string_view key) const {
  return state_->file_of(nearest_node(state_->root, key));
}

std::filesystem::path TomlFile::file_of_part(std::string_view key, std::string_view table) const {
  const toml::node* named = find_node(state_->root, key);
  if (named == nullptr || !named->is_string()) return file_of(table);
  return file_of(key).parent_path() / named->as_string()->get();
}

const std::vector<TomlText>& TomlFile::texts() const {
  return state_->texts;
}

bool TomlFile::took(std::string_view key) const {
  const auto is_set = [&](const std::string& set) { return set.starts_with(key); };
  return std::ranges::none_of(state_->set_keys, is_set) && state_->asked.covers(key);
}

void TomlFile::skip(std::string_view key) {
  state_->asked.add(key);
}

bool TomlFile::has(std::string_view key) const {
  return find_node(state_->root, key) != nullptr;
}

bool TomlFile::is_number(std::string_view key) const {
  const toml::node* node = find_node(state_->root, key);
  return node != nullptr && node->is_number();
}

std::size_t TomlFile::tables(std::string_view key) const {
  const toml::node* node = state_->ask(key);
  if (node == nullptr) return 0;
  const toml::array* array = node->as_array();
  if (array == nullptr || (!array->empty() && !is_list_of_tables(*array))) {
    throw reject(key, "must be a list of tables", fmt::format("Write [[{}]] above each", key));
  }
  return array->size();
}

std::vector<std::string> TomlFile::keys(std::string_view table) const {
  const toml::node* node = table.empty() ? &state_->root : state_->ask(table);
  if (node == nullptr) return {};
  if (!node->is_table()) throw reject(table, "must be a table");
  std::vector<std::pair<toml::source_position, std::string>> found;
  for (const auto& [name, value] : *node->as_table()) found.emplace_back(name.source().begin, name.str());
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  names.reserve(found.size());
  for (auto& [position, name] : found) names.push_back(std::move(name));
  return names;
}

void TomlFile::require(std::string_view key, std::string_view hint) const {
  if (has(key)) return;
  state_->asked.add(key);
  if (const std::string other = state_->written_for(key); !other.empty()) throw state_->unknown(other);
  InvalidInput::Parts parts{.where = state_->where(nearest_node(state_->root, key)),
                            .field = shown_key(key),
                            .rule = "is missing",
                            .hint = std::string(hint)};
  state_->point_at_comment(key, parts);
  throw InvalidInput(std::move(parts));
}

InvalidInput TomlFile::reject(std::string_view key, std::string rule, std::string hint) const {
  const toml::node* node = find_node(state_->root, key);
  InvalidInput::Parts parts{.where = state_->where(nearest_node(state_->root, key)),
                            .field = shown_key(key),
                            .rule = std::move(rule),
                            .hint = std::move(hint)};
  if (node != nullptr) {
    parts.number = finite_number(*node);
    parts.value = value_text(*node);
    if (parts.number) parts.unit = unit_of_key(key);
  }
  return InvalidInput(std::move(parts));
}

const Row* TomlFile::State::row_of(const InvalidInput::Parts& parts) const {
  const Row* best = nullptr;
  std::size_t best_score = 0;
  for (const Row& row : rows) {
    const std::size_t length = match(parts.field, row.member);
    if (length == 0) continue;
    // The longest name wins; then the row whose value is the one complained of; then one that the file has.
    const bool same = parts.number && std::find(row.si.begin(), row.si.end(), *parts.number) != row.si.end();
    const std::size_t score = length * 4 + (same ? 2 : 0) + (row.present ? 1 : 0);
    if (score > best_score) {
      best = &row;
      best_score = score;
    }
  }
  return best;
}

InvalidInput TomlFile::located(const InvalidInput& error) const {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty() || parts.field.empty()) return error;
  const Row* row = state_->row_of(parts);
  if (row == nullptr) {  // of a table as a whole
    const toml::node* table = find_node(state_->root, parts.field);
    if (table == nullptr) return error;
    parts.where = state_->where(table);
    parts.field = shown_key(parts.field);
    return InvalidInput(std::move(parts));
  }
  if (!row->present) {
    if (const std::string other = state_->written_for(row->key); !other.empty()) return state_->unknown(other);
  }
  const bool entry = parts.field.back() == ']' && row->member.back() != ']';
  const std::string index = entry ? parts.field.substr(parts.field.rfind('[')) : "";
  parts.where = state_->where(nearest_node(state_->root, row->key));
  parts.field = shown_key(row->key) + index;
  if (parts.number && !parts.unit.ends_with("entries")) {
    parts.number = round_15(*parts.number / row->factor);
    const std::string unit = unit_of_key(row->key);
    if (!unit.empty() || row->factor != 1.0) parts.unit = unit;
  }
  if (!row->present) {
    const bool useless = !parts.number || *parts.number == 0.0 || !std::isfinite(*parts.number);
    if (useless) parts.number.reset();
    if (useless) parts.unit.clear();
    parts.rule = (useless ? "is missing; " : "is the default, not in the file; ") + parts.rule;
    if (useless) state_->point_at_comment(row->key, parts);
  }
  return InvalidInput(std::move(parts));
}

std::string TomlFile::State::suggestion(std::string_view key) const {
  const std::string_view name = key.substr(key.rfind('.') + 1);
  for (const std::string& other : asked.all()) {
    const std::size_t dot = other.rfind('.');
    if (dot != std::string::npos && std::string_view(other).substr(dot + 1) == name) {
      return fmt::format("It belongs in [{}]", shown_key(std::string_view(other).substr(0, dot)));
    }
  }
  if (std::string hint = synonym_hint(key, asked.all()); !hint.empty()) return hint;
  const std::string near = nearest_word(key, asked.all());
  return near.empty() ? near : fmt::format("Did you mean {}?", shown_key(near));
}

InvalidInput TomlFile::State::unknown(const std::string& key) const {
  return InvalidInput(InvalidInput::Parts{.where = where(find_node(root, key)),
                                          .field = shown_key(key),
                                          .rule = "is not known here",
                                          .hint = suggestion(key)});
}

/// The key beside a missing one that somebody wrote in its place: "tool.flutes" for "tool.teeth"; empty where none is.
std::string TomlFile::State::written_for(std::string_view key) const {
  const std::size_t dot = key.rfind('.');
  const toml::node* node = dot != std::string_view::npos ? find_node(root, key.substr(0, dot)) : nullptr;
  if (node == nullptr || !node->is_table()) return {};
  for (const auto& [name, value] : *node->as_table()) {
    std::string other = fmt::format("{}.{}", key.substr(0, dot), name.str());
    if (!asked.contains(other) && is_written_for(name.str(), key.substr(dot + 1))) return other;
  }
  return {};
}

/// Where a missing key stands behind a #, as in a template, the error is of that line.
void TomlFile::State::point_at_comment(std::string_view key, InvalidInput::Parts& parts) const {
  for (const TomlText& text : texts) {
    for (const TomlLine& line : toml_lines(text.content)) {
      if (!line.is_comment || line.key != key) continue;
      parts.where = fmt::format("{}:{}", text.path.string(), line.number);
      if (!parts.hint.empty()) parts.hint += ". ";
      parts.hint += "This line is a comment: write your own value and take the # away";
      return;
    }
  }
}

void TomlFile::State::check_known(const toml::node& node, const std::string& key) const {
  const toml::table* table = node.as_table();
  const toml::array* list = node.is_array() && is_list_of_tables(*node.as_array()) ? node.as_array() : nullptr;
  // What was asked for as a whole, and not entry by entry, is its asker's.
  const bool below_table = table != nullptr && asked.has_below(key, "."),
             below_list = list != nullptr && asked.has_below(key, "[");
  if (asked.contains(key) && !below_table && !below_list) return;
  if (table != nullptr && (key.empty() || !table->empty() || below_table)) {
    for (const auto& [name, value] : *table) {
      if (key.empty() && asked.leaves_table(name.str())) continue;
      check_known(value, key.empty() ? std::string(name.str()) : key + "." + std::string(name.str()));
    }
  } else if (list != nullptr) {
    for (std::size_t i = 0; i < list->size(); ++i) check_known((*list)[i], fmt::format("{}[{}]", key, i));
  } else if (!asked.leaves_key(key)) {
    throw unknown(key);
  }
}

std::vector<std::string> TomlFile::done() const {
  state_->check_known(state_->root, "");
  return unusual();
}

void TomlFile::State::compare(const toml::node& node, const std::string& key, std::vector<std::string>& out) const {
  if (asked.leaves_table(key) || (!asked.covers(key) && asked.leaves_key(key))) return;
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, value] : *table)
      compare(value, key.empty() ? std::string(name.str()) : fmt::format("{}.{}", key, name.str()), out);
    const auto number_of = [&](const char* name) {
      const toml::node* found = table->get(name);
      return found != nullptr ? finite_number(*found).value_or(0.0) : 0.0;
    };
    // Neither alone shows a mass in another unit: their stiffness m (2 pi f)^2 does.
    const double rate = 2.0 * std::numbers::pi * number_of("frequency_hz"), mass_kg = number_of("modal_mass_kg");
    const double n_per_um = 1e-6 * mass_kg * rate * rate;
    if (const std::optional<Unusual> found = unusual_value("modal_stiffness_n_per_um", std::span(&n_per_um, 1))) {
      out.push_back(
          fmt::format("{}{}: {} is a mode of {:.3g} N/um by its mass and frequency, which {}. Is the mass in {}?",
                      warning_label, where(&node), shown_key(key), n_per_um, found->rule, n_per_um > 1.0 ? "g" : "t"));
    }
    return;
  }
  std::vector<double> values;
  const toml::array* array = node.as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    if (const std::optional<double> number = finite_number((*array)[i])) values.push_back(*number);
    if ((*array)[i].is_table() || (*array)[i].is_array()) compare((*array)[i], fmt::format("{}[{}]", key, i), out);
  }
  if (array == nullptr) {
    if (const std::optional<double> number = finite_number(node)) values.push_back(*number);
  }
  if (auto warning = unusual_warning(where(&node), shown_key(key), values)) out.push_back(std::move(*warning));
}

std::vector<std::string> TomlFile::unusual() const {
  std::vector<std::string> out;
  state_->compare(state_->root, "", out);
  return out;
}

}  // namespace robomill::io
