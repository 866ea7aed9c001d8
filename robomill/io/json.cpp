#include "robomill/io/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "robomill/io/file.hpp"
#include "robomill/io/json_text.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr int deepest_nesting = 256;

bool is_plain(const Json& json) {
  return !json.is_structured();
}

/// Rows of numbers stay on a line each.
bool on_one_line(const Json& json) {
  return json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& entry) {
           return is_plain(entry) ||
                  (entry.is_array() && entry.size() <= 2 && std::all_of(entry.begin(), entry.end(), is_plain));
         });
}

void append_value(std::string& out, const Json& json, std::size_t depth) {
  if (is_plain(json) || json.empty()) {
    out += plain_text(json);
    return;
  }
  const bool is_object = json.is_object();
  const bool one_line = on_one_line(json);
  std::string line_end(2 * depth + 3, ' ');
  line_end.front() = '\n';
  out += is_object ? '{' : '[';
  bool first = true;
  for (const auto& [key, value] : json.items()) {
    if (!first) out += one_line ? ", " : ",";
    first = false;
    if (!one_line) out += line_end;
    if (is_object) out.append(plain_text(Json(key))).append(": ");
    append_value(out, value, depth + 1);
  }
  if (!one_line) out += line_end.substr(0, line_end.size() - 2);
  out += is_object ? '}' : ']';
}

std::size_t line_of(std::string_view content, std::size_t byte) {
  const std::string_view before = content.substr(0, byte);
  return static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
}

/// What copies, compares or writes JSON calls itself once a level.
void require_shallow(std::string_view content, const std::string& name) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const char letter = content[i];
    if (letter == '"') {
      quoted = !quoted;
    } else if (quoted) {
      if (letter == '\\') ++i;
    } else if (letter == '[' || letter == '{') {
      ++depth;
    } else if (letter == ']' || letter == '}') {
      --depth;
    }
    if (depth <= deepest_nesting) continue;
    throw InvalidInput(InvalidInput::Parts{
        .where = fmt::format("{}:{}", name, line_of(content, i)),
        .rule = fmt::format("is no JSON that is read here: it nests its values more than {} deep", deepest_nesting)});
  }
}

}  // namespace

Json number(double value) {
  return std::isfinite(value) ? Json(round_15(value)) : Json();
}

Json positive(double value, double unit) {
  return value > 0.0 ? number(value / unit) : Json(nullptr);
}

Json complex_number(const std::complex<double>& value) {
  return Json::array({number(value.real()), number(value.imag())});
}

Json numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) list.push_back(std::isfinite(values(i)) ? Json(values(i)) : Json());
  return list;
}

Json numbers_in(double unit, const Eigen::Ref<const Eigen::VectorXd>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value / unit));
  return list;
}

Json complex_numbers(const Eigen::Ref<const Eigen::VectorXcd>& values) {
  return {{"re", numbers(values.real())}, {"im", numbers(values.imag())}};
}

Json assumed_json(const std::vector<Assumption>& assumed) {
  Json list = Json::array();
  for (const Assumption& one : assumed) {
    list.push_back(
        {{"what", one.what}, {"taken", one.taken}, {"key", text_or_null(one.key)}, {"file", text_or_null(one.file)}});
  }
  return list;
}

Json text_or_null(std::string_view text) {
  return text.empty() ? Json() : Json(text);
}

std::string plain_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string dump(const Json& json) {
  std::string out;
  append_value(out, json, 0);
  out += '\n';
  return out;
}

void JsonText::begin(std::string_view key) {
  text_ = empty_ ? "{\n  " : ",\n  ";
  empty_ = false;
  text_.append(plain_text(Json(key))).append(": ");
}

void JsonText::add(std::string_view key, const Json& value) {
  begin(key);
  append_value(text_, value, 1);
  take_(text_);
}

void JsonText::begin_list(std::string_view key) {
  begin(key);
  text_ += '[';
  empty_list_ = true;
  take_(text_);
}

void JsonText::add_entry(const Json& entry) {
  text_ = empty_list_ ? "\n    " : ",\n    ";
  empty_list_ = false;
  append_value(text_, entry, 2);
  take_(text_);
}

void JsonText::end_list() {
  take_(empty_list_ ? "]" : "\n  ]");
}

void JsonText::end() {
  take_(empty_ ? "{}\n" : "\n}\n");
}

Json parsed(std::string_view text) {
  return Json::parse(text);
}

Json parsed_or_discarded(std::string_view text) {
  return Json::parse(text, nullptr, false);
}

JsonNode::JsonNode(const Json& json, std::string file, std::vector<std::string>& warnings)
    : JsonNode(json, std::move(file), std::string(), &warnings) {}

JsonNode::JsonNode(const Json& json, std::string file, std::string path)
    : JsonNode(json, std::move(file), std::move(path), nullptr) {}

JsonNode::JsonNode(const Json& json, std::string file, std::string path, std::vector<std::string>* warnings)
    : json_(&json), file_(std::move(file)), path_(std::move(path)), warnings_(warnings) {}

void JsonNode::compare(double largest) const {
  if (warnings_ == nullptr) return;
  if (auto warning = unusual_warning(file_, path_, std::span(&largest, 1))) warnings_->push_back(std::move(*warning));
}

InvalidInput JsonNode::reject(std::string rule, std::string hint) const {
  InvalidInput::Parts parts{.where = file_, .field = path_, .rule = std::move(rule), .hint = std::move(hint)};
  if (json_->is_number()) {
    parts.number = json_->get<double>();
  } else if (is_plain(*json_)) {
    parts.value = plain_text(*json_).substr(0, 60);
  }
  return InvalidInput(std::move(parts));
}

bool JsonNode::has(const char* key) const {
  return json_->is_object() && json_->contains(key);
}

void JsonNode::require_object() const {
  if (!json_->is_object()) throw reject("must be an object {…}");
}

JsonNode JsonNode::at(const std::string& key) const {
  require_object();
  const std::string path = path_.empty() ? key : fmt::format("{}.{}", path_, key);
  const auto member = json_->find(key);
  if (member == json_->end()) {
    throw InvalidInput(InvalidInput::Parts{.where = file_, .field = path, .rule = "is missing"});
  }
  return {*member, file_, path, warnings_};
}

std::size_t JsonNode::size() const {
  if (!json_->is_array()) throw reject("must be a list […]");
  return json_->size();
}

JsonNode JsonNode::at(std::size_t index) const {
  return {json_->at(index), file_, fmt::format("{}[{}]", path_, index + 1), warnings_};
}

double JsonNode::number() const {
  if (!json_->is_number() || !std::isfinite(json_->get<double>())) throw reject("must be a finite number");
  compare(json_->get<double>());
  return json_->get<double>();
}

std::complex<double> JsonNode::complex_number() const {
  if (json_->is_number()) return number();
  if (!json_->is_array() || size() != 2) throw reject("must be [re, im]");
  return {at(std::size_t{0}).number(), at(std::size_t{1}).number()};
}

Eigen::VectorXd JsonNode::numbers() const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(size()));
  Eigen::Index i = 0;
  for (const Json& entry : *json_) {
    if (!entry.is_number() || !std::isfinite(entry.get<double>())) {
      throw at(static_cast<std::size_t>(i)).reject("must be a finite number");
    }
    values(i++) = entry.get<double>();
  }
  if (values.size() > 0) compare(values.cwiseAbs().maxCoeff());
  return values;
}

std::string JsonNode::text() const {
  if (!json_->is_string()) throw reject("must be text");
  return json_->get<std::string>();
}

Json read_json(const std::filesystem::path& path) {
  return parse_json(read_file(path), path.string());
}

Json parse_json(std::string_view content, const std::string& name) {
  require_shallow(content, name);
  try {
    return parsed(content);
  } catch (const nlohmann::json::exception& error) {
    const auto* parse = dynamic_cast<const nlohmann::json::parse_error*>(&error);
    const std::size_t line = line_of(content, parse != nullptr ? parse->byte : 0);
    std::string reason = error.what();
    reason = reason.substr(std::min(reason.find("] ") + 2, reason.size()));
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", name, line), .rule = "is no JSON: " + reason});
  }
}

}  // namespace robomill::io
