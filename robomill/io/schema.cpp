#include "robomill/io/schema.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "robomill/io/columns.hpp"
#include "robomill/io/system/append.hpp"

namespace robomill::io {

bool Rule::keeps(double value) const {
  return (above ? value > lowest : value >= lowest) && (below ? value < highest : value <= highest);
}

std::string Rule::range() const {
  const bool low = std::isfinite(lowest), high = std::isfinite(highest);
  if (low && high && above && below) return fmt::format("between {:.6g} and {:.6g}", lowest, highest);
  const std::string from = low ? fmt::format("{} {:.6g}", above ? ">" : ">=", lowest) : "";
  const std::string to = high ? fmt::format("{} {:.6g}", below ? "<" : "<=", highest) : "";
  return from + (low && high ? " and " : "") + to;
}

std::string Rule::text() const {
  const std::string kept = range();
  return (kept.starts_with("between") ? "must lie " : "must be ") + kept;
}

namespace detail {
namespace {

/// In SI, so that a bound itself is converted as the value is.
void require_kept(const TomlFile& file, const std::string& path, const Rule& rule, double factor, double value) {
  Rule in_si = rule;
  in_si.lowest *= factor;
  in_si.highest *= factor;
  if (!in_si.keeps(value)) throw file.reject(path, rule.text(), rule.hint);
}

/// Of each value of a list, by its place; a single value is a list of one.
template <class M>
void require_all_kept(const TomlFile& file, const std::string& path, const Rule& rule, double factor,
                      const std::vector<M>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string entry = fmt::format("{}[{}]", path, i);
    require_kept(file, file.has(entry) ? entry : path, rule, factor, values[i]);
  }
}

void require_entries(const TomlFile& file, const std::string& path, const Rule& rule, std::size_t entries) {
  if (rule.entries == 0 || rule.entries == entries) return;
  throw file.reject(path, fmt::format("must hold {} entries; it holds {}", rule.entries, entries), rule.hint);
}

}  // namespace

bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                double& out) {
  if (!file.number(path, member, factor, out)) return false;
  require_kept(file, path, key.rule, factor, out);
  return true;
}

bool read_value(TomlFile& file, const std::string& path, const std::string& member, double /*factor*/, const Key& key,
                int& out) {
  if (!file.integer(path, member, out)) return false;
  require_kept(file, path, key.rule, 1.0, out);
  return true;
}

bool read_value(TomlFile& file, const std::string& path, const std::string& /*member*/, double /*factor*/,
                const Key& /*key*/, bool& out) {
  return file.boolean(path, out);
}

bool read_value(TomlFile& file, const std::string& path, const std::string& /*member*/, double /*factor*/,
                const Key& /*key*/, std::string& out) {
  return file.text(path, out);
}

bool read_value(TomlFile& file, const std::string& path, const std::string& /*member*/, double /*factor*/,
                const Key& /*key*/, std::filesystem::path& out) {
  return file.path(path, out);
}

bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<double>& out) {
  if (!file.numbers(path, member, factor, out)) return false;
  require_entries(file, path, key.rule, out.size());
  require_all_kept(file, path, key.rule, factor, out);
  return true;
}

bool read_value(TomlFile& file, const std::string& path, const std::string& member, double /*factor*/, const Key& key,
                std::vector<int>& out) {
  if (!file.integers(path, member, out)) return false;
  require_entries(file, path, key.rule, out.size());
  require_all_kept(file, path, key.rule, 1.0, out);
  return true;
}

bool read_value(TomlFile& file, const std::string& path, const std::string& /*member*/, double /*factor*/,
                const Key& key, std::vector<std::string>& out) {
  if (!file.texts(path, out)) return false;
  require_entries(file, path, key.rule, out.size());
  return true;
}

bool read_value(TomlFile& file, const std::string& path, const std::string& /*member*/, double /*factor*/,
                const Key& /*key*/, std::vector<std::filesystem::path>& out) {
  return file.paths(path, out);
}

Json write_value(double value, const Shown& shown) {
  const double out = value / shown.factor;
  return shown.exact && std::isfinite(out) ? Json(out) : number(out);
}

Json write_value(const std::complex<double>& value, const Shown& /*shown*/) {
  return complex_number(value);
}

Json write_value(const std::filesystem::path& value, const Shown& /*shown*/) {
  return text_or_null(value.string());
}

Json write_value(const Eigen::MatrixXd& values, const Shown& shown) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    Json row = Json::array();
    for (const double value : values.row(i)) row.push_back(write_value(value, shown));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace detail

namespace {

/// A schema of every table that a document holds, by its name.
class Definitions {
 public:
  /// @param whole  keys that are required are required of this document; else only in lists, which one file gives
  explicit Definitions(bool whole) : whole_(whole) {}
  Json properties_of(const TableInfo& table) {
    Json properties = Json::object(), required = Json::array();
    if (table.version > 0) {
      properties["document"] = {{"const", table.document()}, {"description", "what this document is"}};
      required.push_back("document");
    }
    for (const Key& key : table.keys) {
      properties[key.name] = key_schema(key);
      if (key.required && (whole_ || lists_ > 0)) required.push_back(key.name);
    }
    Json out = {{"type", "object"}, {"properties", std::move(properties)}};
    out["additionalProperties"] = false;
    if (!required.empty()) out["required"] = std::move(required);
    return out;
  }
  Json take() { return std::move(tables_); }

 private:
  /// Of one value.
  Json value_schema(const Key& key) {
    Json out = value_schema(key, key.holds);
    if (key.also.empty()) return out;
    Json any = Json::array({std::move(out)});
    for (const Holds other : key.also) any.push_back(value_schema(key, other));
    return {{"anyOf", std::move(any)}};
  }

  Json value_schema(const Key& key, Holds holds) {
    Json out = Json::object();
    switch (holds) {
      case Holds::number:
        out["type"] = "number";
        break;
      case Holds::integer:
        out["type"] = "integer";
        break;
      case Holds::boolean:
        out["type"] = "boolean";
        break;
      case Holds::text:
      case Holds::path:
        out["type"] = "string";
        break;
      case Holds::word:
        out["type"] = "string";
        out["enum"] = key.words;
        break;
      case Holds::complex:
        return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}};
      case Holds::table:
        if (key.table == nullptr) return {{"type", "object"}};
        return reference(*key.table);
      case Holds::list:
        return list_reference();
    }
    if (std::isfinite(key.rule.lowest)) out[key.rule.above ? "exclusiveMinimum" : "minimum"] = key.rule.lowest;
    if (std::isfinite(key.rule.highest)) out[key.rule.below ? "exclusiveMaximum" : "maximum"] = key.rule.highest;
    return out;
  }

  Json reference(const TableInfo& table) {
    std::string& name = names_[&table];
    if (name.empty()) {
      name = table.name;
      for (int same = 2; tables_.contains(name); ++same) name = fmt::format("{}_{}", table.name, same);
      tables_[name] = nullptr;  // its place, before those that it holds
      Json schema = {{"description", table.meaning}};
      schema.update(properties_of(table));
      tables_[name] = std::move(schema);
    }
    return {{"$ref", "#/$defs/" + name}};
  }

  /// A list whose entries are plain or such lists.
  Json list_reference() {
    const char* const name = "nested_list";
    Json self = {{"$ref", std::string("#/$defs/") + name}};
    Json any = Json::array();
    for (const char* plain : {"number", "string", "boolean"}) any.push_back({{"type", plain}});
    any.push_back(self);
    tables_[name] = {{"type", "array"}, {"items", {{"anyOf", std::move(any)}}}};
    return self;
  }

  /// The same, or null. Numbers that are not finite are null wherever they stand.
  static Json or_null(Json schema) {
    if (schema.contains("enum")) schema["enum"].push_back(nullptr);
    if (schema.contains("type") && schema["type"].is_string()) {
      schema["type"] = Json::array({schema["type"], "null"});
      return schema;
    }
    return {{"anyOf", Json::array({std::move(schema), {{"type", "null"}}})}};
  }

  Json key_schema(const Key& key) {
    lists_ += key.lists;
    Json out = value_schema(key);
    lists_ -= key.lists;
    if (key.nullable) out = or_null(std::move(out));
    for (int i = 0; i < key.lists; ++i) {
      Json list = {{"type", "array"}, {"items", out}};
      if (i == 0 && key.rule.entries > 0) list["minItems"] = list["maxItems"] = key.rule.entries;
      out = key.or_one ? Json{{"anyOf", Json::array({std::move(out), std::move(list)})}} : std::move(list);
    }
    if (key.named) out = {{"type", "object"}, {"additionalProperties", std::move(out)}};
    if (key.null_list) out = or_null(std::move(out));
    const std::string unit = key.unit();
    out["description"] = unit.empty() ? key.meaning : fmt::format("{} [{}]", key.meaning, unit);
    if (!key.default_value.is_null()) out["default"] = key.default_value;
    return out;
  }

  bool whole_;
  int lists_ = 0;  ///< around the table that is described
  std::map<const TableInfo*, std::string> names_;
  Json tables_ = Json::object();
};

/// A text in a cell of a table.
std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

/// "mm, > 0, list".
std::string values_of(const Key& key) {
  std::string out = key.holds == Holds::boolean ? "" : key.unit();
  const auto add = [&out](std::string_view more, std::string_view between = ", ") {
    if (!out.empty() && !more.empty()) out += between;
    out += more;
  };
  for (const std::string& word : key.words) add(fmt::format("`{}`", word), " ");
  if (key.holds == Holds::path) add("path");
  if (key.holds == Holds::boolean) add("true, false");
  add(key.rule.range());
  if (key.lists > 0 && key.holds != Holds::table) {
    add(key.rule.entries > 0 ? fmt::format("list of {}", key.rule.entries) : key.lists > 1 ? "list of lists" : "list");
  }
  return out;
}

/// What is said of a key beside its unit: of a document that people write its default, of another whether it is there.
std::string presence(const Key& key, Use use) {
  if (use == Use::written) return key.required ? key.nullable || key.null_list ? "null: none" : "" : "on occasion";
  if (key.required) return "required";
  return key.default_value.is_null() ? "" : key.default_value.dump();
}

/// @param seen  where each table stands already, which is not listed again
void add_markdown(const TableInfo& table, const std::string& before, std::map<const TableInfo*, std::string>& seen,
                  std::string& out) {
  for (const Key& key : table.keys) {
    const std::string name = before + key.name +
                             (key.named                                    ? ".*"
                              : key.lists > 0 && key.holds == Holds::table ? "[]"
                                                                           : "");
    std::string meaning = key.meaning;
    const bool described = key.holds == Holds::table && key.table != nullptr;
    const bool first = described && seen.emplace(key.table, name).second;
    if (described && !first) meaning += fmt::format("; keys as of `{}`", seen.at(key.table));
    out += fmt::format("| `{}` | {} | {} | {} |\n", name, values_of(key), presence(key, table.use),
                       in_cell(std::move(meaning)));
    if (first) add_markdown(*key.table, name + ".", seen, out);
  }
}

}  // namespace

void append_cell(std::string& line, const Json& cell) {
  if (cell.is_null()) return;
  if (cell.is_string()) {
    append(line, "\"{}\"", cell.get_ref<const std::string&>());
  } else if (cell.is_number_float()) {
    append(line, "{:.9g}", cell.get<double>());
  } else {
    line += cell.dump();
  }
}

const Schema<Assumption>& assumption_table() {
  static const Schema<Assumption> table(
      "assumption", "what was taken because the input did not give it",
      {key("what", &Assumption::what, "of what"), key("taken", &Assumption::taken, "in words"),
       key("key", &Assumption::key, "that sets it; none: nothing can be given").nullable(),
       key("file", &Assumption::file, "of that key; none: an option of the command line").nullable()},
      Use::written);
  return table;
}

Json json_schema(const TableInfo& document) {
  Json out = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"$id", "urn:robomill:" + document.name + (document.version > 0 ? fmt::format(":{}", document.version) : "")},
      {"title", document.name},
      {"description", document.meaning}};
  Definitions definitions(!document.several_files);
  out.update(definitions.properties_of(document));
  if (Json tables = definitions.take(); !tables.empty()) out["$defs"] = std::move(tables);
  return out;
}

std::string markdown_table(const TableInfo& table) {
  std::string out = fmt::format("| key | unit, values | {} | meaning |\n|---|---|---|---|\n",
                                table.use == Use::written ? "" : "default");
  if (table.version > 0) out += fmt::format("| `document` | `{}` | | |\n", table.document());
  std::map<const TableInfo*, std::string> seen;
  add_markdown(table, "", seen, out);
  return out;
}

}  // namespace robomill::io
