#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

/// Small pieces of HTML. Every text that comes from outside goes through escape().
namespace robomill::report {

/// & < > " ' as entities: safe as text and inside a quoted attribute.
[[nodiscard]] std::string escape(std::string_view text);
/// JSON text that may stand inside a script element: < > & written as \u003c, \u003e, \u0026.
[[nodiscard]] std::string escape_json_for_script(std::string_view json);

/// A number with that many decimals and a thin space between thousands from 10 000 on; an en dash for null.
[[nodiscard]] std::string fixed(const nlohmann::ordered_json& value, int decimals);
/// A number to three significant digits, without an exponent or zeros at its end where that reads well; an en dash for
/// null.
[[nodiscard]] std::string significant(const nlohmann::ordered_json& value);
/// A number to four significant digits with its power of ten where that reads better: "9.706·10⁷"; an en dash for
/// null.
[[nodiscard]] std::string with_power(const nlohmann::ordered_json& value);
/// A ratio as percent: 0.0127 with 2 decimals is "1.27 %"; an en dash for null.
[[nodiscard]] std::string percent(const nlohmann::ordered_json& ratio, int decimals);
/// "17.412 ± 0.035": decimals so that the standard deviation shows two digits; without one, `decimals`.
[[nodiscard]] std::string with_deviation(const nlohmann::ordered_json& value, const nlohmann::ordered_json& deviation,
                                         double scale, int decimals);

/// A table whose cells are HTML already. A column whose heading starts with '#' holds numbers. A caption that starts
/// with '~' is only for who cannot see the heading above it.
class Table {
 public:
  explicit Table(std::string caption, std::vector<std::string> headings);
  void row(const std::vector<std::string>& cells, std::string_view row_class = {});
  [[nodiscard]] std::string html() const;

 private:
  std::string caption_, rows_;
  std::vector<std::string> headings_;
};

/// A text that JSON holds.
[[nodiscard]] const std::string& text_of(const nlohmann::ordered_json& value);
/// "mode 3", "mode 3 of the workpiece", of an object with mode and mode_of; empty for null.
[[nodiscard]] std::string mode_name(const nlohmann::ordered_json& object);
/// <dl> of labels and values; empty where there are none.
[[nodiscard]] std::string facts_list(const nlohmann::ordered_json& facts);
/// What to know first, under a heading; empty where there is nothing.
[[nodiscard]] std::string warning_box(std::string_view heading, const nlohmann::ordered_json& texts);
/// <ul> of the texts, escaped; empty where there are none.
[[nodiscard]] std::string bullet_list(const nlohmann::ordered_json& texts);
/// A part that opens on a click.
[[nodiscard]] std::string details(std::string_view summary, std::string_view body);

}  // namespace robomill::report
