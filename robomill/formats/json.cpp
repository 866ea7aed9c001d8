#include "robomill/formats/json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"

namespace robomill::formats {
namespace {

bool is_plain(const Json& value) {
  return !value.is_array() && !value.is_object();
}

/// Text that is no UTF-8, a file's name for one, must not end the writing.
std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Objects over lines; lists of plain values, and pairs of them, on one.
void write(const Json& json, int depth, std::string& out) {
  const std::string indent(static_cast<std::size_t>(depth) + 1, ' ');
  const char* joint = "";
  if (json.is_object() && !json.empty()) {
    out += "{\n";
    for (const auto& item : json.items()) {
      out += joint + indent + one_line(item.key()) + ": ";
      write(item.value(), depth + 1, out);
      joint = ",\n";
    }
    out += "\n" + std::string(static_cast<std::size_t>(depth), ' ') + "}";
  } else if (json.is_array() && !std::all_of(json.begin(), json.end(), is_plain)) {
    out += "[\n";
    for (const Json& entry : json) {
      out += joint + indent + one_line(entry);
      joint = ",\n";
    }
    out += "\n" + std::string(static_cast<std::size_t>(depth), ' ') + "]";
  } else {
    out += one_line(json);
  }
}

}  // namespace

Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return std::strtod(text, nullptr);
}

Json complex_number(const std::complex<double>& value) {
  return Json::array({number(value.real()), number(value.imag())});
}

Json numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(std::isfinite(value) ? Json(value) : Json());
  return out;
}

Json complex_numbers(const Eigen::Ref<const Eigen::VectorXcd>& values) {
  return {{"re", numbers(values.real())}, {"im", numbers(values.imag())}};
}

std::string dump(const Json& json) {
  std::string out;
  write(json, 0, out);
  return out + "\n";
}

JsonNode::JsonNode(const Json& json, std::string file, std::string path)
    : json_(&json), file_(std::move(file)), path_(std::move(path)) {}

InvalidInput JsonNode::refuse(std::string rule, std::string hint) const {
  InvalidInput::Parts parts{.where = file_, .field = path_, .rule = std::move(rule), .hint = std::move(hint)};
  if (json_->is_number()) {
    parts.number = json_->get<double>();
  } else if (is_plain(*json_)) {
    parts.value = one_line(*json_).substr(0, 60);
  }
  return InvalidInput(std::move(parts));
}

bool JsonNode::has(const char* key) const {
  return json_->is_object() && json_->contains(key);
}

void JsonNode::require_object() const {
  if (!json_->is_object()) throw refuse("must be an object, {…}");
}

JsonNode JsonNode::at(const std::string& key) const {
  require_object();
  const std::string path = path_.empty() ? key : path_ + "." + key;
  const auto found = json_->find(key);
  if (found == json_->end())
    throw InvalidInput(InvalidInput::Parts{.where = file_, .field = path, .rule = "is missing"});
  return {*found, file_, path};
}

std::size_t JsonNode::size() const {
  if (!json_->is_array()) throw refuse("must be a list, […]");
  return json_->size();
}

JsonNode JsonNode::at(std::size_t index) const {
  if (index >= size()) throw refuse("has too few entries");
  return {(*json_)[index], file_, path_ + "[" + std::to_string(index + 1) + "]"};
}

double JsonNode::number() const {
  if (!json_->is_number()) throw refuse("must be a number");
  const double value = json_->get<double>();
  if (!std::isfinite(value)) throw refuse("must be a finite number");
  return value;
}

std::complex<double> JsonNode::complex_number() const {
  if (size() != 2) throw refuse("must be [re, im]");
  return {at(std::size_t{0}).number(), at(std::size_t{1}).number()};
}

Eigen::VectorXd JsonNode::numbers() const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const Json& entry = (*json_)[i];
    // The fast way for what nearly every entry is; at() names the entry where it is not.
    out(static_cast<Eigen::Index>(i)) = entry.is_number_float() ? entry.get<double>() : at(i).number();
    if (!std::isfinite(out(static_cast<Eigen::Index>(i)))) throw at(i).refuse("must be a finite number");
  }
  return out;
}

std::string JsonNode::text() const {
  if (!json_->is_string()) throw refuse("must be text in quotes");
  return json_->get<std::string>();
}

Json read_json(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw InvalidInput(InvalidInput::Parts{.where = path.string() + ":" + std::to_string(line),
                                           .field = "text",
                                           .rule = "is no JSON",
                                           .hint = "A comma, quote or bracket is missing or too many"});
  } catch (const Json::exception&) {
    throw InvalidInput(path.string(), "is no JSON that can be read");
  }
}

}  // namespace robomill::formats
