#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/jobs/verbs.hpp"

namespace robomill::jobs {
namespace {

using RequireInside = std::function<void(const std::string&)>;

constexpr std::size_t most_entries = 10'000, longest_text = 4096;

/// "a number > 0"
std::string number_rule(const VerbOption& option) {
  std::string rule = option.takes == Takes::whole ? "must be a whole number" : "must be a number";
  if (std::isfinite(option.above)) rule += fmt::format(" > {}", option.above);
  if (std::isfinite(option.at_least)) rule += fmt::format(" >= {}", option.at_least);
  if (std::isfinite(option.at_most)) rule += fmt::format(" and <= {}", option.at_most);
  return rule;
}

class Checker {
 public:
  Checker(const VerbOption& option, std::string name, const io::Json& value, const RequireInside& require_inside)
      : option_(option), name_(std::move(name)), value_(value), require_inside_(require_inside) {}

  void check() const {
    switch (option_.takes) {
      case Takes::flag:
        if (!value_.is_boolean()) throw reject("must be true or false");
        return;
      case Takes::whole:
      case Takes::number:
        return check_number(value_, number_rule(option_));
      case Takes::numbers:
        return check_numbers();
      case Takes::text:
        if (!is_text(value_)) throw reject("must be a text");
        return;
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
        if (!is_point(value_)) throw reject("must be [spindle speed in rpm, > 0, depth in mm]");
        return require_speed(value_[0].get<double>());
      case Takes::points:
        check_list([](const io::Json& one) { return is_point(one); },
                   "must be a list of [spindle speed in rpm, > 0, depth in mm]");
        for (const io::Json& one : value_) require_speed(one[0].get<double>());
    }
  }

 private:
  [[nodiscard]] InvalidInput reject(std::string rule) const {
    std::string value = io::plain_text(value_);
    constexpr std::size_t shown = 80;
    if (value.size() > shown) value = value.substr(0, shown) + "…";
    return InvalidInput(InvalidInput::Parts{.field = name_, .value = std::move(value), .rule = std::move(rule)});
  }

  static bool is_text(const io::Json& one) {
    return one.is_string() && !one.get_ref<const std::string&>().empty() &&
           one.get_ref<const std::string&>().size() <= longest_text;
  }
  static bool is_number(const io::Json& one) { return one.is_number() && std::isfinite(one.get<double>()); }
  static bool is_point(const io::Json& one) {
    return one.is_array() && one.size() == 2 && is_number(one[0]) && is_number(one[1]) && one[0].get<double>() > 0.0;
  }

  void require_speed(double rpm) const {
    try {
      cutting::require_spindle_speed(name_, rpm * units::rpm);
    } catch (const InvalidInput& error) {
      throw in_unit(error, units::rpm, "rpm");
    }
  }
  void check_number(const io::Json& one, const std::string& rule) const {
    if (option_.takes == Takes::whole ? !one.is_number_integer() : !is_number(one)) throw reject(rule);
    const double value = one.get<double>();
    if (option_.unit == "rpm") require_speed(value);
    if (value > option_.above && value >= option_.at_least && value <= option_.at_most) return;
    throw InvalidInput(name_, value, std::string(option_.unit), "must be" + rule.substr(rule.find_first_of("<>") - 1));
  }
  void check_numbers() const {
    const std::string rule =
        option_.count == 0 ? "must be a list of numbers" : fmt::format("must be a list of {} numbers", option_.count);
    check_list(is_number, rule);
    if (option_.count != 0 && value_.size() != option_.count) throw reject(rule);
    for (const io::Json& one : value_) check_number(one, number_rule(option_));
  }
  void check_word() const {
    const bool known =
        value_.is_string() && std::ranges::find(option_.words, value_.get<std::string>()) != option_.words.end();
    if (!known) throw reject(fmt::format("must be one of \"{}\"", fmt::join(option_.words, "\", \"")));
  }
  void check_path(const io::Json& one, const char* rule) const {
    if (!is_text(one)) throw reject(rule);
    if (!require_inside_) return;
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
  std::string name_;
  const io::Json& value_;
  const RequireInside& require_inside_;
};

stability::OperatingPoint point_of(const io::Json& pair) {
  return {.spindle_speed_rad_per_s = pair[0].get<double>() * units::rpm,
          .axial_depth_m = pair[1].get<double>() * units::mm};
}

/// The verb's option or input; null: it has none of that name.
const VerbOption* find_option(const Verb& verb, std::string_view name) {
  if (name == verb.input.name) return &verb.input;
  const auto found = std::ranges::find(verb.options, name, &VerbOption::name);
  return found == verb.options.end() ? nullptr : &*found;
}

std::string option_name(const Verb& verb, AskedBy asked_by, std::string_view name) {
  const VerbOption* const option = find_option(verb, name);
  return asked_by == AskedBy::command_line ? command_line_name(option != nullptr ? *option : VerbOption{.name = name})
                                           : "options." + std::string(name);
}

}  // namespace

std::string command_line_name(const VerbOption& option) {
  if (!option.flag.empty()) return std::string(option.flag);
  std::string name = "--" + std::string(option.name);
  std::ranges::replace(name, '_', '-');
  return name;
}

std::uint64_t VerbJob::seed() const {
  return get("seed", std::uint64_t{1});
}

std::vector<std::filesystem::path> VerbJob::files(const char* name) const {
  std::vector<std::filesystem::path> out;
  for (const std::string& file : texts(name)) out.push_back(root / file);
  return out;
}

std::vector<double> VerbJob::numbers(const char* name, double unit) const {
  std::vector<double> out = get(name, std::vector<double>());
  for (double& value : out) value *= unit;
  return out;
}

stability::OperatingPoint VerbJob::point(const char* name) const {
  return has(name) ? point_of(options.at(name)) : stability::OperatingPoint{};
}

std::vector<stability::OperatingPoint> VerbJob::points(const char* name) const {
  std::vector<stability::OperatingPoint> out;
  if (!has(name)) return out;
  for (const io::Json& pair : options.at(name)) out.push_back(point_of(pair));
  return out;
}

std::string VerbJob::named(std::string_view option) const {
  return option_name(verb, asked_by, option);
}

InvalidInput VerbJob::about_option(const InvalidInput& error, std::string_view member, std::string_view option,
                                   double unit) const {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty() || !parts.field.starts_with(member)) return error;
  const std::string below = parts.field.substr(member.size());
  if (!below.empty() && !below.starts_with('[')) return error;
  parts.field = named(option) + below;
  if (parts.number) *parts.number /= unit;
  const VerbOption* const known = find_option(verb, option);
  if (parts.number && known != nullptr) parts.unit = known->unit;
  return InvalidInput(std::move(parts));
}

bool is_required(const VerbOption& option, const std::filesystem::path& input) {
  return option.required && !(option.job_gives && io::format_of(input) == io::Format::toml);
}

io::Json checked_options(const Verb& verb, AskedBy asked_by, const std::filesystem::path& input,
                         const io::Json& options, const RequireInside& require_inside) {
  if (!options.is_object()) throw InvalidInput("options", "must be an object");
  io::Json out = io::Json::object();
  for (const auto& [name, value] : options.items()) {
    const auto known = std::ranges::find(verb.options, std::string_view(name), &VerbOption::name);
    if (known == verb.options.end()) {
      std::vector<std::string> names;
      names.reserve(verb.options.size());
      for (const VerbOption& option : verb.options) names.emplace_back(option.name);
      const std::string nearest = io::nearest_word(name, names);
      throw InvalidInput("options." + name.substr(0, longest_text), fmt::format("is no option of {}", verb.name),
                         nearest.empty() ? fmt::format("It has {}", fmt::join(names, ", "))
                                         : fmt::format("Did you mean {}?", nearest));
    }
    if (value.is_null()) continue;
    Checker(*known, option_name(verb, asked_by, name), value, require_inside).check();
    out[name] = value;
  }
  for (const VerbOption& option : verb.options) {
    const std::string name = option_name(verb, asked_by, option.name);
    if (is_required(option, input) && !out.contains(option.name)) {
      throw InvalidInput(name, fmt::format("is missing; {} needs it", verb.name), std::string(option.meaning));
    }
    if (!option.needs.empty() && out.contains(option.name) && !out.contains(option.needs)) {
      throw InvalidInput(name, fmt::format("goes with {}", option_name(verb, asked_by, option.needs)));
    }
    if (!option.excludes.empty() && out.contains(option.name) && out.contains(option.excludes)) {
      throw InvalidInput(name, fmt::format("does not go with {}", option_name(verb, asked_by, option.excludes)));
    }
  }
  return out;
}

}  // namespace robomill::jobs
