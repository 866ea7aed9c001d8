#include "robomill/io/toml_file.hpp"

#include <fmt/format.h>

// toml++ asserts, or even lets the compiler assume, what "[*]" breaks; without either it reports an error as it should.
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

constexpr int most_key_parts = 32;

/// One reading call: what stands in the file and what it became.
struct Row {
  std::string key, member;
  double factor = 1.0;
  bool present = false;
  std::vector<double> si;  ///< values as the caller got them; without the key, what the caller had before
};

/// "hits[0].file" as messages show it, counted from 1.
std::string shown(std::string_view key) {
  std::string text;
  while (!key.empty()) {
    const std::size_t open = key.find('[');
    text += key.substr(0, open);
    if (open == std::string_view::npos) break;
    key.remove_prefix(open + 1);
    std::size_t index = 0;
    const std::from_chars_result read = std::from_chars(key.data(), key.data() + key.size(), index);
    text += fmt::format("[{}", index + 1);
    key.remove_prefix(static_cast<std::size_t>(read.ptr - key.data()));
  }
  return text;
}

/// Takes "[3]" off the front of a path.
std::optional<std::size_t> take_index(std::string_view& path) {
  if (path.empty() || path.front() != '[') return std::nullopt;
  std::size_t index = 0;
  const std::from_chars_result read = std::from_chars(path.data() + 1, path.data() + path.size(), index);
  const std::size_t used = static_cast<std::size_t>(read.ptr - path.data());
  if (read.ec != std::errc() || used >= path.size() || path[used] != ']') return std::nullopt;
  path.remove_prefix(used + 1);
  return index;
}

const toml::node* find(const toml::table& root, std::string_view path) {
  const toml::node* node = &root;
  while (node != nullptr && !path.empty()) {
    if (path.front() == '[') {
      const std::optional<std::size_t> index = take_index(path);
      const toml::array* array = node->as_array();
      node = index && array != nullptr ? array->get(*index) : nullptr;
    } else {
      if (path.front() == '.') path.remove_prefix(1);
      const std::string_view name = path.substr(0, path.find_first_of(".["));
      const toml::table* table = node->as_table();
      node = table != nullptr ? table->get(name) : nullptr;
      path.remove_prefix(name.size());
    }
  }
  return node;
}

/// The key, or the innermost table around it that the file has; none where that is the file itself.
const toml::node* nearest(const toml::table& root, std::string_view key) {
  for (;;) {
    if (const toml::node* node = find(root, key)) return node;
    const std::size_t end = key.find_last_of(".[");
    if (end == std::string_view::npos) return nullptr;
    key = key.substr(0, end);
  }
}

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

/// A value as the file has it; empty for tables and arrays.
std::string value_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  return {};
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

bool is_list_of_tables(const toml::array& array) {
  return !array.empty() && std::all_of(array.begin(), array.end(), [](const toml::node& n) { return n.is_table(); });
}

/// One past the end of the text or comment that begins at `at`; `at` where neither does.
std::size_t skip_text(std::string_view content, std::size_t at) {
  const auto after = [&](std::string_view closing, std::size_t from, bool escapes) {
    for (std::size_t i = from; i < content.size(); ++i) {
      if (content.substr(i).starts_with(closing)) return i + closing.size();
      if (closing.size() == 1 && content[i] == '\n') return i;  // unclosed
      if (escapes && content[i] == '\\') ++i;
    }
    return content.size();
  };
  const char quote = content[at];
  if (quote == '#') return std::min(content.find('\n', at), content.size());
  if (quote != '"' && quote != '\'') return at;
  const std::string three(3, quote);
  if (!content.substr(at).starts_with(three)) return after(three.substr(2), at + 1, quote == '"');
  std::size_t end = after(three, at + 3, quote == '"');
  // Up to two quotes of the text itself may stand before the three that close it.
  for (int own = 0; own < 2 && end < content.size() && content[end] == quote; ++own) ++end;
  return end;
}

/// toml++ bounds how deeply values nest, but not the parts of a dotted key; what takes a table apart calls itself once
/// a level.
void require_short_keys(std::string_view content, const std::string& file) {
  int parts = 1;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const std::size_t end = skip_text(content, i);
    if (end > i) {
      i = end - 1;
      continue;
    }
    const char letter = content[i];
    if (letter == '.') {
      ++parts;
    } else if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-' && letter != '_' &&
               letter != ' ' && letter != '\t') {
      parts = 1;
    }
    if (parts <= most_key_parts) continue;
    const auto line = std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(i), '\n') + 1;
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file, line),
                                           .rule = fmt::format("has a key of more than {} parts", most_key_parts)});
  }
}

}  // namespace

struct TomlFile::State {
  std::filesystem::path path;
  toml::table root;
  std::set<std::string, std::less<>> known;  ///< every key that was asked for
  std::vector<Row> rows;

  const toml::node* ask(std::string_view key) {
    known.emplace(key);
    return find(root, key);
  }
  [[nodiscard]] std::string where(const toml::node* node) const {
    const std::string file = path.string();
    return node != nullptr ? fmt::format("{}:{}", file, node->source().begin.line) : file;
  }
  [[nodiscard]] std::string suggestion(std::string_view key) const;
  void check_known(const toml::node& node, const std::string& path_here) const;
  [[nodiscard]] const Row* row_of(const InvalidInput::Parts& parts) const;
};

TomlFile::TomlFile(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
  state_->path = path;
  const std::string content = read_file(path, std::uintmax_t{64} << 20);
  require_short_keys(content, path.string());
  try {
    state_->root = toml::parse(content);
  } catch (const toml::parse_error& error) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", path.string(), error.source().begin.line),
                                           .rule = "is no TOML: " + std::string(error.description())});
  }
}

TomlFile::~TomlFile() = default;

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
      if (!number) throw reject(key, "must be a list of finite numbers");
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
  for (const std::string& name : names) out.push_back(state_->path.parent_path() / name);
  return true;
}

bool TomlFile::path(std::string_view key, std::filesystem::path& out) {
  std::string name;
  if (!text(key, name)) return false;
  if (name.empty()) throw reject(key, "must name a file");
  out = state_->path.parent_path() / name;
  return true;
}

void TomlFile::skip(std::string_view key) {
  state_->known.emplace(key);
}

bool TomlFile::has(std::string_view key) const {
  return find(state_->root, key) != nullptr;
}

bool TomlFile::is_number(std::string_view key) const {
  const toml::node* node = find(state_->root, key);
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
  throw InvalidInput(InvalidInput::Parts{.where = state_->where(nearest(state_->root, key)),
                                         .field = shown(key),
                                         .rule = "is missing",
                                         .hint = std::string(hint)});
}

InvalidInput TomlFile::reject(std::string_view key, std::string rule, std::string hint) const {
  const toml::node* node = find(state_->root, key);
  InvalidInput::Parts parts{.where = state_->where(nearest(state_->root, key)),
                            .field = shown(key),
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
  const Row* row = parts.where.empty() && !parts.field.empty() ? state_->row_of(parts) : nullptr;
  if (row == nullptr) return error;
  const bool entry = parts.field.back() == ']' && row->member.back() != ']';
  const std::string index = entry ? parts.field.substr(parts.field.rfind('[')) : "";
  parts.where = state_->where(nearest(state_->root, row->key));
  parts.field = shown(row->key) + index;
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
  }
  return InvalidInput(std::move(parts));
}

std::string TomlFile::State::suggestion(std::string_view key) const {
  const std::string_view name = key.substr(key.rfind('.') + 1);
  for (const std::string& other : known) {
    const std::size_t dot = other.rfind('.');
    if (dot != std::string::npos && std::string_view(other).substr(dot + 1) == name) {
      return fmt::format("It belongs in [{}]", shown(std::string_view(other).substr(0, dot)));
    }
  }
  const std::string near = nearest_word(key, known);
  return near.empty() ? near : fmt::format("Did you mean {}?", shown(near));
}

void TomlFile::State::check_known(const toml::node& node, const std::string& key) const {
  const auto asked_below = [&](const char* joint) {
    const auto first = known.lower_bound(key + joint);
    return first != known.end() && first->starts_with(key + joint);
  };
  const toml::table* table = node.as_table();
  const toml::array* list = node.is_array() && is_list_of_tables(*node.as_array()) ? node.as_array() : nullptr;
  // What was asked for as a whole, and not entry by entry, is its asker's.
  if (known.contains(key) && !(table != nullptr && asked_below(".")) && !(list != nullptr && asked_below("["))) return;
  if (table != nullptr && (key.empty() || !table->empty() || asked_below("."))) {
    for (const auto& [name, value] : *table) {
      check_known(value, key.empty() ? std::string(name.str()) : key + "." + std::string(name.str()));
    }
  } else if (list != nullptr) {
    for (std::size_t i = 0; i < list->size(); ++i) check_known((*list)[i], fmt::format("{}[{}]", key, i));
  } else {
    throw InvalidInput(InvalidInput::Parts{
        .where = where(&node), .field = shown(key), .rule = "is not known here", .hint = suggestion(key)});
  }
}

void TomlFile::done() const {
  state_->check_known(state_->root, "");
}

}  // namespace robomill::io
