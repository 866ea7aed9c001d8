#pragma once
// Joint programs read as a controller reads them, for tests of what is written.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace robomill::path::test {

/// A point of a program and when it is reached.
struct Point {
  double time_s = 0.0;
  std::array<double, 6> joints = {};
};

/// A program as a controller would take it; `trouble` is the first line that it would not.
struct Parsed {
  std::vector<Point> points = {};
  std::string trouble = {};
  double time_s = 0.0;

  void move(const std::smatch& match, std::size_t first, double seconds) {
    time_s += seconds;
    Point point{.time_s = time_s};
    for (std::size_t i = 0; i < 6; ++i) point.joints[i] = std::stod(match[first + i]);
    points.push_back(point);
  }
  void reject(const std::string& line) {
    if (trouble.empty()) trouble = line;
  }
};

inline const std::string real = R"((-?\d+\.?\d*))";

/// KRL: a DEF … END with PTP, PTP_SPLINE blocks of SPTP and TIME_BLOCK, and WAIT SEC.
inline Parsed parse_krl(const std::string& text) {
  std::string target = R"(\{A1 )" + real;
  for (int i = 2; i <= 6; ++i) target += ",A" + std::to_string(i) + " " + real;
  target += R"(\})";
  const std::regex ptp("PTP " + target);
  const std::regex segment(" SPTP " + target);
  const std::regex part(R"( TIME_BLOCK PART=(\d+\.\d+))");
  const std::regex end(R"( TIME_BLOCK END=(\d+\.\d+))");
  const std::regex wait(R"(WAIT SEC (\d+\.\d+))");
  const std::regex setting(R"(&[A-Z]+ \w+|; .*|BAS\(#\w+,\d+\)|\$[\w.]+=[\d.]+|\$LOAD=.*|\$OUT\[\d+\]=(TRUE|FALSE))");
  Parsed out;
  std::istringstream lines(text);
  std::optional<std::smatch> pending;
  std::string pending_line;
  int defined = 0, ended = 0, segments = 0;
  bool in_block = false;
  double parts = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, setting)) continue;
    if (std::regex_match(line, std::regex(R"(DEF [A-Za-z]\w{0,23}\(\))"))) {
      ++defined;
    } else if (line == "END") {
      ++ended;
    } else if (std::regex_match(line, match, ptp)) {
      out.move(match, 1, 0.0);
    } else if (line == "PTP_SPLINE") {
      if (in_block) out.reject(line);
      in_block = true;
      segments = 0;
      parts = 0.0;
    } else if (line == " TIME_BLOCK START") {
      if (!in_block || segments > 0) out.reject(line);
    } else if (std::regex_match(line, match, segment)) {
      if (!in_block || pending) out.reject(line);
      pending_line = line;
      std::smatch kept;
      std::regex_match(pending_line, kept, segment);
      pending = kept;
      ++segments;
    } else if (std::regex_match(line, match, part)) {
      if (!pending) {
        out.reject(line);
        continue;
      }
      parts += std::stod(match[1]);
      out.move(*pending, 1, std::stod(match[1]));
      pending.reset();
    } else if (std::regex_match(line, match, end)) {
      if (std::abs(std::stod(match[1]) - parts) > 1e-5) out.reject(line);
    } else if (line == "ENDSPLINE" || line == "ENDSPLINE C_SPL") {
      if (!in_block || segments == 0) out.reject(line);
      in_block = false;
    } else if (std::regex_match(line, match, wait)) {
      if (in_block) out.reject(line);
      out.time_s += std::stod(match[1]);
    } else {
      out.reject(line);
    }
  }
  if (defined != 1 || ended != 1 || in_block) out.reject("the whole");
  return out;
}

/// RAPID: a MODULE of PROCs that main calls in turn, with MoveAbsJ and WaitTime.
inline Parsed parse_rapid(const std::string& text) {
  std::string target = R"(\[\[)" + real;
  for (int i = 2; i <= 6; ++i) target += "," + real;
  target += R"(\],ext\])";
  const std::regex move("MoveAbsJ " + target + R"(\\NoEOffs,v1000\\T:=(\d+\.\d+),(z0|fine),\w+;)");
  const std::regex start("MoveAbsJ " + target + R"(\\NoEOffs,v100,fine,\w+;)");
  const std::regex wait(R"(WaitTime (\d+\.\d+);)");
  const std::regex proc(R"((LOCAL )?PROC (\w+)\(\))");
  Parsed out;
  std::istringstream lines(text);
  std::vector<std::string> defined, called;
  std::string open;
  bool standing = true, module = false, ended = false;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("LOCAL PERS tooldata ") || line.starts_with("SetDO ")) continue;
    if (line.starts_with("! ") || line == "LOCAL CONST extjoint ext:=[9E9,9E9,9E9,9E9,9E9,9E9];") continue;
    if (std::regex_match(line, std::regex(R"(MODULE [A-Za-z]\w{0,31})"))) {
      module = true;
    } else if (line == "ENDMODULE") {
      ended = open.empty();
    } else if (std::regex_match(line, match, proc)) {
      if (!open.empty()) out.reject(line);
      open = match[2];
      defined.push_back(open);
    } else if (line == "ENDPROC") {
      if (open.empty()) out.reject(line);
      open.clear();
    } else if (std::regex_match(line, match, start) && open == "go_to_start") {
      out.move(match, 1, 0.0);
    } else if (std::regex_match(line, match, move) && !open.empty()) {
      out.move(match, 1, std::stod(match[7]));
      standing = match[8] == "fine";
    } else if (std::regex_match(line, match, wait) && !open.empty()) {
      if (!standing) out.reject(line);  // a zone does not stop
      out.time_s += std::stod(match[1]);
    } else if (open == "main" && std::regex_match(line, std::regex(R"(\w+;)"))) {
      called.push_back(line.substr(0, line.size() - 1));
    } else {
      out.reject(line);
    }
  }
  defined.erase(std::find(defined.begin(), defined.end(), "main"));
  if (!module || !ended || called != defined || !standing) out.reject("the whole");
  return out;
}

/// URScript: def … end, movej, servoj, stopj, and the call.
inline Parsed parse_urscript(const std::string& text) {
  std::string target = R"(\[)" + real;
  for (int i = 2; i <= 6; ++i) target += ", " + real;
  target += R"(\])";
  const std::regex servo("  servoj\\(" + target + R"(, 0, 0, ([\d.e-]+), 0\.03, 2000\))");
  const std::regex start("  movej\\(" + target + R"(, a=0\.5, v=0\.2\))");
  Parsed out;
  std::istringstream lines(text);
  std::string name;
  bool inside = false, called = false;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("  # ") || line.starts_with("  set_") || line.starts_with("  sleep(")) continue;
    if (std::regex_match(line, match, std::regex(R"(def ([A-Za-z]\w*)\(\):)"))) {
      name = match[1];
      inside = true;
    } else if (inside && std::regex_match(line, match, start)) {
      out.move(match, 1, 0.0);
    } else if (inside && std::regex_match(line, match, servo)) {
      out.move(match, 1, std::stod(match[7]));
    } else if (line == "end" && inside) {
      inside = false;
    } else if (line == name + "()" && !inside) {
      called = true;
    } else if (line != "  stopj(2.0)") {
      out.reject(line);
    }
  }
  if (!called) out.reject("the whole");
  return out;
}

inline Parsed parse_servoj(const std::string& text, double cycle_s) {
  const std::regex row(real + " " + real + " " + real + " " + real + " " + real + " " + real);
  Parsed out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("# ")) continue;
    if (std::regex_match(line, match, row)) {
      out.move(match, 1, out.points.empty() ? 0.0 : cycle_s);
    } else {
      out.reject(line);
    }
  }
  return out;
}

inline Parsed parse(const std::string& ending, const std::string& text, double cycle_s) {
  if (ending == ".src") return parse_krl(text);
  if (ending == ".mod") return parse_rapid(text);
  if (ending == ".script") return parse_urscript(text);
  return parse_servoj(text, cycle_s);
}

}  // namespace robomill::path::test
