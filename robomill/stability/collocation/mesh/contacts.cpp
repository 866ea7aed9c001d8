#include "robomill/stability/collocation/mesh/contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::stability::detail {
namespace {

using std::numbers::pi;

/// One of the surfaces that a tooth at a height may meet, left by the m-th tooth before it.
struct Surface {
  double delay_rad = 0.0;
  double step_m = 0.0;  ///< ρ_j - ρ_{j+m}
  double feed_m = 0.0;  ///< fed in between
  [[nodiscard]] double chip(double sine) const { return step_m + feed_m * sine; }
};

}  // namespace

double wrap(double angle, double period) {
  const double wrapped = angle - period * std::floor(angle / period);
  return wrapped < period ? wrapped : 0.0;
}

HeightsInCut heights_in_cut(const Contact& contact, double lag_rad_per_m, double tip_rad) {
  const cutting::Immersion& immersion = contact.immersion;
  const double start = immersion.entry_rad + std::min(lag_rad_per_m * contact.low_m, lag_rad_per_m * contact.high_m);
  HeightsInCut in;
  in.turned_rad = start + wrap(tip_rad - start, units::revolution);
  double low = contact.low_m;
  double high = contact.high_m;
  if (lag_rad_per_m != 0.0) {
    const double a = (in.turned_rad - immersion.entry_rad) / lag_rad_per_m;
    const double b = (in.turned_rad - immersion.exit_rad) / lag_rad_per_m;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  } else if (in.turned_rad > immersion.exit_rad) {
    high = low;
  }
  in.low_m = low;
  in.length_m = std::max(high - low, 0.0);
  return in;
}

CutterContacts::CutterContacts(const cutting::Milling& milling, int slices)
    : milling_(milling), runout_(milling.tool.runout_m > 0.0) {
  const cutting::FlatEndMill& tool = milling.tool;
  equal_ = tool.has_equal_pitch() && tool.has_equal_helix() && !runout_;
  for (int j = 0; j < tool.teeth; ++j) twisted_ = twisted_ || tool.lag_rad_per_m(j) != 0.0;
  slices_ = runout_ && twisted_ ? slices : 1;
  if (equal_) milling_.tool.pitch_rad.clear();
}

double CutterContacts::period_rad() const {
  return equal_ ? units::revolution / milling_.tool.teeth : units::revolution;
}

void CutterContacts::at_depth(double axial_depth_m, std::vector<Contact>& out) const {
  out.clear();
  const cutting::FlatEndMill& tool = milling_.tool;
  for (int j = 0; j < tool.teeth; ++j) {
    if (runout_) {
      for (int s = 0; s < slices_; ++s) {
        add_slice(j, axial_depth_m * s / slices_, axial_depth_m * (s + 1) / slices_, out);
      }
      continue;
    }
    const double slope = tool.lag_rad_per_m(j) - tool.lag_rad_per_m((j + 1) % tool.teeth);
    if (tool.pitch(j) + slope * axial_depth_m < 0.02) {
      throw InvalidInput("tooth_helix_rad", "lets one tooth overtake another within the axial depth");
    }
    out.push_back({j, 0.0, axial_depth_m, milling_.immersion, tool.pitch(j), slope, 0.0});
  }
}

void CutterContacts::add_slice(int tooth, double low_m, double high_m, std::vector<Contact>& out) const {
  const cutting::FlatEndMill& tool = milling_.tool;
  const double height = 0.5 * (low_m + high_m);
  const double feed_per_revolution_m = tool.teeth * milling_.feed_per_tooth_m;
  std::vector<Surface> surfaces;
  double pitches = 0.0;
  for (int m = 1; m <= tool.teeth; ++m) {
    pitches += tool.pitch((tooth + m - 1) % tool.teeth);
    const int other = (tooth + m) % tool.teeth;
    const double delay = pitches - (tool.lag_rad_per_m(other) - tool.lag_rad_per_m(tooth)) * height;
    if (delay <= 1e-9) continue;  // the other tooth has come round in front at this height
    surfaces.push_back({delay, tool.radius_deviation_m(tooth, height) - tool.radius_deviation_m(other, height),
                        feed_per_revolution_m * delay / units::revolution});
  }
  const auto meets = [&](double angle) -> const Surface* {
    const double sine = std::sin(angle);
    // Without runout and feed all chips are as thin, and the nearest tooth counts.
    const auto least = std::ranges::min_element(surfaces, [&](const Surface& a, const Surface& b) {
      return std::pair(a.chip(sine), a.delay_rad) < std::pair(b.chip(sine), b.delay_rad);
    });
    const bool touches = tool.runout_m == 0.0 || least->chip(sine) > 0.0;
    return touches ? &*least : nullptr;
  };

  // Where one chip outgrows another or vanishes, sin φ has a value that is known.
  std::vector<double> angles = {milling_.immersion.entry_rad, milling_.immersion.exit_rad};
  const auto add_crossing = [&](double step_m, double feed_m) {
    const double sine = -step_m / feed_m;
    if (!(sine > 0.0 && sine < 1.0)) return;
    for (const double angle : {std::asin(sine), pi - std::asin(sine)}) {
      if (angle > milling_.immersion.entry_rad && angle < milling_.immersion.exit_rad) angles.push_back(angle);
    }
  };
  if (tool.runout_m > 0.0) {
    for (std::size_t a = 0; a < surfaces.size(); ++a) {
      add_crossing(surfaces[a].step_m, surfaces[a].feed_m);
      for (std::size_t b = 0; b < a; ++b) {
        add_crossing(surfaces[a].step_m - surfaces[b].step_m, surfaces[a].feed_m - surfaces[b].feed_m);
      }
    }
  }
  std::ranges::sort(angles);
  const Surface* before = nullptr;
  for (std::size_t i = 0; i + 1 < angles.size(); ++i) {
    if (angles[i + 1] - angles[i] < 1e-12) continue;
    const Surface* here = meets(0.5 * (angles[i] + angles[i + 1]));
    if (here != nullptr && here == before) {
      out.back().immersion.exit_rad = angles[i + 1];
    } else if (here != nullptr) {
      out.push_back({tooth, low_m, high_m, {angles[i], angles[i + 1]}, here->delay_rad, 0.0, here->step_m});
    }
    before = here;
  }
}

}  // namespace robomill::stability::detail
