#include "robomill/process/decide/as_it_is.hpp"

#include <vector>

namespace robomill::process {
namespace {

/// A program that nothing of may differ.
class AsItIs final : public decision::ProgramModel {
 public:
  explicit AsItIs(const WayModel& way) : way_(way) {}
  [[nodiscard]] decision::FeedRange feeds(std::size_t cut, double speed) const override {
    return way_.feeds(cut, speed);
  }
  [[nodiscard]] decision::CutLook look(std::size_t look_class, double speed, std::size_t /*gamma*/) const override {
    return way_.look(look_class, speed, 0.0);
  }

 private:
  const WayModel& way_;
};

bool has_one_speed_a_stretch(const ForcesResult& forces, const ProgramUnits& units) {
  for (const decision::ProgramStretch& stretch : units.stretches) {
    for (std::size_t line = stretch.begin; line < stretch.end; ++line) {
      for (const std::size_t block : units.lines[line].cutting) {
        const double speed = forces.program->blocks[block].force.spindle_speed_rad_per_s;
        if (speed != stretch.programmed_spindle_speed_rad_per_s) return false;
      }
    }
  }
  return true;
}

}  // namespace

std::optional<decision::ProgramDecision> choice_as_it_is(const DecideProblem& problem, const BlockModel& model,
                                                         Progress& progress) {
  const ProgramUnits& units = model.units();
  if (!has_one_speed_a_stretch(problem.forces, units)) return std::nullopt;
  decision::ProgramOptions options = model.search();
  options.free_speed = options.free_feed = false;
  options.gamma_rad = {0.0};
  options.alternatives = 0;
  decision::ProgramDecision out =
      decision::decide_program(units.cuts, units.stretches, AsItIs(model.as_programmed()), options, progress);
  if (out.status == decision::ProgramDecision::Status::infeasible) return std::nullopt;
  return out;
}

}  // namespace robomill::process
