#include "robomill/jobs/files/in_words.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::jobs {

InvalidInput in_unit(const InvalidInput& error, double factor, std::string unit) {
  InvalidInput::Parts parts = error.parts();
  if (parts.number) *parts.number /= factor;
  parts.unit = std::move(unit);
  return InvalidInput(std::move(parts));
}

InvalidInput in_words_of(const LobesFile& cut, const InvalidInput& error) {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty()) return error;
  if (parts.field.starts_with("points.")) {
    parts.field = "--at";
    const InvalidInput of_point{std::move(parts)};
    if (of_point.parts().unit == "rad/s") return in_unit(of_point, units::rpm, "rpm");
    return of_point.parts().unit == "m" ? in_unit(of_point, units::mm, "mm") : of_point;
  }
  if (parts.field.starts_with("options.")) {
    parts.field = "--" + parts.field.substr(parts.field.find('.') + 1);
    std::ranges::replace(parts.field, '_', '-');
    return InvalidInput(std::move(parts));
  }
  // Another structure stands in the place of the file's: its modes have the same names.
  if (cut.dropped_dynamics && parts.field.starts_with("modes[")) return within("fitted ", error);
  if (cut.document) {
    InvalidInput located = cut.document->located(error);
    if (!located.parts().where.empty()) return located;
  }
  parts.where = cut.path.string();
  return InvalidInput(std::move(parts));
}

}  // namespace robomill::jobs
