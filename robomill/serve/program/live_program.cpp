#include "robomill/serve/program/live_program.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/process/files/turned_json.hpp"

namespace robomill::serve {
namespace {

constexpr std::size_t most_knots = 400;
constexpr double most_turn_deg = 360.0;

int job_of(const io::JsonNode& node) {
  const io::Json& value = node.json();
  constexpr auto most = static_cast<unsigned>(std::numeric_limits<int>::max());
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() < 1 || value.get<std::uint64_t>() > most) {
    throw node.reject("must be the number of a job");
  }
  return value.get<int>();
}

std::vector<process::GammaKnot> knots_of(const io::JsonNode& list) {
  const std::size_t count = list.size();
  if (count < 1 || count > most_knots) throw list.reject(fmt::format("must have 1 to {} knots", most_knots));
  std::vector<process::GammaKnot> knots;
  knots.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::VectorXd pair = list.at(i).numbers();
    if (pair.size() != 2) throw list.at(i).reject("must be [path in mm, γ in degrees]");
    const process::GammaKnot knot = {.path_m = pair(0) * units::mm, .gamma_rad = pair(1) * units::deg};
    if (!knots.empty() && !(knot.path_m > knots.back().path_m)) {
      throw list.at(i).at(std::size_t{0}).reject("must be greater than the path of the knot before");
    }
    if (!(std::abs(pair(1)) <= most_turn_deg)) {
      throw list.at(i).at(std::size_t{1}).reject(fmt::format("must be from -{0} to {0} degrees", most_turn_deg));
    }
    knots.push_back(knot);
  }
  return knots;
}

}  // namespace

LiveProgramRequest read_live_program_request(std::string_view body) {
  const io::Json json = io::parse_json(body, "request");
  const io::JsonNode root(json, "request");
  root.require_object();
  return {.job = job_of(root.at("job")), .gamma = knots_of(root.at("gamma")), .order = read_client_order(root)};
}

std::string live_program(const LiveProgramRequest& request, const jobs::PlanResult& plan, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  io::Json out = {{"sequence", request.order.sequence}};
  out.update(process::turned_object(process::judge_turned(jobs::judged_program(plan), request.gamma, progress)));
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - begin;
  out["milliseconds"] = io::number(std::round(10.0 * spent.count()) / 10.0);
  return io::plain_text(out) + "\n";
}

}  // namespace robomill::serve
