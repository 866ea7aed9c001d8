#include "robomill/report/report.hpp"

#include "robomill/base/error.hpp"

namespace robomill::report {
namespace {

template <class Part>
void validate_part(const char* name, const std::optional<Part>& part) {
  if (!part) return;
  try {
    part->validate();
  } catch (const InvalidInput& error) {
    throw within(name, error);
  }
}

}  // namespace

void Report::validate() const {
  validate_part("smooth.", smooth);
}

}  // namespace robomill::report
