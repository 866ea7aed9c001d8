#include "robomill/jobs/modes.hpp"

namespace robomill::jobs {

ModesResult run_modes(const ModesJob& job, Progress& progress) {
  ModesResult out;
  out.measured = modal::read_frfs(job.frfs, job.as);
  out.measured.notes.insert(out.measured.notes.begin(), job.notes.begin(), job.notes.end());
  modal::FitOptions options = job.options;
  if (out.measured.added_decay_per_s > 0.0) options.exponential_decay_per_s = out.measured.added_decay_per_s;
  out.fit = modal::fit_modes(out.measured.set, options, progress);
  out.fit.accepted = job.accept_fit;
  return out;
}

modal::FrfSet fitted_frfs(const modal::ModalModel& model, const modal::FrfSet& measured) {
  const Eigen::VectorXd& lines = measured.frequency_hz;
  modal::FrfSet all = modal::synthesize(model, lines(0) == 0.0 ? lines.tail(lines.size() - 1).eval() : lines);
  std::erase_if(all.frfs, [&](const modal::Frf& frf) { return measured.find(frf.name) == nullptr; });
  return all;
}

}  // namespace robomill::jobs
