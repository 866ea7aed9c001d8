#include <iterator>

#include "robomill/jobs/verbs/records.hpp"

namespace robomill::jobs {

std::span<const Verb> verbs() {
  static const std::vector<Verb> all = [] {
    std::vector<Verb> out = {plan_verb()};
    const auto add = [&out](std::vector<Verb> more) {
      out.insert(out.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    };
    add(structure_verbs());
    add(cut_verbs());
    add(robot_verbs());
    out.push_back(calibrate_verb());
    return out;
  }();
  return all;
}

}  // namespace robomill::jobs
