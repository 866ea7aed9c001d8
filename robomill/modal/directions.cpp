#include "robomill/modal/directions.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace {

constexpr std::array<Axis, 2> plane = {Axis::x, Axis::y};

std::string list_of(const std::vector<Axis>& axes) {
  std::string text;
  for (const Axis axis : axes) text += (text.empty() ? "" : " and ") + to_string(Dof{.axis = axis});
  return text;
}

bool has(const std::vector<Axis>& axes, Axis axis) {
  return std::find(axes.begin(), axes.end(), axis) != axes.end();
}

struct Ends {
  std::vector<Dof> responses = {}, excitations = {};  ///< one an FRF
};

Ends ends_of(const FrfSet& set) {
  Ends ends;
  for (const Frf& frf : set.frfs) {
    ends.responses.push_back(frf.name.response);
    ends.excitations.push_back(frf.name.excitation);
  }
  return ends;
}

/// Those of the plane that are not among both.
std::vector<Axis> not_in_both(const std::vector<Dof>& responses, const std::vector<Dof>& excitations) {
  std::vector<Axis> unknown;
  for (const Axis axis : plane) {
    const auto along = [axis](const Dof& dof) { return dof.axis == axis; };
    if (std::none_of(responses.begin(), responses.end(), along) ||
        std::none_of(excitations.begin(), excitations.end(), along)) {
      unknown.push_back(axis);
    }
  }
  return unknown;
}

/// The one degree of freedom that is both response and excitation.
Dof single(const std::vector<Dof>& responses, const std::vector<Dof>& excitations) {
  const bool one = excitations.size() == 1 && responses == excitations;
  if (!one || (excitations[0].axis != Axis::x && excitations[0].axis != Axis::y)) {
    throw InvalidInput("equal_directions", "needs FRFs or modes of one direction alone, xx or yy",
                       "Leave it out where both were measured");
  }
  return excitations[0];
}

FrfName direct(Dof dof, Axis axis) {
  dof.axis = axis;
  return {.response = dof, .excitation = dof};
}

}  // namespace

std::vector<Axis> unknown_directions(const ModalModel& model) {
  return not_in_both(model.responses, model.excitations);
}

std::vector<Axis> unknown_directions(const FrfSet& set) {
  const Ends ends = ends_of(set);
  return not_in_both(ends.responses, ends.excitations);
}

void require_said(const std::vector<Axis>& unknown, const MissingDirections& said) {
  for (const Axis axis : said.rigid) {
    if (!has(unknown, axis)) {
      throw InvalidInput("rigid_directions", "names " + list_of({axis}) + ", which was measured",
                         "Leave it out: what was measured counts");
    }
  }
  if (said.equal && !said.rigid.empty()) {
    throw InvalidInput("equal_directions", "must not stand beside rigid_directions", "A direction is one or the other");
  }
  if (said.equal) {
    if (unknown.size() == 1) return;
    throw InvalidInput("equal_directions", "needs FRFs or modes of one direction alone, xx or yy",
                       "Leave it out where both were measured");
  }
  std::vector<Axis> open;
  std::copy_if(unknown.begin(), unknown.end(), std::back_inserter(open),
               [&](Axis axis) { return !has(said.rigid, axis); });
  if (open.empty()) return;
  const std::string axes = list_of(open);
  throw InvalidInput("", "nothing is known of " + axes + " as both force and response",
                     "Measure it; or write equal_directions = true to take it as the other direction, or "
                     "rigid_directions = [\"" +
                         to_string(Dof{.axis = open.front()}) + "\"] to take it as rigid");
}

ModalModel with_equal_directions(const ModalModel& model) {
  const Dof measured = single(model.responses, model.excitations);
  ModalModel out;
  for (const Axis axis : plane) {
    const FrfName name = direct(measured, axis);
    out.excitations.push_back(name.excitation);
    out.responses.push_back(name.response);
    for (const Residual& residual : model.residuals) {
      Residual copy = residual;
      copy.name = name;
      out.residuals.push_back(copy);
    }
  }
  for (const Mode& mode : model.modes) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      Mode copy = mode;
      copy.left = Eigen::VectorXcd::Unit(2, axis) * mode.left(0);
      copy.right = Eigen::VectorXcd::Unit(2, axis) * mode.right(0);
      out.modes.push_back(copy);
    }
  }
  return out;
}

FitResult with_equal_directions(FitResult fit) {
  const Dof measured = single(fit.model.responses, fit.model.excitations);
  fit.model = with_equal_directions(fit.model);
  const FrfFitError error = fit.by_frf.front();
  fit.by_frf.clear();
  for (const Axis axis : plane) fit.by_frf.push_back({.name = direct(measured, axis), .relative = error.relative});
  for (const ModeAtBound& at : std::exchange(fit.at_bounds, {})) {
    for (const int mode : {2 * at.mode - 1, 2 * at.mode}) fit.at_bounds.push_back({mode, at.bound});
  }
  return fit;
}

FrfSet with_equal_directions(const FrfSet& set) {
  const Ends ends = ends_of(set);
  const Dof measured = single(ends.responses, ends.excitations);
  FrfSet out{.frequency_hz = set.frequency_hz, .frfs = {}};
  for (const Axis axis : plane) {
    out.frfs.push_back(set.frfs.front());
    out.frfs.back().name = direct(measured, axis);
  }
  return out;
}

std::optional<Assumption> assumed_of(const MissingDirections& said) {
  if (said.equal) {
    return Assumption{.what = "The direction that was not measured",
                      .taken = "equal to the measured one, without cross terms",
                      .key = "equal_directions"};
  }
  if (said.rigid.empty()) return std::nullopt;
  return Assumption{
      .what = "Direction " + list_of(said.rigid) + ", not measured", .taken = "rigid", .key = "rigid_directions"};
}

}  // namespace robomill::modal
