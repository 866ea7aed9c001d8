#include "robomill/jobs/frf.hpp"

namespace robomill::jobs {

FrfJobResult run_frf(const std::filesystem::path& hits, Progress& progress) {
  FrfJobResult out;
  out.file = modal::read_hits(hits);
  out.frfs = modal::estimate_frfs(out.file.hits, out.file.options, progress);
  return out;
}

}  // namespace robomill::jobs
