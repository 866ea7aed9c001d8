#include "robomill/jobs/files/in_words.hpp"

#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/toml_file.hpp"

namespace robomill::jobs {

InvalidInput in_words_of(const LobesFile& cut, const InvalidInput& error) {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty()) return error;
  if (parts.field.starts_with("points.")) {
    const bool speed = parts.unit == "rad/s", depth = parts.unit == "m";
    parts.field = "--at";
    if (parts.number && speed) parts.number = *parts.number / units::rpm;
    if (parts.number && depth) parts.number = *parts.number / units::mm;
    if (speed || depth) parts.unit = speed ? "rpm" : "mm";
    return InvalidInput(std::move(parts));
  }
  if (cut.document) {
    InvalidInput located = cut.document->located(error);
    if (!located.parts().where.empty()) return located;
  }
  parts.where = cut.path.string();
  return InvalidInput(std::move(parts));
}

}  // namespace robomill::jobs
