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

Json text(const std::string& raw) {
  const Json quoted = raw;
  return Json::parse(quoted.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json texts(const std::vector<std::string>& raw) {
  Json list = Json::array();
  for (const std::string& line : raw) list.push_back(text(line));
  return list;
}

Json facts_json(const std::vector<Fact>& facts) {
  Json list = Json::array();
  for (const Fact& fact : facts) list.push_back({{"label", text(fact.label)}, {"value", text(fact.value)}});
  return list;
}

bool is_single(const signal::Band& band) {
  return band.low == band.high;
}

Json run_times_json(Eigen::Index runs, bool points, double run_s) {
  Json list = Json::array();
  for (Eigen::Index run = 0; run < runs; ++run) {
    const double begin = static_cast<double>(run) * run_s;
    list.push_back(number(begin + (points ? 0.0 : 0.25 * run_s)));
    if (!points) list.push_back(number(begin + 0.75 * run_s));
  }
  return list;
}

Json band_json(const signal::Band& band, bool points, double unit) {
  Json list = Json::array();
  for (Eigen::Index run = 0; run < band.low.size(); ++run) {
    list.push_back(number(band.low[run], unit));
    if (!points) list.push_back(number(band.high[run], unit));
  }
  return list;
}

}  // namespace robomill::report
