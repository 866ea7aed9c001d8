#include "robomill/io/schema.hpp"

#include <fmt/format.h>

#include <cmath>

namespace robomill::io {

bool Rule::keeps(double value) const {
  return (above ? value > lowest : value >= lowest) && (below ? value < highest : value <= highest);
}

std::string Rule::text() const {
  const bool low = std::isfinite(lowest), high = std::isfinite(highest);
  if (low && high && above && below) return fmt::format("must lie between {:.6g} and {:.6g}", lowest, highest);
  std::string out = "must be";
  if (low) out += fmt::format(" {} {:.6g}", above ? ">" : ">=", lowest);
  if (high) out += fmt::format("{} {} {:.6g}", low ? " and" : "", below ? "<" : "<=", highest);
  return out;
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
  throw file.reject(path, fmt::format("must hold {} entries; it holds {}", rule.entries, entries));
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

Json write_value(double value, double factor) {
  return number(value / factor);
}

Json write_value(const std::complex<double>& value, double /*factor*/) {
  return complex_number(value);
}

Json write_value(const std::filesystem::path& value, double /*factor*/) {
  return text_or_null(value.string());
}

Json write_value(const Eigen::Ref<const Eigen::VectorXd>& values, double factor) {
  return numbers_in(factor, values);
}

Json write_value(const Eigen::MatrixXd& values, double factor) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const Eigen::VectorXd row = values.row(i).transpose();
    rows.push_back(factor == 1.0 ? numbers(row) : numbers_in(factor, row));
  }
  return rows;
}

}  // namespace detail

namespace {

Json schema_of(const TableInfo& table);

/// Of one value.
Json value_schema(const Key& key) {
  Json out = Json::object();
  switch (key.holds) {
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
      return schema_of(*key.table);
  }
  if (std::isfinite(key.rule.lowest)) out[key.rule.above ? "exclusiveMinimum" : "minimum"] = key.rule.lowest;
  if (std::isfinite(key.rule.highest)) out[key.rule.below ? "exclusiveMaximum" : "maximum"] = key.rule.highest;
  return out;
}

/// The same, or null. Numbers that are not finite are null wherever they stand.
Json or_null(Json schema) {
  if (schema.contains("enum")) schema["enum"].push_back(nullptr);
  if (schema.contains("type") && schema["type"].is_string()) {
    schema["type"] = Json::array({schema["type"], "null"});
    return schema;
  }
  return {{"anyOf", Json::array({std::move(schema), {{"type", "null"}}})}};
}

Json key_schema(const Key& key) {
  Json out = value_schema(key);
  if (key.nullable) out = or_null(std::move(out));
  for (int i = 0; i < key.lists; ++i) {
    Json list = {{"type", "array"}, {"items", out}};
    if (i == 0 && key.rule.entries > 0) list["minItems"] = list["maxItems"] = key.rule.entries;
    out = key.or_one ? Json{{"anyOf", Json::array({std::move(out), std::move(list)})}} : std::move(list);
  }
  const std::string unit = key.unit();
  out["description"] = unit.empty() ? key.meaning : fmt::format("{} [{}]", key.meaning, unit);
  if (!key.default_value.is_null()) out["default"] = key.default_value;
  return out;
}

Json schema_of(const TableInfo& table) {
  Json properties = Json::object(), required = Json::array();
  for (const Key& key : table.keys) {
    properties[key.name] = key_schema(key);
    if (key.required) required.push_back(key.name);
  }
  Json out = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) out["required"] = std::move(required);
  return out;
}

void add_rows(const TableInfo& table, const std::string& before, std::string& out) {
  for (const Key& key : table.keys) {
    const std::string name = before + key.name + (key.lists > 0 && key.holds == Holds::table ? "[]" : "");
    if (key.holds == Holds::table) {
      out += fmt::format("| `{}` | | | {} |\n", name, key.meaning);
      add_rows(*key.table, name + ".", out);
      continue;
    }
    std::string values = key.unit();
    for (const std::string& word : key.words) values += fmt::format("{}`{}`", values.empty() ? "" : " ", word);
    const std::string without = key.required ? "required" : key.default_value.is_null() ? "" : key.default_value.dump();
    out += fmt::format("| `{}` | {} | {} | {} |\n", name, values, without, key.meaning);
  }
}

}  // namespace

Json json_schema(const TableInfo& document, int version) {
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"$id", fmt::format("https://robomill.org/schema/{}-{}.json", document.name, version)},
              {"title", document.name},
              {"description", document.meaning}};
  Json table = schema_of(document);
  Json properties = {{"document", {{"const", fmt::format("{}/{}", document.name, version)}}}};
  properties.update(table["properties"]);
  table["properties"] = std::move(properties);
  if (!table.contains("required")) table["required"] = Json::array();
  table["required"].insert(table["required"].begin(), "document");
  out.update(table);
  return out;
}

std::string markdown_rows(const TableInfo& table) {
  std::string out;
  add_rows(table, "", out);
  return out;
}

}  // namespace robomill::io
