#include "robomill/report/json.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace robomill::report {

using Json = nlohmann::ordered_json;

Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 5).ptr;
  double rounded = 0.0;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

Json number(double si, double unit) {
  return number(si / unit);
}

Json numbers(const Eigen::VectorXd& si, double unit) {
  Json list = Json::array();
  for (const double value : si) list.push_back(number(value, unit));
  return list;
}

Json numbers(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& keep, double unit) {
  Json list = Json::array();
  for (const Eigen::Index i : keep) list.push_back(number(values[i], unit));
  return list;
}

Json text(const std::string& raw) {
  const Json quoted = raw;
  return Json::parse(quoted.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json texts(const std::vector<std::string>& raw) {
  Json list = Json::array();
  for (const std::string& line : raw) list.push_back(text(line));
  return list;
}

}  // namespace robomill::report
