#include "robomill/program/files/unread_dialect.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "robomill/io/text.hpp"
#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {
namespace {

constexpr std::size_t most_lines = 400;

/// Where a sign stands in a line.
enum class OfLine {
  begin,     ///< after blanks and a line's number
  anywhere,  ///< as a word of its own where it begins or ends with a letter or digit
};

struct Sign {
  std::string_view text;  ///< in upper case; a # stands for a digit
  OfLine place = OfLine::anywhere;
  bool strong = true;  ///< shows the dialect whatever the file's name ends with
};

struct Dialect {
  std::span<const std::string_view> endings;
  std::span<const Sign> signs;
  std::string_view rule, hint;
};

constexpr std::string_view as_gcode = "Post-process the path as G-code (.nc, .ngc) or as APT/CL (.apt, .cls)";
constexpr std::string_view what_it_came_from =
    "It is what a robot runs. Give the path that it was made from: G-code (.nc), APT/CL (.apt, .cls), or a CSV of "
    "poses";

constexpr std::string_view klartext_endings[] = {".h"};
constexpr Sign klartext_signs[] = {
    {"BEGIN PGM", OfLine::begin},     {"END PGM", OfLine::begin},     {"BLK FORM", OfLine::begin},
    {"TOOL CALL", OfLine::begin},     {"CYCL DEF", OfLine::begin},    {"CYCL CALL", OfLine::begin},
    {"PLANE SPATIAL", OfLine::begin}, {"FN #", OfLine::begin, false}, {"L X", OfLine::begin, false},
    {"L Y", OfLine::begin, false},    {"L Z", OfLine::begin, false},  {"L IX", OfLine::begin, false},
    {"L IZ", OfLine::begin, false},   {"CC X", OfLine::begin, false}, {"LBL", OfLine::begin, false},
    {"FMAX", OfLine::anywhere, false}};

constexpr std::string_view sinumerik_endings[] = {".mpf", ".spf", ".arc"};
constexpr Sign sinumerik_signs[] = {{"%_N_"},
                                    {";$PATH="},
                                    {"TRAORI"},
                                    {"TRAFOOF"},
                                    {"CYCLE8##"},
                                    {"SUPA"},
                                    {"DEF REAL", OfLine::begin},
                                    {"DEF INT", OfLine::begin},
                                    {"COMPCAD"},
                                    {"COMPOF"},
                                    {"A3="},
                                    {"=IC("},
                                    {"=AC("},
                                    {"=DC("},
                                    {"T=\""},
                                    {"G710"},
                                    {"G700"},
                                    {"G71", OfLine::anywhere, false},
                                    {"G70", OfLine::anywhere, false},
                                    {"G500", OfLine::anywhere, false},
                                    {"CR=", OfLine::anywhere, false},
                                    {"MSG(", OfLine::anywhere, false},
                                    {"M17", OfLine::anywhere, false},
                                    {"L#", OfLine::begin, false}};

constexpr std::string_view krl_endings[] = {".src", ".dat", ".sub"};
constexpr Sign krl_signs[] = {{"&ACCESS", OfLine::begin},
                              {"&REL", OfLine::begin},
                              {"$VEL."},
                              {"$TOOL"},
                              {"$BASE"},
                              {"BAS (#"},
                              {"BAS(#"},
                              {"PTP {", OfLine::begin},
                              {"LIN {", OfLine::begin},
                              {"CIRC {", OfLine::begin},
                              {"SPTP", OfLine::begin},
                              {"SLIN", OfLine::begin},
                              {"PTP", OfLine::begin},
                              {"LIN", OfLine::begin, false},
                              {"DEF", OfLine::begin, false},
                              {";FOLD", OfLine::begin}};

constexpr std::string_view tp_endings[] = {".ls"};
constexpr Sign tp_signs[] = {{"/PROG", OfLine::begin}, {"/ATTR", OfLine::begin}, {"/MN", OfLine::begin}};

constexpr std::string_view rapid_endings[] = {".mod", ".modx", ".prg", ".sys"};
constexpr Sign rapid_signs[] = {{"MOVEL"},
                                {"MOVEJ"},
                                {"MOVEC"},
                                {"MOVEABSJ"},
                                {"ENDPROC", OfLine::begin},
                                {"ENDMODULE", OfLine::begin},
                                {"PERS TOOLDATA", OfLine::begin},
                                {"MODULE", OfLine::begin}};

constexpr std::string_view inform_endings[] = {".jbi"};
constexpr Sign inform_signs[] = {{"/JOB", OfLine::begin}, {"///RCONF", OfLine::begin}, {"MOVL ", OfLine::begin}};

constexpr std::string_view urscript_endings[] = {".script", ".urscript"};
constexpr Sign urscript_signs[] = {{"MOVEL(P["}, {"MOVEJ(["}, {"MOVEP(P["}, {"SERVOJ("}};

constexpr Sign apt_signs[] = {{"GOTO/"}, {"FEDRAT/"}, {"PARTNO", OfLine::begin}, {"CUTTER/"}};

constexpr std::array<Dialect, 8> dialects = {{
    {klartext_endings, klartext_signs, "is a Heidenhain conversational program (Klartext), which is not read yet",
     as_gcode},
    {krl_endings, krl_signs, "is a program of a KUKA robot (KRL), which is not read yet", what_it_came_from},
    {tp_endings, tp_signs, "is a program of a FANUC robot (TP listing), which is not read yet", what_it_came_from},
    {inform_endings, inform_signs, "is a program of a Yaskawa robot (INFORM job), which is not read",
     what_it_came_from},
    {urscript_endings, urscript_signs, "is a program of a Universal Robots arm (URScript), which is not read",
     what_it_came_from},
    {rapid_endings, rapid_signs, "is a program of an ABB robot (RAPID), which is not read yet", what_it_came_from},
    {{}, apt_signs, "is a cutter location file (APT/CL)", "Let its name end in .apt, .cls, .cl, .ncl or .aptsource"},
    {sinumerik_endings, sinumerik_signs, "is a Sinumerik 840D program, which is not read yet", as_gcode},
}};

bool is_word_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Whether a sign stands at a place of a line.
bool stands_at(std::string_view line, std::size_t at, std::string_view sign) {
  if (line.size() - at < sign.size()) return false;
  for (std::size_t i = 0; i < sign.size(); ++i) {
    const char c = line[at + i];
    if (sign[i] == '#' ? std::isdigit(static_cast<unsigned char>(c)) == 0 : c != sign[i]) return false;
  }
  const std::size_t end = at + sign.size();
  const bool cut_before = at > 0 && is_word_letter(sign.front()) && is_word_letter(line[at - 1]);
  // "L X+12": the number follows its letter; "L100" goes on with digits.
  const bool may_go_on = sign.back() == '#' || sign == "A3=" || sign.find(' ') != std::string_view::npos;
  const bool cut_after = !may_go_on && end < line.size() && is_word_letter(sign.back()) && is_word_letter(line[end]);
  return !cut_before && !cut_after;
}

/// Whether it would be taken out with the comments of G-code.
bool is_in_comments(const Sign& sign) {
  return sign.text.find_first_of(";(") != std::string_view::npos;
}

bool shows(std::string_view line, const Sign& sign) {
  if (sign.place == OfLine::begin) return stands_at(line, 0, sign.text);
  for (std::size_t at = 0; at + sign.text.size() <= line.size(); ++at) {
    if (stands_at(line, at, sign.text)) return true;
  }
  return false;
}

/// In upper case, without its number: "12 L X+5" and "N20 T1".
std::string plain(std::string_view line) {
  std::string out;
  for (const char c : io::trimmed(line)) out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::size_t at = 0;
  if (at < out.size() && out[at] == 'N' && out.size() > 1 && std::isdigit(static_cast<unsigned char>(out[1])) != 0)
    ++at;
  const std::size_t digits = at;
  while (at < out.size() && std::isdigit(static_cast<unsigned char>(out[at])) != 0) ++at;
  if (at > digits && at < out.size() && out[at] == ' ') out.erase(0, out.find_first_not_of(' ', at));
  return out;
}

/// Without G-code's comments, which may speak of anything.
std::string without_comments(std::string_view line) {
  std::string out;
  int depth = 0;
  for (const char c : line) {
    if (c == ';') break;
    const bool comment = c == '(';
    if (comment || (c == '(' && depth > 0)) ++depth;
    if (depth == 0) out += c;
    if (c == ')' && depth > 0) --depth;
  }
  return out;
}

}  // namespace

std::optional<UnreadDialect> unread_dialect(std::string_view ending, std::string_view head) {
  for (std::size_t number = 1; !head.empty() && number <= most_lines; ++number) {
    const LineEnd end = line_end(head);
    const std::string_view line = head.substr(0, end.at);
    head.remove_prefix(end.at + end.bytes);
    const std::string text = plain(line), code = plain(without_comments(line));
    for (const Dialect& dialect : dialects) {
      const bool named = std::ranges::find(dialect.endings, ending) != dialect.endings.end();
      for (const Sign& sign : dialect.signs) {
        if ((!sign.strong && !named) || !shows(is_in_comments(sign) ? text : code, sign)) continue;
        return UnreadDialect{
            .line = number, .shown = std::string(io::trimmed(line)), .rule = dialect.rule, .hint = dialect.hint};
      }
    }
  }
  return std::nullopt;
}

}  // namespace robomill::program
