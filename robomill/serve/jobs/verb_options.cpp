#include "robomill/serve/jobs/verb_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/text.hpp"

namespace robomill::serve {
namespace {

using RequireInside = std::function<void(const std::string&)>;

constexpr std::size_t most_entries = 64, longest_text = 1024;

/// "must be a number > 0"
std::string number_rule(const VerbOption& option) {
  std::string rule = option.takes == Takes::whole ? "must be a whole number" : "must be a number";
  if (std::isfinite(option.above)) rule += fmt::format(" > {:g}", option.above);
  if (std::isfinite(option.at_least)) rule += fmt::format(" >= {:g}", option.at_least);
  if (std::isfinite(option.at_most)) rule += fmt::format(" and <= {:g}", option.at_most);
  return rule;
}

class Checker {
 public:
  Checker(const VerbOption& option, const io::Json& value, const RequireInside& require_inside)
      : option_(option), value_(value), require_inside_(require_inside) {}

  void check() const {
    switch (option_.takes) {
      case Takes::flag:
        if (!value_.is_boolean()) throw reject("must be true or false");
        return;
      case Takes::whole:
      case Takes::number:
        return check_number();
      case Takes::numbers:
        return check_numbers();
      case Takes::texts:
        return check_list([](const io::Json& one) { return is_text(one); }, "must be a list of texts");
      case Takes::word:
        return check_word();
      case Takes::file:
      case Takes::new_file:
      case Takes::new_folder:
        return check_path(value_, "must be the path of a file");
      case Takes::files:
        check_list([](const io::Json& one) { return is_text(one); }, "must be a list of paths");
        for (const io::Json& one : value_) check_path(one, "must be a list of paths");
        return;
      case Takes::point:
        if (!is_point(value_)) throw reject(point_rule);
        return;
      case Takes::points:
        return check_list([](const io::Json& one) { return is_point(one); },
                          "must be a list of [spindle speed in rpm, > 0, depth in mm]");
    }
  }

 private:
  static constexpr const char* point_rule = "must be [spindle speed in rpm, > 0, depth in mm]";

  [[nodiscard]] InvalidInput reject(std::string rule) const {
    std::string value = io::plain_text(value_);
    constexpr std::size_t shown = 80;
    if (value.size() > shown) value = value.substr(0, shown) + "…";
    return InvalidInput(InvalidInput::Parts{
        .field = "options." + std::string(option_.name), .value = std::move(value), .rule = std::move(rule)});
  }

  static bool is_text(const io::Json& one) {
    return one.is_string() && !one.get_ref<const std::string&>().empty() &&
           one.get_ref<const std::string&>().size() <= longest_text;
  }
  static bool is_number(const io::Json& one) { return one.is_number() && std::isfinite(one.get<double>()); }
  static bool is_point(const io::Json& one) {
    return one.is_array() && one.size() == 2 && is_number(one[0]) && is_number(one[1]) && one[0].get<double>() > 0.0;
  }

  void check_number() const {
    const bool kind = option_.takes == Takes::whole ? value_.is_number_integer() : is_number(value_);
    const double value = kind ? value_.get<double>() : 0.0;
    if (!kind || !(value > option_.above) || value < option_.at_least || value > option_.at_most) {
      throw reject(number_rule(option_));
    }
  }
  void check_numbers() const {
    const std::string rule =
        option_.count == 0 ? "must be a list of numbers" : fmt::format("must be a list of {} numbers", option_.count);
    check_list(is_number, rule);
    if (option_.count != 0 && value_.size() != option_.count) throw reject(rule);
  }
  void check_word() const {
    const bool known =
        value_.is_string() && std::ranges::find(option_.words, value_.get<std::string>()) != option_.words.end();
    if (!known) throw reject(fmt::format("must be one of \"{}\"", fmt::join(option_.words, "\", \"")));
  }
  void check_path(const io::Json& one, const char* rule) const {
    if (!is_text(one)) throw reject(rule);
    try {
      require_inside_(one.get<std::string>());
    } catch (const InvalidInput& error) {
      throw reject(error.parts().rule);
    }
  }
  template <class Holds>
  void check_list(const Holds& holds, const std::string& rule) const {
    if (!value_.is_array() || value_.empty() || !std::ranges::all_of(value_, holds)) throw reject(rule);
    if (value_.size() > most_entries) throw reject(fmt::format("must have {} entries at most", most_entries));
  }

  const VerbOption& option_;
  const io::Json& value_;
  const RequireInside& require_inside_;
};

}  // namespace

io::Json checked_options(std::string_view verb, const std::vector<VerbOption>& options, const io::Json& given,
                         const RequireInside& require_inside) {
  if (!given.is_object()) throw InvalidInput("options", "must be an object");
  io::Json out = io::Json::object();
  for (const auto& [name, value] : given.items()) {
    const auto known = std::ranges::find(options, std::string_view(name), &VerbOption::name);
    if (known == options.end()) {
      std::vector<std::string> names;
      names.reserve(options.size());
      for (const VerbOption& option : options) names.emplace_back(option.name);
      const std::string nearest = io::nearest_word(name, names);
      throw InvalidInput("options." + name.substr(0, longest_text), fmt::format("is no option of {}", verb),
                         nearest.empty() ? fmt::format("It has {}", fmt::join(names, ", "))
                                         : fmt::format("Did you mean {}?", nearest));
    }
    if (value.is_null()) continue;
    Checker(*known, value, require_inside).check();
    out[name] = value;
  }
  for (const VerbOption& option : options) {
    if (option.required && !out.contains(option.name)) {
      throw InvalidInput(fmt::format("options.{}", option.name), fmt::format("is missing; {} needs it", verb),
                         std::string(option.does));
    }
  }
  return out;
}

io::Json option_json(const VerbOption& option) {
  io::Json json = {{"name", option.name},
                   {"does", option.does},
                   {"takes", name_in(takes_names, option.takes)},
                   {"required", option.required}};
  if (!option.words.empty()) json["words"] = option.words;
  if (!option.kinds.empty()) json["kinds"] = option.kinds;
  if (option.count != 0) json["count"] = option.count;
  return json;
}

}  // namespace robomill::serve
