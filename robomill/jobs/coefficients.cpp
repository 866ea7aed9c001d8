#include "robomill/jobs/coefficients.hpp"

#include <fmt/format.h>

#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::jobs {
namespace {

constexpr int usual_teeth = 4;

}  // namespace

CoefficientsResult run_coefficients(const CoefficientsJob& job) {
  CoefficientsResult out;
  out.file = cutting::read_slots(job.slots);
  const bool said = job.teeth > 0;
  try {
    out.fit = cutting::identify_from_slots(out.file.slots, {.teeth = said ? job.teeth : usual_teeth});
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.field == "slots") parts.where = job.slots.string();
    throw InvalidInput(std::move(parts));
  }
  if (!said) {
    out.assumed.push_back(
        {.what = "Teeth of the cutter",
         .taken = fmt::format("{}; with N teeth every coefficient is {}/N of these", usual_teeth, usual_teeth),
         .key = "--teeth"});
  }
  return out;
}

}  // namespace robomill::jobs
