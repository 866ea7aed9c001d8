#include "robomill/io/system/output_places.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/pending_names.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

thread_local OutputPlaces* innermost = nullptr;
thread_local ReadBack* innermost_read = nullptr;

/// Where a path leads, behind every link, as far as it is there.
fs::path real(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(fs::absolute(behind_link(path), error), error);
  return error ? path : found;
}

bool is_same(const fs::path& one, const fs::path& other) {
  std::error_code error;
  return real(one) == real(other) || (fs::equivalent(one, other, error) && !error);
}

bool stands_in(const fs::path& path, const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return false;
  const fs::path outer = real(folder), inner = real(path);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

OutputPlaces::OutputPlaces(std::vector<fs::path> places) : places_(std::move(places)), outer_(innermost) {
  // A device takes what is written and is not replaced.
  std::erase_if(places_, [](const fs::path& place) { return place.empty() || is_special(place); });
  for (std::size_t i = 0; i < places_.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (is_same(places_[i], places_[k])) {
        throw InvalidInput(places_[i].string(), "is where two outputs would be written", "Give each its own name");
      }
    }
  }
  innermost = this;
}

OutputPlaces::~OutputPlaces() {
  innermost = outer_;
}

ReadBack::ReadBack(fs::path folder) : folder_(std::move(folder)), outer_(innermost_read) {
  innermost_read = this;
}

ReadBack::~ReadBack() {
  innermost_read = outer_;
}

void require_no_output(const fs::path& path) {
  if (innermost == nullptr || is_pending(path)) return;
  for (const ReadBack* job = innermost_read; job != nullptr; job = job->outer_) {
    if (stands_in(path, job->folder_)) return;
  }
  for (const OutputPlaces* job = innermost; job != nullptr; job = job->outer_) {
    for (const fs::path& place : job->places_) {
      if (is_same(path, place)) {
        throw InvalidInput(path.string(), "is read by this job and would be replaced by its output",
                           "Write the output to another file");
      }
      if (stands_in(path, place)) {
        throw InvalidInput(path.string(), "is read by this job and stands in the folder that it writes",
                           "Write the output to another folder");
      }
    }
  }
}

}  // namespace robomill::io
