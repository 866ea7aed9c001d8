#include "manual.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "command_line.hpp"
#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/files/schemas.hpp"
#include "robomill/version.hpp"

namespace robomill::app {
namespace {

using jobs::Takes;
using jobs::Verb;
using jobs::VerbOption;

/// Text in which roff sees no request and no escape.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else {
      if (c == '-') out += '\\';
      out += c;
    }
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

/// "--method WORD": what stands behind an option.
std::string values_name(Takes takes) {
  switch (takes) {
    case Takes::flag:
      return "";
    case Takes::word:
      return "WORD";
    case Takes::numbers:
    case Takes::texts:
      return fmt::format("{},…", value_name(takes));
    default:
      return value_name(takes);
  }
}

std::string sentence(const VerbOption& option) {
  std::string out = roff(option.meaning);
  if (!option.words.empty()) out += roff(fmt::format("; one of {}", fmt::join(option.words, ", ")));
  if (!option.needs.empty()) out += roff(fmt::format("; goes with --{}", option.needs));
  return out;
}

std::string option_entry(const VerbOption& option) {
  return fmt::format(".TP\n\\fB{}\\fR {}\n{}\n", roff(command_line_name(option)),
                     option.takes == Takes::flag ? "" : fmt::format("\\fI{}\\fR", values_name(option.takes)),
                     sentence(option));
}

std::string verb_entry(const Verb& verb) {
  std::string out = fmt::format(".SS {}\n{}.\n", roff(verb.name), roff(verb.purpose));
  if (!verb.more.empty()) out += roff(verb.more) + "\n";
  if (verb.input.flag.empty()) {
    out += fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(verb.input.name), sentence(verb.input));
  } else {
    out += option_entry(verb.input);
  }
  for (const VerbOption& option : verb.options) out += option_entry(option);
  return out + fmt::format(".PP\nExample:\n.PP\n.EX\nrobomill {}\n.EE\n", roff(verb.example));
}

std::string option_words(const VerbGroup& group) {
  std::string out = "-h --help";
  for (const VerbOption* const option : group.options()) {
    std::string names = command_line_name(*option);
    if (const std::size_t comma = names.find(','); comma != std::string::npos) names[comma] = ' ';
    out += " " + names;
  }
  return out;
}

void write(const Common& common, const std::string& text) {
  if (common.output.empty() || common.to_stdout()) {
    fmt::print("{}", text);
  } else {
    io::write_file(common.output, text);
  }
}

}  // namespace

std::string manual() {
  std::string out = fmt::format(
      ".TH ROBOMILL 1 \"\" \"robomill {}\"\n.SH NAME\nrobomill \\- keeps a milling robot out of chatter\n"
      ".SH SYNOPSIS\n\\fBrobomill\\fR \\fIverb\\fR [\\fIoption\\fR]... \\fIfile\\fR...\n.SH DESCRIPTION\n"
      "From hammer hits to safe cutting conditions, a verb a step.\nEvery verb prints a summary for people.\n"
      ".SH OPTIONS OF EVERY VERB\n",
      ROBOMILL_VERSION);
  for (const VerbOption& option : common_options()) out += option_entry(option);
  out += ".SH VERBS\n";
  for (const Verb& verb : all_verbs()) out += verb_entry(verb);
  return out +
         ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nbad input\n.TP\n2\nwrong usage\n.TP\n3\n"
         "finished without an answer: not converged, no safe depth\n.TP\n130\ninterrupted\n";
}

std::string verbs_table() {
  std::string out = "| verb | what it does |\n|---|---|\n";
  for (const Verb& verb : all_verbs()) {
    out += fmt::format("| `robomill {}` | {}{} |\n", verb.example, verb.purpose,
                       verb.more.empty() ? "" : fmt::format(". {}", verb.more));
  }
  return out;
}

std::string bash_completion() {
  std::string first, below, words, options;
  for (const VerbGroup& group : verb_groups()) {
    const std::size_t space = group.name.find(' ');
    first += fmt::format(" {}", group.name.substr(0, space));
    if (space != std::string_view::npos)
      below += fmt::format("    {}) words='{}' ;;\n", group.name.substr(0, space), group.name.substr(space + 1));
    if (const std::vector<std::string_view>& inputs = group.plain().input.words; !inputs.empty())
      words += fmt::format("      '{} '*) words='{}' ;;\n", group.name, fmt::join(inputs, " "));
    for (const VerbOption* const option : group.options()) {
      if (option->words.empty()) continue;
      words.insert(0, fmt::format("      '{} {}') words='{}' ;;\n", group.name, command_line_name(*option),
                                  fmt::join(option->words, " ")));
    }
    options += fmt::format("      '{}') words='{}' ;;\n", group.name, option_words(group));
  }
  return fmt::format(
      "# bash completion of robomill; made by: robomill completion bash\n"
      "_robomill() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} verb=${{COMP_WORDS[1]}} words='' behind=2\n"
      "  case \"$verb\" in\n"
      "{}"
      "  esac\n"
      "  if [[ -n $words ]]; then\n"
      "    ((COMP_CWORD > 2)) && verb+=\" ${{COMP_WORDS[2]}}\" words='' behind=3\n"
      "  fi\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    words='{} --help --version'\n"
      "  elif ((COMP_CWORD >= behind)) && [[ $current == -* ]]; then\n"
      "    case \"$verb\" in\n"
      "{}"
      "    esac\n"
      "  elif ((COMP_CWORD >= behind)) && [[ -z $words ]]; then\n"
      "    case \"$verb ${{COMP_WORDS[COMP_CWORD - 1]}}\" in\n"
      "{}"
      "    esac\n"
      "  fi\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
      "}}\n"
      "complete -o default -F _robomill robomill\n",
      below, first.substr(1), options, words);
}

Exit run_schema(const jobs::VerbJob& job, const Common& common, Progress&) {
  std::string text;
  if (job.inputs.empty()) {
    for (const std::string& name : jobs::schema_names()) text += name + "\n";
  } else {
    text = jobs::schema_text(job.input().string());
  }
  write(common, text);
  return done;
}

Exit run_completion(const jobs::VerbJob&, const Common& common, Progress&) {
  write(common, bash_completion());
  return done;
}

Exit run_man(const jobs::VerbJob& job, const Common& common, Progress&) {
  const bool table = !job.inputs.empty() && job.input() == "markdown";
  write(common, table ? verbs_table() : manual());
  return done;
}

}  // namespace robomill::app
