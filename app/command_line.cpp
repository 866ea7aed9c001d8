#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <sstream>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/text.hpp"
#include "robomill/version.hpp"
#include "terminal.hpp"

namespace robomill::app {
namespace {

using jobs::Takes;
using jobs::Verb;
using jobs::VerbOption;

/// @param rule  after "must be"
template <class Holds>
CLI::Validator must_be(const std::string& rule, Holds holds) {
  return CLI::Validator(
      [rule, holds](std::string& text) {
        return holds(text) ? std::string() : "must be " + rule + ", not \"" + text + "\"";
      },
      {});
}

std::optional<double> number_in(const std::string& text) {
  const std::optional<double> value = io::parse_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> whole_in(const std::string& text) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc() && read.ptr == end ? std::optional(value) : std::nullopt;
}

CLI::Validator whole_number(const VerbOption& option) {
  std::ostringstream rule;
  rule.precision(12);
  rule << "a whole number " << (std::isfinite(option.at_most) ? "from " : "≥ ") << option.at_least;
  if (std::isfinite(option.at_most)) rule << " to " << option.at_most;
  return must_be(rule.str(), [&option](const std::string& text) {
    const std::optional<std::int64_t> value = whole_in(text);
    return value && static_cast<double>(*value) >= option.at_least && static_cast<double>(*value) <= option.at_most;
  });
}

/// [6500, 0.8] of "6500,0.8".
io::Json point_in(const std::string& name, const std::string& text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  const std::optional<double> rpm = number_in(text.substr(0, comma));
  const std::optional<double> mm = number_in(text.substr(std::min(comma + 1, text.size())));
  if (rpm && *rpm > 0.0 && mm) return {*rpm, *mm};
  throw InvalidInput(InvalidInput::Parts{
      .field = name, .value = "\"" + text + "\"", .rule = "must read RPM,MM", .hint = "For example 6500,0.8"});
}

/// An option as it is parsed.
struct Slot {
  const VerbOption& option;
  CLI::Option* parsed = nullptr;
  bool flag = false;
  std::string text = {};
  std::vector<std::string> list = {};

  [[nodiscard]] bool given() const { return parsed->count() > 0; }
  [[nodiscard]] io::Json value() const {
    io::Json out = io::Json::array();
    switch (option.takes) {
      case Takes::flag:
        return flag;
      case Takes::whole:
        return whole_in(text).value();
      case Takes::number:
        return number_in(text).value();
      case Takes::numbers:
        for (const std::string& one : list) out.push_back(number_in(one).value());
        return out;
      case Takes::point:
        return point_in(command_line_name(option), text);
      case Takes::points:
        for (const std::string& one : list) out.push_back(point_in(command_line_name(option), one));
        return out;
      case Takes::texts:
      case Takes::files:
        return list;
      default:
        return text;
    }
  }
};

/// One verb of the parser.
struct Subcommand {
  VerbGroup group = {};
  CLI::App* app = nullptr;
  std::deque<Slot> slots = {};

  [[nodiscard]] Slot* find(std::string_view name) {
    const auto found = std::ranges::find(slots, name, [](const Slot& slot) { return slot.option.name; });
    return found == slots.end() ? nullptr : &*found;
  }
  void add(const VerbOption& option, bool follows, bool required);
  void add_key(const Verb& verb);
  [[nodiscard]] const Verb& chosen();
};

/// @param follows  the verb, without a name
void Subcommand::add(const VerbOption& option, bool follows, bool required) {
  Slot& slot = slots.emplace_back(Slot{.option = option});
  const std::string name = follows ? std::string(option.name) : command_line_name(option);
  const std::string meaning(option.meaning);
  if (option.takes == Takes::flag) {
    slot.parsed = app->add_flag(name, slot.flag, meaning);
    return;
  }
  const bool split = option.takes == Takes::numbers || option.takes == Takes::texts;
  const bool several = split || option.takes == Takes::files || option.takes == Takes::points;
  slot.parsed = several ? app->add_option(name, slot.list, meaning) : app->add_option(name, slot.text, meaning);
  slot.parsed->type_name(value_name(option.takes))->required(required);
  if (split) slot.parsed->delimiter(',');
  if (option.takes == Takes::files && !follows) slot.parsed->allow_extra_args(false);
  if (option.count != 0) slot.parsed->expected(static_cast<int>(option.count));
  if (option.takes == Takes::whole) slot.parsed->check(whole_number(option));
  if (option.takes == Takes::number || option.takes == Takes::numbers) {
    slot.parsed->check(must_be("a number", [](const std::string& text) { return number_in(text).has_value(); }));
  }
  if (!option.words.empty()) {
    slot.parsed->check(CLI::IsMember(std::vector<std::string>(option.words.begin(), option.words.end())));
  }
}

/// What goes with the option that makes another verb of the plain one, and what does not.
void Subcommand::add_key(const Verb& verb) {
  const auto has = [](const Verb& one, const VerbOption& option) {
    return one.input.name == option.name ||
           std::ranges::find(one.options, option.name, &VerbOption::name) != one.options.end();
  };
  const auto key =
      std::ranges::find(slots, key_of(verb), [](const Slot& slot) { return command_line_name(slot.option); });
  for (Slot& slot : slots) {
    const bool of_verb = has(verb, slot.option), of_plain = has(group.plain(), slot.option);
    const bool of_all =
        std::ranges::find(common_options(), slot.option.name, &VerbOption::name) != common_options().end();
    if (&slot == &*key || of_verb == of_plain || of_all) continue;
    if (of_plain) {
      slot.parsed->excludes(key->parsed);
      continue;
    }
    slot.parsed->needs(key->parsed);
    if (slot.option.required) key->parsed->needs(slot.parsed);
  }
}

const Verb& Subcommand::chosen() {
  for (const Verb* const verb : group.verbs) {
    const auto given = [verb](const Slot& slot) {
      return slot.given() && command_line_name(slot.option) == key_of(*verb);
    };
    if (std::ranges::any_of(slots, given)) return *verb;
  }
  return group.plain();
}

}  // namespace

const char* value_name(Takes takes) {
  switch (takes) {
    case Takes::whole:
      return "N";
    case Takes::number:
    case Takes::numbers:
      return "NUMBER";
    case Takes::file:
    case Takes::files:
    case Takes::new_file:
      return "FILE";
    case Takes::new_folder:
      return "FOLDER";
    case Takes::point:
    case Takes::points:
      return "RPM,MM";
    default:
      return "TEXT";
  }
}

std::string_view key_of(const Verb& verb) {
  return verb.name.substr(std::min(verb.name.find("--"), verb.name.size()));
}

const std::vector<VerbOption>& common_options() {
  static const std::vector<VerbOption> all = {
      {.name = "output",
       .meaning = "write here, the format by its ending; - writes JSON to standard output",
       .takes = Takes::new_file,
       .flag = "-o,--output"},
      {.name = "quiet", .meaning = "no summary and no progress"},
      {.name = "threads",
       .meaning = "threads to use (default: one a core)",
       .takes = Takes::whole,
       .at_least = 1,
       .at_most = 10'000},
      {.name = "seed", .meaning = "seed of random numbers (default: 1)", .takes = Takes::whole, .at_least = 0},
      {.name = "report", .meaning = "a page to look at (.html), or its data (.json)", .takes = Takes::new_file},
      {.name = "allow_large",
       .meaning = "do what takes more than 10 minutes of one core or 2 GB, instead of rejecting it before it begins"}};
  return all;
}

std::vector<const VerbOption*> VerbGroup::options() const {
  std::vector<const VerbOption*> out;
  const auto add = [&out](const VerbOption& option) {
    if (std::ranges::find(out, option.name, &VerbOption::name) == out.end()) out.push_back(&option);
  };
  for (const Verb* const verb : verbs) {
    if (!verb->input.flag.empty()) add(verb->input);
    for (const VerbOption& option : verb->options) add(option);
  }
  const std::vector<VerbOption>& common = common_options();
  const std::ptrdiff_t count = plain().computes ? std::ssize(common) : std::ssize(common) - 2;
  std::for_each(common.begin(), common.begin() + count, add);
  return out;
}

const std::vector<Verb>& all_verbs() {
  static const std::vector<Verb> all = [] {
    std::vector<Verb> out = own_verbs();
    out.insert(out.begin() + 1, jobs::verbs().begin(), jobs::verbs().end());  // behind init
    return out;
  }();
  return all;
}

std::vector<VerbGroup> verb_groups() {
  std::vector<VerbGroup> out;
  for (const Verb& verb : all_verbs()) {
    const std::string_view plain = verb.name.substr(0, verb.name.find(" --"));
    const auto known = std::ranges::find(out, plain, &VerbGroup::name);
    (known == out.end() ? out.emplace_back(VerbGroup{.name = plain}) : *known).verbs.push_back(&verb);
  }
  return out;
}

struct CommandLine::Parts {
  CLI::App parser{"robomill keeps a milling robot out of chatter: hammer hits to safe cutting conditions.", "robomill"};
  std::deque<Subcommand> verbs = {};
  Subcommand* chosen = nullptr;
  const Verb* verb = nullptr;

  void add(VerbGroup group);
  /// @throws CLI::ParseError
  void require_input();
};

void CommandLine::Parts::add(VerbGroup group) {
  CLI::App* above = &parser;
  std::string name(group.name);
  const Verb& plain = group.plain();
  if (const std::size_t space = name.find(' '); space != std::string::npos) {
    above = parser.add_subcommand(name.substr(0, space), std::string(plain.purpose));
    above->require_subcommand(1);
    name = name.substr(space + 1);
  }
  Subcommand& sub = verbs.emplace_back(Subcommand{.group = std::move(group)});
  sub.app = above->add_subcommand(name, std::string(plain.purpose));
  const bool always = sub.group.verbs.back()->input.name == plain.input.name;
  if (plain.input.flag.empty()) sub.add(plain.input, true, plain.input.required && always);
  for (const VerbOption* const option : sub.group.options()) {
    const bool of_plain = option == &plain.input || std::ranges::any_of(plain.options, [option](const VerbOption& one) {
                            return &one == option;
                          });
    sub.add(*option, false, option->required && !option->job_gives && of_plain);
  }
  for (const Verb* const each : sub.group.verbs) {
    if (each != &plain) sub.add_key(*each);
  }
  for (Slot& slot : sub.slots) {
    if (!slot.option.needs.empty()) slot.parsed->needs(sub.find(slot.option.needs)->parsed);
    if (!slot.option.excludes.empty()) slot.parsed->excludes(sub.find(slot.option.excludes)->parsed);
  }
  std::string footer;
  for (const Verb* const each : sub.group.verbs) footer += "Example: robomill " + std::string(each->example) + "\n";
  footer += "Documentation: docs/formats.md" + (plain.readme.empty() ? "" : ", " + std::string(plain.readme));
  sub.app->footer(footer);
  sub.app->callback([this, &sub] { chosen = &sub; });
}

void CommandLine::Parts::require_input() {
  verb = &chosen->chosen();
  const Slot* const input = chosen->find(verb->input.name);
  const bool given = input != nullptr && input->given();
  for (const VerbOption& option : verb->options) {
    if (!given || chosen->find(option.name)->given()) continue;
    if (jobs::is_required(option, input->text)) throw CLI::RequiredError(command_line_name(option));
  }
  if (!verb->input.required || given) return;
  throw CLI::RequiredError(std::string(verb->input.name) + ", or " + std::string(key_of(*chosen->group.verbs.back())));
}

CommandLine::CommandLine() : parts_(std::make_unique<Parts>()) {
  parts_->parser.set_version_flag("--version", "robomill " ROBOMILL_VERSION);
  parts_->parser.require_subcommand(1);
  for (VerbGroup& group : verb_groups()) parts_->add(std::move(group));
}

CommandLine::~CommandLine() = default;

std::optional<Exit> CommandLine::parse(int argc, const char* const* argv) {
  try {
    parts_->parser.parse(argc, argv);
    parts_->require_input();
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    std::stringstream out, err;
    const int code = parts_->parser.exit(error, out, err);
    std::fputs(out.str().c_str(), stdout);
    for (std::string row; std::getline(err, row);) std::fprintf(stderr, "%s\n", printable(row).c_str());
    return code == 0 ? done : wrong_usage;
  }
}

Asked CommandLine::asked() const {
  Subcommand& sub = *parts_->chosen;
  const Verb& verb = *parts_->verb;
  Asked out{.common = {}, .job = {.verb = verb, .asked_by = jobs::AskedBy::command_line}, .outputs = {}};
  io::Json options = io::Json::object();
  for (const Slot& slot : sub.slots) {
    if (!slot.given()) continue;
    const std::string_view name = slot.option.name;
    if (name == verb.input.name) {
      for (const std::string& one : slot.list) out.job.inputs.emplace_back(one);
      if (slot.list.empty()) out.job.inputs.emplace_back(slot.text);
      continue;
    }
    if (std::ranges::find(verb.options, name, &VerbOption::name) != verb.options.end()) options[name] = slot.value();
    const bool written = slot.option.takes == Takes::new_file || slot.option.takes == Takes::new_folder;
    if (written && (name != "output" || slot.text != "-")) out.outputs.emplace_back(slot.text);
  }
  const auto text_of = [&sub](std::string_view name) {
    const Slot* const slot = sub.find(name);
    return slot != nullptr ? slot->text : std::string();
  };
  const auto flag_of = [&sub](std::string_view name) {
    const Slot* const slot = sub.find(name);
    return slot != nullptr && slot->flag;
  };
  out.common = {.output = text_of("output"),
                .report = text_of("report"),
                .quiet = flag_of("quiet"),
                .threads = static_cast<int>(whole_in(text_of("threads")).value_or(0)),
                .allow_large = flag_of("allow_large")};
  const std::filesystem::path input = out.job.inputs.empty() ? "" : out.job.inputs.front();
  out.job.options = checked_options(verb, jobs::AskedBy::command_line, input, options);
  if (!out.common.to_stdout()) out.job.output = out.common.output;
  out.job.wants_json = out.common.to_stdout();
  out.job.wants_curves = is_html(out.common.report);
  return out;
}

}  // namespace robomill::app
