#include "robomill/signal/synchrosqueeze.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <algorithm>
#include <memory>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/signal/synchrosqueeze_engine.hpp"

namespace robomill::signal {
namespace {

void require_record(const Eigen::Ref<const Eigen::VectorXd>& x) {
  if (x.size() < 1) throw InvalidInput("signal", "is empty");
  if (!x.allFinite()) throw InvalidInput("signal", "must be finite");
}

Eigen::Index column_count(Eigen::Index samples, const SynchrosqueezeOptions& options) {
  return (samples + options.hop - 1) / options.hop;
}

/// Runs each(engine, column) over all columns, in blocks that each begin with a window of samples of their own.
template <class Each>
void run_columns(const Eigen::Ref<const Eigen::VectorXd>& x, const SynchrosqueezeOptions& options,
                 const Eigen::VectorXd& edges_hz, const Each& each) {
  const Eigen::Index half = options.window_length / 2, columns = column_count(x.size(), options);
  const auto sample = [&x](Eigen::Index m) { return m < 0 || m >= x.size() ? 0.0 : x(m); };
  const Eigen::Index grain = std::max<Eigen::Index>(16, 8 * options.window_length / options.hop);
  parallel_for(static_cast<std::size_t>(columns), static_cast<std::size_t>(grain),
               [&](std::size_t begin, std::size_t end) {
                 SynchrosqueezeEngine engine(options, edges_hz);
                 auto at = static_cast<Eigen::Index>(begin) * options.hop;
                 for (Eigen::Index m = at - half; m < at + half - 1; ++m) engine.fill(sample(m));
                 at += half - 1;
                 engine.next = 1;
                 for (std::size_t column = begin; column < end; ++column) {
                   while (!engine.push(sample(at++))) {
                   }
                   each(engine, static_cast<Eigen::Index>(column));
                 }
               });
}

/// Asks for pages of 2 MiB: a minute's columns are gigabytes, and their first touch, page by page, takes longer than
/// they do.
void use_large_pages(Eigen::MatrixXcd& matrix) {
#if defined(__linux__)
  constexpr std::size_t page = std::size_t{1} << 21U;
  std::size_t room = static_cast<std::size_t>(matrix.size()) * sizeof(std::complex<double>);
  void* first = matrix.data();
  if (std::align(page, page, first, room) == nullptr) return;
  static_cast<void>(madvise(first, room / page * page, MADV_HUGEPAGE));
#else
  static_cast<void>(matrix);
#endif
}

}  // namespace

void SynchrosqueezeOptions::validate() const {
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  if (window_length < 8 || window_length > 65536 || window_length % 2 != 0) {
    throw InvalidInput("window_length", static_cast<double>(window_length), "samples", "must be even, 8 to 65536");
  }
  if (hop < 1) throw InvalidInput("hop", static_cast<double>(hop), "samples", "must be at least 1");
  require_non_negative("threshold", threshold, "");
}

Eigen::VectorXd equal_bands(double sample_rate_hz, Eigen::Index count) {
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  if (count < 1) throw InvalidInput("bands", static_cast<double>(count), "", "must be at least 1");
  Eigen::VectorXd edges(count + 1);
  for (Eigen::Index b = 0; b <= count; ++b) {
    edges(b) = 0.5 * sample_rate_hz * static_cast<double>(b) / static_cast<double>(count);
  }
  return edges;
}

Synchrosqueezed synchrosqueeze(const Eigen::Ref<const Eigen::VectorXd>& x, const SynchrosqueezeOptions& options,
                               Keep keep) {
  options.validate();
  require_record(x);
  const Eigen::Index columns = column_count(x.size(), options);
  Synchrosqueezed out;
  out.frequency_hz.resize(options.lines());
  for (Eigen::Index k = 0; k < options.lines(); ++k) {
    out.frequency_hz(k) = static_cast<double>(k) * options.sample_rate_hz / static_cast<double>(options.window_length);
  }
  out.time_s.resize(columns);
  for (Eigen::Index m = 0; m < columns; ++m) {
    out.time_s(m) = static_cast<double>(m * options.hop) / options.sample_rate_hz;
  }
  if (keep == Keep::both) out.transform.resize(options.lines(), columns);
  out.squeezed.resize(options.lines(), columns);
  use_large_pages(out.transform);
  use_large_pages(out.squeezed);
  run_columns(x, options, {}, [&out, keep](SynchrosqueezeEngine& engine, Eigen::Index column) {
    if (keep == Keep::both) engine.transform(out.transform.col(column).data());
    engine.squeezed(out.squeezed.col(column).data());
  });
  return out;
}

Eigen::MatrixXd band_signals(const Eigen::Ref<const Eigen::VectorXd>& x, const SynchrosqueezeOptions& options,
                             const Eigen::Ref<const Eigen::VectorXd>& edges_hz) {
  options.validate();
  require_record(x);
  static_cast<void>(bands_of_lines(options, edges_hz));
  Eigen::MatrixXd out(edges_hz.size() - 1, column_count(x.size(), options));
  run_columns(x, options, edges_hz, [&out](SynchrosqueezeEngine& engine, Eigen::Index column) {
    std::copy(engine.band_values.begin(), engine.band_values.end(), out.col(column).data());
  });
  return out;
}

}  // namespace robomill::signal
