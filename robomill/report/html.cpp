#include "robomill/report/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace robomill::report {
namespace {

constexpr std::string_view dash = "–";

std::string group_thousands(std::string digits) {
  const std::size_t start = digits.starts_with('-') ? 1 : 0;
  const std::size_t point = std::min(digits.find('.'), digits.size());
  if (point - start < 5) return digits;
  for (std::size_t at = point; at > start + 3;) {
    at -= 3;
    digits.insert(at, "\u202f");
  }
  return digits;
}

bool is_numeric(const std::string& heading) {
  return heading.starts_with('#');
}

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string escape_json_for_script(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    switch (c) {
      case '<':
        out += "\\u003c";
        break;
      case '>':
        out += "\\u003e";
        break;
      case '&':
        out += "\\u0026";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string fixed(const nlohmann::ordered_json& value, int decimals) {
  if (!value.is_number()) return std::string(dash);
  return group_thousands(fmt::format("{:.{}f}", value.get<double>(), decimals));
}

std::string significant(const nlohmann::ordered_json& value) {
  if (!value.is_number()) return std::string(dash);
  const double number = value.get<double>();
  const double size = std::abs(number);
  if (size == 0.0) return "0";
  if (size < 1e-4 || size >= 1e6) return fmt::format("{:.2e}", number);
  std::string text = fixed(value, std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6));
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string with_power(const nlohmann::ordered_json& value) {
  if (!value.is_number()) return std::string(dash);
  const double number = value.get<double>();
  const double size = std::abs(number);
  if (size == 0.0 || (size >= 1e-3 && size < 1e4)) return fmt::format("{:.4g}", number);
  const std::string text = fmt::format("{:.3e}", number);
  const std::size_t split = text.find('e');
  std::string out = text.substr(0, split);
  out.erase(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  out += "·10";
  constexpr std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  for (const char c : std::to_string(std::stoi(text.substr(split + 1)))) {
    out += c == '-' ? "⁻" : raised.at(static_cast<std::size_t>(c - '0'));
  }
  return out;
}

std::string percent(const nlohmann::ordered_json& ratio, int decimals) {
  if (!ratio.is_number()) return std::string(dash);
  return fmt::format("{:.{}f}\u202f%", 100.0 * ratio.get<double>(), decimals);
}

std::string with_deviation(const nlohmann::ordered_json& value, const nlohmann::ordered_json& deviation, double scale,
                           int decimals) {
  if (!value.is_number()) return std::string(dash);
  const double number = scale * value.get<double>();
  const double spread = deviation.is_number() ? scale * deviation.get<double>() : 0.0;
  if (!(spread > 0.0)) return group_thousands(fmt::format("{:.{}f}", number, decimals));
  const int shown = std::clamp(1 - static_cast<int>(std::floor(std::log10(spread))), 0, 6);
  return fmt::format("{}\u202f±\u202f{:.{}f}", group_thousands(fmt::format("{:.{}f}", number, shown)), spread, shown);
}

Table::Table(std::string caption, std::vector<std::string> headings)
    : caption_(std::move(caption)), headings_(std::move(headings)) {}

void Table::row(const std::vector<std::string>& cells, std::string_view row_class) {
  rows_ += row_class.empty() ? std::string("<tr>") : fmt::format("<tr class=\"{}\">", row_class);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool numeric = i < headings_.size() && is_numeric(headings_[i]);
    const bool wraps = !numeric && cells[i].size() > 24 && !cells[i].starts_with('<');
    rows_ += fmt::format("<td{}>{}</td>", numeric ? " class=\"number\"" : wraps ? " class=\"long\"" : "", cells[i]);
  }
  rows_ += "</tr>\n";
}

std::string Table::html() const {
  const bool quiet = caption_.starts_with('~');
  const std::string caption = escape(quiet ? caption_.substr(1) : caption_);
  std::string head;
  for (const std::string& heading : headings_) {
    const bool numeric = is_numeric(heading);
    head += fmt::format("<th scope=\"col\"{}>{}</th>", numeric ? " class=\"number\"" : "",
                        numeric ? heading.substr(1) : heading);
  }
  return fmt::format(
      "<div class=\"table\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table><caption{1}>{0}</caption>\n"
      "<thead><tr>{2}</tr></thead>\n<tbody>\n{3}</tbody></table></div>\n",
      caption, quiet ? " class=\"quiet\"" : "", head, rows_);
}

std::string mode_name(const nlohmann::ordered_json& object) {
  if (!object["mode"].is_number()) return {};
  const bool of_workpiece = text_of(object["mode_of"]) == "workpiece";
  return fmt::format("mode {}{}", object["mode"].get<int>(), of_workpiece ? " of the workpiece" : "");
}

const std::string& text_of(const nlohmann::ordered_json& value) {
  return value.get_ref<const std::string&>();
}

std::string facts_list(const nlohmann::ordered_json& facts) {
  if (facts.empty()) return {};
  std::string out = "<dl class=\"facts\">";
  for (const auto& fact : facts) {
    out += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", escape(text_of(fact["label"])),
                       escape(text_of(fact["value"])));
  }
  return out + "</dl>\n";
}

std::string warning_box(std::string_view heading, const nlohmann::ordered_json& texts) {
  if (texts.empty()) return {};
  return fmt::format("<aside class=\"warnings\" aria-label=\"{0}\"><h3>{0}</h3>\n{1}</aside>\n", escape(heading),
                     bullet_list(texts));
}

std::string bullet_list(const nlohmann::ordered_json& texts) {
  if (texts.empty()) return {};
  std::string out = "<ul>";
  for (const auto& line : texts) out += "<li>" + escape(text_of(line)) + "</li>";
  return out + "</ul>\n";
}

std::string details(std::string_view summary, std::string_view body) {
  return fmt::format("<details><summary>{}</summary>\n{}</details>\n", escape(summary), body);
}

}  // namespace robomill::report
